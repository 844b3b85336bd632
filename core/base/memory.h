/* Memory that is done with before it can be freed. */
#ifndef ORL_BASE_MEMORY_H
#define ORL_BASE_MEMORY_H

#include <stdint.h>
#include <sys/mman.h>

/*
 * Gives back the pages that lie wholly between two places of memory from malloc. What was there is
 * gone; the memory stays allocated. For arrays that are read once, from front to back, where the
 * next one is being filled: together they take no more than one.
 */
static inline void orl_memory_let_go(const void *begin, const void *end)
{
    const uintptr_t page = 4096;
    const uintptr_t first = ((uintptr_t)begin + page - 1) / page * page;
    const uintptr_t last = (uintptr_t)end / page * page;
    if (first < last)
        madvise((void *)first, last - first, MADV_DONTNEED);
}

#endif

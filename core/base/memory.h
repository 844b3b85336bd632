/* Memory in large pieces, and memory that is done with before it can be freed. */
#ifndef ORL_BASE_MEMORY_H
#define ORL_BASE_MEMORY_H

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/*
 * As malloc, to be freed likewise. A large array asks for huge pages: to have the kernel make small
 * ones, one by one as they are first touched, takes longer than to fill them.
 */
static inline void *orl_memory_new(size_t bytes)
{
    const size_t huge = (size_t)2 << 20;
    if (bytes < 2 * huge || bytes > SIZE_MAX - huge)
        return malloc(bytes);
    void *memory = aligned_alloc(huge, (bytes + huge - 1) / huge * huge);
#ifdef MADV_HUGEPAGE
    if (memory)
        madvise(memory, bytes, MADV_HUGEPAGE); /* a wish: nothing depends on it */
#endif
    return memory;
}

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

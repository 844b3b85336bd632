/* Allocation of large blocks, and early release of memory that is no longer needed. */
#ifndef ORL_BASE_MEMORY_HUGE_PAGES_H
#define ORL_BASE_MEMORY_HUGE_PAGES_H

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/*
 * Same as malloc, and freed by free. A large block requests huge pages: page faults for small pages
 * would take longer than filling the block.
 */
static inline void *orl_memory_new(size_t bytes)
{
    const size_t huge = (size_t)2 << 20;
    if (bytes < 2 * huge || bytes > SIZE_MAX - huge)
        return malloc(bytes);
    void *memory = aligned_alloc(huge, (bytes + huge - 1) / huge * huge);
#ifdef MADV_HUGEPAGE
    /* Only a hint. */
    if (memory)
        madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return memory;
}

/*
 * Releases the pages that lie completely between two addresses of memory from malloc. Their content
 * is lost; the memory stays allocated. For arrays that are read once, from front to back, while
 * another one is filled: together they use no more than one.
 */
static inline void orl_memory_release_pages(const void *begin, const void *end)
{
    const uintptr_t page = 4096;
    const uintptr_t first = ((uintptr_t)begin + page - 1) / page * page;
    const uintptr_t last = (uintptr_t)end / page * page;
    if (first < last)
        madvise((void *)first, last - first, MADV_DONTNEED);
}

#endif

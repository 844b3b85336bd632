/*
 * Sorts many items with polls for cancellation; a qsort of a million takes half a second.
 *
 * The sort is stable, so that results do not depend on the amount of memory. Those of qsort may.
 */
#ifndef ORL_BASE_MEMORY_SORT_H
#define ORL_BASE_MEMORY_SORT_H

#include <stddef.h>

#include <oriel/base/thread_pool.h>

/* Same as qsort, with cancellation. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; on errors the
 * order is undefined. */
int orl_sort(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
             const atomic_bool *cancel);

#endif

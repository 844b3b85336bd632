/*
 * Sorting of many items with polls for cancellation: qsort of a million takes half a second.
 *
 * Stable: equal items keep their order, so that results do not depend on the amount of memory, as
 * those of qsort may.
 */
#ifndef ORL_BASE_SORT_H
#define ORL_BASE_SORT_H

#include <stddef.h>

#include <oriel/crew.h>

/* As qsort. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED, in which cases the order is undefined.
 */
int orl_sort(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
             const atomic_bool *cancel);

#endif

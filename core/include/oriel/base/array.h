/*
 * Growable arrays: a pointer, a count and a capacity, which doubles when the array is full. All are
 * zero at first; the caller frees the pointer.
 *
 * array is the address of the pointer to the items, item the bytes of each.
 */
#ifndef ORIEL_BASE_ARRAY_H
#define ORIEL_BASE_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/* Makes room for one more item. *array holds count items. Returns false when out of memory. */
bool orl_array_reserve(void *array, size_t *capacity, size_t count, size_t item);

/* Makes room for `more` items. Returns false when out of memory. */
bool orl_array_reserve_more(void *array, size_t *capacity, size_t count, size_t more, size_t item);

#endif

/* Arrays with capacity, which doubles when they are full. */
#ifndef ORL_BASE_MEMORY_ARRAY_H
#define ORL_BASE_MEMORY_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/* Makes room for one more item. *array holds count items, with capacity *room. Returns false when
 * out of memory. */
bool orl_array_reserve(void *array, size_t *capacity, size_t count, size_t item);

/* Makes room for `more` items. Returns false when out of memory. */
bool orl_array_reserve_more(void *array, size_t *capacity, size_t count, size_t more, size_t item);

#endif

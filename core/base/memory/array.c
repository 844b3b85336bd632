#include "base/memory/array.h"

#include <stdlib.h>

bool orl_array_reserve(void *array, size_t *capacity, size_t count, size_t item)
{
    return orl_array_reserve_more(array, capacity, count, 1, item);
}

bool orl_array_reserve_more(void *array, size_t *capacity, size_t count, size_t more, size_t item)
{
    void **pointer = array;
    size_t wanted = *capacity ? 2 * *capacity : 16;
    void *grown;
    if (count + more <= *capacity)
        return true;
    if (wanted < count + more)
        wanted = count + more;
    grown = realloc(*pointer, wanted * item);
    if (!grown)
        return false;
    *pointer = grown;
    *capacity = wanted;
    return true;
}

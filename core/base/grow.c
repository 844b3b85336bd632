#include "base/grow.h"

#include <stdlib.h>

bool orl_grow(void *array, size_t *room, size_t count, size_t item)
{
    void **pointer = array;
    const size_t wanted = *room ? 2 * *room : 16;
    void *grown;
    if (count < *room)
        return true;
    grown = realloc(*pointer, wanted * item);
    if (!grown)
        return false;
    *pointer = grown;
    *room = wanted;
    return true;
}

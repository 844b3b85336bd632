#include "base/grow.h"

#include <stdlib.h>

bool orl_grow(void *array, size_t *room, size_t count, size_t item)
{
    return orl_grow_by(array, room, count, 1, item);
}

bool orl_grow_by(void *array, size_t *room, size_t count, size_t more, size_t item)
{
    void **pointer = array;
    size_t wanted = *room ? 2 * *room : 16;
    void *grown;
    if (count + more <= *room)
        return true;
    if (wanted < count + more)
        wanted = count + more;
    grown = realloc(*pointer, wanted * item);
    if (!grown)
        return false;
    *pointer = grown;
    *room = wanted;
    return true;
}

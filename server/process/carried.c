#include "process/carried.h"

#include <string.h>

/* The contract is longer than the 4095 bytes that C17 guarantees for one literal; gcc and clang
 * accept it. */
#pragma GCC diagnostic ignored "-Woverlength-strings"
#include "embedded.h"

size_t orl_carried_count(void)
{
    return sizeof orl_embedded / sizeof *orl_embedded;
}

struct orl_carried_file orl_carried_at(size_t index)
{
    return (struct orl_carried_file){orl_embedded[index].name, orl_embedded[index].text};
}

const char *orl_carried_find(const char *name)
{
    for (size_t i = 0; i < orl_carried_count(); i++)
        if (strcmp(orl_embedded[i].name, name) == 0)
            return orl_embedded[i].text;
    return NULL;
}

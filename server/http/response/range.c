#include "http/response/range.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <strings.h>

/* Reads a number; too large ones become UINT64_MAX. Returns false if there are no digits. */
static bool read_number(const char **at, uint64_t *ret_value)
{
    const char *start = *at;
    uint64_t value = 0;
    for (; isdigit((unsigned char)**at); ++*at) {
        const uint64_t digit = (uint64_t)(**at - '0');
        value = value > (UINT64_MAX - digit) / 10 ? UINT64_MAX : 10 * value + digit;
    }
    *ret_value = value;
    return *at != start;
}

enum orl_range_kind orl_range_parse(const char *header, uint64_t size, struct orl_range *ret_range)
{
    static const char unit[] = "bytes=";
    uint64_t first = 0, last = UINT64_MAX;
    if (strncasecmp(header, unit, sizeof unit - 1) != 0)
        return ORL_RANGE_ALL;
    const char *at = header + sizeof unit - 1;
    const bool has_first = read_number(&at, &first);
    if (*at++ != '-')
        return ORL_RANGE_ALL;
    const bool has_last = read_number(&at, &last);
    if (*at || (!has_first && !has_last) || (has_first && has_last && first > last))
        return ORL_RANGE_ALL;
    if (!has_first) { /* a suffix range: the last `last` bytes */
        if (last == 0 || size == 0)
            return ORL_RANGE_NONE;
        first = last < size ? size - last : 0;
        last = size - 1;
    }
    if (first >= size)
        return ORL_RANGE_NONE;
    if (!has_last || last > size - 1)
        last = size - 1;
    ret_range->first = first;
    ret_range->count = last - first + 1;
    return ORL_RANGE_PART;
}

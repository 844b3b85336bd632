#include "http/request/negotiate.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* Returns how specific a matching range is: 3 the name, 2 its type, 1 anything; 0: no match. */
static int closeness(const char *range, size_t length, const char *name)
{
    const char *slash = strchr(name, '/');
    const size_t type = slash ? (size_t)(slash - name) + 1 : 0;
    if (length == strlen(name) && strncasecmp(range, name, length) == 0)
        return 3;
    if (slash && length == type + 1 && range[type] == '*' && strncasecmp(range, name, type) == 0)
        return 2;
    if (slash)
        return length == 3 && memcmp(range, "*/*", 3) == 0;
    return length == 1 && *range == '*';
}

/* Reads a weight such as "0.8"; 0 if it is invalid. */
static double read_weight(const char *text)
{
    int thousandths = 0, place = 100;
    if (*text == '1')
        return 1;
    if (text[0] != '0' || text[1] != '.')
        return 0;
    for (text += 2; *text >= '0' && *text <= '9'; text++, place /= 10)
        thousandths += place * (*text - '0');
    return thousandths / 1000.0;
}

/* Returns the weight among the parameters up to the range's end; 1 if there is none. */
static double find_weight(const char *text, const char *end)
{
    while ((text = memchr(text, ';', (size_t)(end - text)))) {
        text++;
        text += strspn(text, " \t");
        if (text + 2 < end && strncasecmp(text, "q=", 2) == 0)
            return read_weight(text + 2);
    }
    return 1;
}

double orl_negotiate_weight(const char *header, const char *name)
{
    double weight = 0;
    int best = 0;
    for (const char *at = header; at && *at; at += *at == ',') {
        at += strspn(at, " \t");
        const char *end = at + strcspn(at, ",");
        const int close = closeness(at, strcspn(at, ",; \t"), name);
        if (close > best) {
            best = close;
            weight = find_weight(at, end);
        }
        at = end;
    }
    return weight;
}

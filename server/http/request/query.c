#include "http/request/query.h"

#include <stdlib.h>
#include <string.h>

bool orl_query_count(const char *text, unsigned long most, unsigned long *ret_count)
{
    const size_t length = strlen(text);
    if (length == 0 || text[strspn(text, "0123456789")])
        return false;
    /* With too many digits the value is ULONG_MAX. */
    const unsigned long count = strtoul(text, NULL, 10);
    if (count < 1 || count > most)
        return false;
    *ret_count = count;
    return true;
}

bool orl_query_number(const char *text, double low, double high, double *ret_number)
{
    char *end;
    if (text[0] == '\0' || text[strspn(text, "0123456789+-.eE")])
        return false;
    const double number = strtod(text, &end);
    if (*end || !(number >= low) || !(number <= high))
        return false;
    *ret_number = number;
    return true;
}

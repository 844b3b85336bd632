#include "encode.h"

#include <math.h>
#include <stdio.h>

#include <oriel/error.h>

json_t *orl_json_from_text(const char *text)
{
    json_t *string = json_string(text); /* which jansson refuses when it is not UTF-8 */
    if (string)
        return string;
    char ascii[ORL_ERROR_TEXT_MAX];
    snprintf(ascii, sizeof ascii, "%s", text);
    for (char *c = ascii; *c; c++)
        if ((unsigned char)*c > 126 || (unsigned char)*c < 32)
            *c = '?';
    return json_string(ascii);
}

json_t *orl_json_from_real(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

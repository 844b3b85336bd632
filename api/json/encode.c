#include "json/encode.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>
#include <oriel/base/error.h>

json_t *orl_json_from_text(const char *text)
{
    json_t *string = text ? json_string(text) : json_null(); /* NULL if text is not UTF-8 */
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

/* Output buffer. After a failed allocation nothing more is appended, because a gap could not be
 * detected later. */
struct text {
    char *bytes;
    size_t length, room;
    bool failed;
};

static int append_text(const char *bytes, size_t size, void *ctx)
{
    struct text *text = ctx;
    text->failed = text->failed ||
                   !orl_array_reserve_more(&text->bytes, &text->room, text->length, size + 1, 1);
    if (text->failed)
        return -1;
    memcpy(text->bytes + text->length, bytes, size);
    text->length += size;
    text->bytes[text->length] = '\0';
    return 0;
}

char *orl_json_text(const json_t *value, size_t flags)
{
    struct text text = {NULL, 0, 0, false};
    if (value && json_dump_callback(value, append_text, &text, flags) == 0 && !text.failed)
        return text.bytes;
    free(text.bytes);
    return NULL;
}

json_t *orl_json_checked(json_t *json, int failed)
{
    if (!failed)
        return json;
    json_decref(json);
    return NULL;
}

json_t *orl_json_append(json_t *array, json_t *item)
{
    return orl_json_checked(array, json_array_append_new(array, item));
}

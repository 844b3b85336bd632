/*
 * JSON values from what the core says, which may hold what JSON cannot: names out of files in any
 * encoding, numbers that are not finite. New references, the caller's; NULL when out of memory.
 */
#ifndef ORL_API_ENCODE_H
#define ORL_API_ENCODE_H

#include <jansson.h>

/*
 * text as a string. When it is not UTF-8, '?' stands for every byte that is not printable ASCII,
 * and what goes beyond ORL_ERROR_TEXT_MAX bytes is cut off.
 */
json_t *orl_json_from_text(const char *text);

/* A number; null in place of an infinity or a NaN. */
json_t *orl_json_from_real(double value);

/* Adds to an array, and returns it; NULL, and it is freed, where that fails. Both are taken. */
json_t *orl_json_append(json_t *array, json_t *item);

/*
 * The value as text (free()), with jansson's flags; NULL when out of memory, or value is NULL. Use
 * it instead of json_dumps, which goes on behind a key that it had no memory for: such text is no
 * JSON.
 */
char *orl_json_text(const json_t *value, size_t flags);

#endif

/*
 * Makes JSON values from values of the core that JSON cannot hold: names from files in any
 * encoding, and numbers that are not finite. Functions return new references, owned by the caller,
 * or NULL when out of memory.
 */
#ifndef ORL_API_JSON_ENCODE_H
#define ORL_API_JSON_ENCODE_H

#include <jansson.h>

/*
 * Returns text as a string, or json null for NULL. If it is not UTF-8, '?' replaces every byte that
 * is not printable ASCII, and text beyond ORL_ERROR_TEXT_MAX bytes is cut off.
 */
json_t *orl_json_from_text(const char *text);

/* Returns a number, or json null for an infinity or a NaN. */
json_t *orl_json_from_real(double value);

/* Appends item to array and returns array; on failure frees array and returns NULL. Takes both
 * references. */
json_t *orl_json_append(json_t *array, json_t *item);

/* Returns json if failed is 0; otherwise frees it and returns NULL. */
json_t *orl_json_checked(json_t *json, int failed);

/*
 * Returns value as text (free()) with jansson's flags, or NULL when out of memory or if value is
 * NULL. Use it instead of json_dumps, which silently skips keys that it has no memory for and so
 * writes invalid JSON.
 */
char *orl_json_text(const json_t *value, size_t flags);

#endif

/*
 * Reads JSON text completely, or fails. jansson by itself silently truncates strings when memory
 * runs out. In the core only the glTF readers use this; it is here because api/ uses it too.
 *
 * Threads: any.
 */
#ifndef ORIEL_BASE_JSON_READ_H
#define ORIEL_BASE_JSON_READ_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

/* Returns a rough estimate of the memory, in bytes, that reading the text takes, also for many
 * small values. */
uint64_t orl_json_memory_estimate(const char *text, size_t size);

/*
 * Parses with jansson's flags. Returns a new reference, or NULL: errno is ENOMEM if memory ran out,
 * and 0 if the text is invalid. *ret_where, if not NULL, then gives the place.
 */
json_t *orl_json_read(const char *text, size_t size, size_t flags, json_error_t *ret_where);

/* Same as orl_json_read, and stops soon after *cancel is set (NULL: never), with errno
 * ECANCELED. */
json_t *orl_json_read_until(const char *text, size_t size, size_t flags, const atomic_bool *cancel,
                            json_error_t *ret_where);

/* Parses NUL-terminated text that Oriel has written; NULL text gives NULL, with errno 0. */
json_t *orl_json_read_stored(const char *text);

#endif

/*
 * Reads JSON text, whole or not at all. jansson by itself cuts strings short where it has no memory
 * for the rest of them, and says nothing. Of the core only readers of glTF use it; it stands here
 * for them and for api/.
 *
 * Threads: any.
 */
#ifndef ORIEL_JSON_READ_H
#define ORIEL_JSON_READ_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

/* Bytes of memory that reading the text will take, roughly, however small its values are. */
uint64_t orl_json_weight(const char *text, size_t size);

/*
 * With jansson's flags; a new reference. NULL: errno is ENOMEM where there was no memory, and 0
 * where the text is none, as *ret_where says, unless it is NULL.
 */
json_t *orl_json_read(const char *text, size_t size, size_t flags, json_error_t *ret_where);

/* Reads as orl_json_read does, and ends soon after *cancel is set (NULL: never), with errno
 * ECANCELED. */
json_t *orl_json_read_until(const char *text, size_t size, size_t flags, const atomic_bool *cancel,
                            json_error_t *ret_where);

/* What Oriel has written, to a NUL; NULL text gives NULL, with errno 0. */
json_t *orl_json_reread(const char *text);

#endif

/*
 * JSON values decoded into typed ones, with errors that name the JSON path. Objects are
 * members.h's.
 *
 * Every function takes the value (NULL when the member is absent), the path it was found at
 * ("views[2].width") for messages, and returns 0 or a negative orl_err with err filled in:
 * orl_error.primitive is the path. Outputs are untouched on failure.
 */
#ifndef ORL_API_DECODE_H
#define ORL_API_DECODE_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_JSON_PATH_MAX = 192 };

/*
 * Parses text; duplicate members are refused. name (the file's, or NULL) and the line of a mistake
 * go into err as ORL_ERR_SYNTAX. *ret_doc is a new reference.
 */
int orl_json_parse(const char *name, const char *text, size_t size, json_t **ret_doc,
                   struct orl_error *err);

/*
 * Ends the reading of JSON documents in this thread soon after *cancel is set, with
 * ORL_ERR_CANCELLED: parsing, and decoding of lists. NULL, the default: never. Borrows cancel until
 * the next call.
 */
void orl_json_heed(const atomic_bool *cancel);
/* Returns ORL_ERR_CANCELLED, with err filled in, when that is set. */
int orl_json_poll(struct orl_error *err);

/* value must be an array of at most max elements. */
int orl_json_array(const json_t *value, const char *path, size_t max, struct orl_error *err);
/* A whole number in [min, max]; 2e6 counts as whole. */
int orl_json_whole(const json_t *value, const char *path, uint64_t min, uint64_t max,
                   uint64_t *ret_value, struct orl_error *err);
int orl_json_real(const json_t *value, const char *path, double *ret_value, struct orl_error *err);
int orl_json_bool(const json_t *value, const char *path, bool *ret_value, struct orl_error *err);
/* A non-empty string of at most max bytes without NUL; *ret_text is owned (free()). */
int orl_json_string(const json_t *value, const char *path, size_t max, char **ret_text,
                    struct orl_error *err);
/* One of the words, which end with NULL: *ret_place is an enumeration, and becomes the word's place
 * among them. */
int orl_json_word(const json_t *value, const char *path, const char *const *words, void *ret_place,
                  struct orl_error *err);

/* Fails with "<wanted> is wanted here, not <what value is>". */
int orl_json_wrong_type(const json_t *value, const char *path, const char *wanted,
                        struct orl_error *err);
/* Fails with code at path; the message is "<path>: <what>". */
int orl_json_fail(struct orl_error *err, int code, const char *path, const char *what, ...)
    __attribute__((format(printf, 4, 5)));

#endif

/*
 * Decodes JSON values into typed ones, with errors that name the JSON path. members.h decodes
 * objects.
 *
 * Every function takes the value (NULL if the member is absent) and its path, such as
 * "views[2].width", for messages. It returns 0 or a negative orl_err with err filled in;
 * orl_error.primitive is the path. Outputs are untouched on failure.
 */
#ifndef ORL_API_JSON_DECODE_H
#define ORL_API_JSON_DECODE_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_JSON_PATH_MAX = 192 };

/*
 * Parses text and refuses duplicate members. An error is ORL_ERR_SYNTAX with the line and name
 * (the file's, or NULL). *ret_doc is a new reference.
 */
int orl_json_parse(const char *name, const char *text, size_t size, json_t **ret_doc,
                   struct orl_error *err);

/*
 * Sets the flag that cancels JSON reading in this thread: parsing and decoding of lists end with
 * ORL_ERR_CANCELLED soon after *cancel is set. NULL, the default, disables this. Borrows cancel
 * until the next call.
 */
void orl_json_set_cancel(const atomic_bool *cancel);
/* Returns ORL_ERR_CANCELLED, with err filled in, if that flag is set. */
int orl_json_poll(struct orl_error *err);

/* Fails unless value is an array of at most max elements. */
int orl_json_array(const json_t *value, const char *path, size_t max, struct orl_error *err);
/* Decodes a whole number in [min, max]; 2e6 counts as whole. */
int orl_json_whole(const json_t *value, const char *path, uint64_t min, uint64_t max,
                   uint64_t *ret_value, struct orl_error *err);
int orl_json_real(const json_t *value, const char *path, double *ret_value, struct orl_error *err);
int orl_json_bool(const json_t *value, const char *path, bool *ret_value, struct orl_error *err);
/* Decodes a non-empty string of at most max bytes without NUL; *ret_text is owned (free()). */
int orl_json_string(const json_t *value, const char *path, size_t max, char **ret_text,
                    struct orl_error *err);
/* Decodes one of the words; words ends with NULL. ret_index points to an enum, which is set to the
 * word's index. */
int orl_json_word(const json_t *value, const char *path, const char *const *words, void *ret_index,
                  struct orl_error *err);

/* Fails with "<wanted> is wanted here, not <what value is>". */
int orl_json_wrong_type(const json_t *value, const char *path, const char *wanted,
                        struct orl_error *err);
/* Fails with code at path; the message is "<path>: <what>". */
int orl_json_fail(struct orl_error *err, int code, const char *path, const char *what, ...)
    __attribute__((format(printf, 4, 5)));

#endif

/*
 * Objects of a glTF file's JSON, and their members by what they have to be. Messages name an object
 * by where it stands, as "nodes[3]".
 *
 * Functions return 0 or ORL_ERR_SYNTAX with err filled in. Where a member is absent they return 0,
 * and what they would have set stays as it is.
 */
#ifndef ORL_SCENE_PARSE_GLTF_JSON_H
#define ORL_SCENE_PARSE_GLTF_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include <jansson.h>

#include <oriel/error.h>

/* Borrows all of it. */
struct orl_gltf_item {
    const char *file;
    const json_t *root, *object;
    char name[96]; /* "": the root */
};

/* Says what is wrong with the item, and that the file has to be exported again. Returns code. */
int orl_gltf_fail(const struct orl_gltf_item *at, int code, struct orl_error *err,
                  const char *format, ...) __attribute__((format(printf, 4, 5)));

/* One of the root's lists, which the item at names. */
int orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_item, struct orl_error *err);

/* One of its own list of that name. */
int orl_gltf_part(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_part, struct orl_error *err);

/* An object in it; *ret_inner has none (NULL) where that is absent. */
int orl_gltf_inner(const struct orl_gltf_item *at, const char *key, struct orl_gltf_item *ret_inner,
                   struct orl_error *err);

/* How long a list in it is; 0: it is absent. */
int orl_gltf_length(const struct orl_gltf_item *at, const char *list, size_t *ret_length,
                    struct orl_error *err);

/* A whole number, from 0 to 2^53. */
int orl_gltf_whole(const struct orl_gltf_item *at, const char *key, size_t *value,
                   struct orl_error *err);
/* Such a one in a list. */
int orl_gltf_whole_of(const struct orl_gltf_item *at, const char *list, size_t i, size_t *ret_value,
                      struct orl_error *err);

/* n numbers in an array; *ret_given: it is there. */
int orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values,
                     bool *ret_given, struct orl_error *err);

/* NULL: absent, or no text. */
const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key);

#endif

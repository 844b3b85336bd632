/*
 * Objects of a glTF file's JSON, with checked access to their members. Messages name an object by
 * its position, such as "nodes[3]".
 *
 * Functions return 0 or ORL_ERR_SYNTAX with err filled. If a member is absent they return 0 and
 * leave the output unchanged.
 */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_JSON_H
#define ORL_SCENE_PARSE_GLTF_GLTF_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include <jansson.h>

#include <oriel/base/error.h>

/* All pointers are borrowed. */
struct orl_gltf_item {
    const char *file;
    const json_t *root, *object;
    char name[96]; /* "" for the root */
};

/* Reports what is wrong with the item, and that the file must be exported again. Returns code. */
int orl_gltf_fail(const struct orl_gltf_item *at, int code, struct orl_error *err,
                  const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Returns an element of one of the root's lists, which the item `at` refers to. */
int orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_item, struct orl_error *err);

/* Returns an element of one of the item's own lists. */
int orl_gltf_element(const struct orl_gltf_item *at, const char *list, size_t index,
                     struct orl_gltf_item *ret_part, struct orl_error *err);

/* Returns a member object; ret_inner->object is NULL if it is absent. */
int orl_gltf_member(const struct orl_gltf_item *at, const char *key,
                    struct orl_gltf_item *ret_inner, struct orl_error *err);

/* Returns the length of a member list; 0 if absent. */
int orl_gltf_length(const struct orl_gltf_item *at, const char *list, size_t *ret_length,
                    struct orl_error *err);

/* Reads an integer from 0 to 2^53. */
int orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t *value,
                     struct orl_error *err);
/* Reads an integer from 0 to 2^53 in a list. */
int orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i,
                             size_t *ret_value, struct orl_error *err);

/* Reads an array of n numbers; *ret_given: it is present. */
int orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values,
                     bool *ret_given, struct orl_error *err);

/* Returns NULL if the member is absent or not a string. */
const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key);

#endif

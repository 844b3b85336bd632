/*
 * What the parts of a model's translation share: where we are in the document, the files that are
 * being written, and checked values. Inside of api/honeybee only.
 */
#ifndef ORL_API_HONEYBEE_WRITING_H
#define ORL_API_HONEYBEE_WRITING_H

#include <stdint.h>
#include <stdio.h>

#include <oriel/vec.h>

#include "honeybee/hbjson.h"

/* A place in the document: a member of what up is, or its element where member is NULL. */
struct orl_hb_at {
    const struct orl_hb_at *up; /* NULL: the document */
    const char *member;
    size_t index;
};
/* Fails with the path in words, "<path>: <what>". */
int orl_hb_fail(const struct orl_hb_at *at, struct orl_error *err, int code, const char *what, ...)
    __attribute__((format(printf, 4, 5)));

/* A file being written. NULL stream: it is not begun. */
struct orl_hb_file {
    FILE *stream;
    char *text; /* the stream's */
    size_t size;
    uint32_t number; /* of the file, above 0: modifiers note by it where they are written */
};

struct orl_hb_modifier; /* modifiers.h */

struct orl_hb {
    const json_t *model;
    struct orl_error *err;
    struct orl_text_files files;
    uint64_t bytes; /* in files */
    uint32_t n_begun;
    double tolerance;
    struct orl_hb_modifier *modifiers; /* owned */
    size_t n_modifiers, modifier_room;
    json_t *modifier_places;     /* by identifier: where in modifiers */
    json_t *modifier_sets;       /* by identifier: the set */
    struct orl_hb_file warnings; /* a line each; begun with the first */
    uint32_t n_warnings;
};

int orl_hb_begin(struct orl_hb *hb, struct orl_hb_file *file);
/* ORL_ERR_LIMIT once all files together are too large; to be asked after every object. */
int orl_hb_check(struct orl_hb *hb, const struct orl_hb_file *file);
/* The file is hb's now, by that name; one that holds nothing is forgotten. */
int orl_hb_end(struct orl_hb *hb, struct orl_hb_file *file, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
void orl_hb_drop(struct orl_hb_file *file); /* NULL stream is fine */

/* Adds a line to model/warnings.txt, best effort, unless there are a hundred. */
void orl_hb_warn(struct orl_hb *hb, const char *format, ...) __attribute__((format(printf, 2, 3)));
int orl_hb_warnings_end(struct orl_hb *hb);

/* ---- Values ---------------------------------------------------------------------------------- */

/* A member that is not there, or null, is NULL. */
const json_t *orl_hb_get(const json_t *object, const char *member);
/* An array, or none: fails on anything else. */
int orl_hb_array(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                 const char *member, const json_t **ret_array);
/* A way along such an array, element after element: not to be copied. */
struct orl_hb_walk {
    const json_t *array;
    struct orl_hb_at list, here; /* here: the place of the element that came last */
};
int orl_hb_walk(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                const char *member, struct orl_hb_walk *ret_walk);
/* NULL: that was the last. */
json_t *orl_hb_next(struct orl_hb_walk *walk);
/* "properties"."radiance" of an object, or NULL. */
const json_t *orl_hb_radiance(const json_t *object);
/* An identifier as the schema has it: letters, digits, '.', '_', '-', at most 100, and no dot in
 * front. Borrowed. */
int orl_hb_identifier(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                      const char **ret_text);
int orl_hb_number(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                  double *ret_number);
int orl_hb_point(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                 struct orl_vec3 *ret_point);
bool orl_hb_flag(const json_t *object, const char *member);

#endif

/*
 * Shared by the parts of a model's translation: position in the document, output files, and
 * checked values. For api/honeybee only.
 */
#ifndef ORL_API_HONEYBEE_HB_WRITER_H
#define ORL_API_HONEYBEE_HB_WRITER_H

#include <stdint.h>
#include <stdio.h>

#include <oriel/base/vec.h>

#include "honeybee/hbjson.h"

/* A position in the document: a member of the object at up, or an element of the array if
 * member is NULL. */
struct orl_hb_at {
    const struct orl_hb_at *up; /* NULL: the document */
    const char *member;
    size_t index;
};
/* Fails with the message "<path>: <what>". */
int orl_hb_fail(const struct orl_hb_at *at, struct orl_error *err, int code, const char *what, ...)
    __attribute__((format(printf, 4, 5)));

/* A file being written; stream is NULL before it is begun. */
struct orl_hb_file {
    FILE *stream;
    char *text; /* owned by the stream */
    size_t size;
    uint32_t number; /* number of the file, above 0; modifiers store it as the file that has them */
};

struct orl_hb_modifier; /* modifiers.h */

struct orl_hb {
    const json_t *model;
    struct orl_error *err;
    struct orl_text_files files;
    uint64_t bytes; /* total size of files */
    uint32_t n_begun;
    double tolerance;
    struct orl_hb_modifier *modifiers; /* owned */
    size_t n_modifiers, modifier_room;
    json_t *modifier_indices;    /* index in modifiers by identifier */
    json_t *modifier_sets;       /* set by identifier */
    struct orl_hb_file warnings; /* one line per warning; begun with the first */
    uint32_t n_warnings;
};

int orl_hb_begin(struct orl_hb *hb, struct orl_hb_file *file);
/* Returns ORL_ERR_LIMIT if all files together are too large. Call it after every object. */
int orl_hb_check(struct orl_hb *hb, const struct orl_hb_file *file);
/* Moves the file into hb under that name; an empty file is dropped. */
int orl_hb_end(struct orl_hb *hb, struct orl_hb_file *file, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
void orl_hb_discard(struct orl_hb_file *file); /* NULL stream is fine */

/* Adds a line to model/warnings.txt, best effort, up to a hundred lines. */
void orl_hb_warn(struct orl_hb *hb, const char *format, ...) __attribute__((format(printf, 2, 3)));
int orl_hb_warnings_end(struct orl_hb *hb);

/* ---- Values ---------------------------------------------------------------------------------- */

/* Returns NULL if the member is absent or null. */
const json_t *orl_hb_get(const json_t *object, const char *member);
/* Reads an optional array; any other type fails. */
int orl_hb_array(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                 const char *member, const json_t **ret_array);
/* Iterator over such an array. It holds pointers into itself: do not copy it. */
struct orl_hb_walk {
    const json_t *array;
    struct orl_hb_at list, here; /* here: position of the current element */
};
int orl_hb_walk(struct orl_hb *hb, const json_t *object, const struct orl_hb_at *at,
                const char *member, struct orl_hb_walk *ret_walk);
/* Returns the next element, or NULL at the end. */
json_t *orl_hb_next(struct orl_hb_walk *walk);
/* Returns "properties"."radiance" of an object, or NULL. */
const json_t *orl_hb_radiance(const json_t *object);
/* Reads an identifier as in the schema: at most 100 letters, digits, '.', '_' and '-', and no
 * dot in front. Borrowed. */
int orl_hb_identifier(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                      const char **ret_text);
int orl_hb_number(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                  double *ret_number);
int orl_hb_point(struct orl_hb *hb, const json_t *value, const struct orl_hb_at *at,
                 struct orl_vec3 *ret_point);
bool orl_hb_flag(const json_t *object, const char *member);

#endif

/*
 * Similarity transforms as in the xform command, and the command's own options.
 *
 * Conventions: p' = linear p + offset; linear is |scale| times an orthogonal matrix, whose
 * determinant is negative if mirrored. "Inverted" (-I) flips surfaces without moving them.
 * Transforms apply in the order written; -i N repeats those up to the next -i. Reference: xform(1)
 * of Radiance.
 */
#ifndef ORL_SCENE_GENERATE_XFORM_H
#define ORL_SCENE_GENERATE_XFORM_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

struct orl_xform {
    struct orl_vec3 row[3]; /* rows of the linear part */
    struct orl_vec3 offset;
    double scale;  /* positive */
    bool mirrored; /* polygons must be listed in reverse order */
    bool inverted;
};

extern const struct orl_xform orl_xform_identity;

static inline struct orl_vec3 orl_xform_vector(const struct orl_xform *t, struct orl_vec3 v)
{
    return orl_v3(orl_dot(t->row[0], v), orl_dot(t->row[1], v), orl_dot(t->row[2], v));
}
static inline struct orl_vec3 orl_xform_point(const struct orl_xform *t, struct orl_vec3 p)
{
    return orl_add(orl_xform_vector(t, p), t->offset);
}

/* Returns the transform that applies inner first, then outer. */
struct orl_xform orl_xform_compose(const struct orl_xform *outer, const struct orl_xform *inner);

/*
 * Reads transforms from the front of words until one is none; *ret_used: number of words read.
 * Fails with ORL_ERR_SYNTAX or _RANGE (not finite, scale 0).
 */
int orl_xform_read(const char *const *words, size_t count, struct orl_xform *ret_xform,
                   size_t *ret_used, struct orl_error *err);

/* Parts of orl_xform_read: _repeats reads the number behind -i (word NULL: missing), _repeat
 * composes the block repeatedly behind total, _check returns ORL_ERR_RANGE unless the transform is
 * within range. */
int orl_xform_repeats(const char *word, int *ret_repeats, struct orl_error *err);
void orl_xform_repeat(struct orl_xform *total, const struct orl_xform *block, int times);
int orl_xform_check(const struct orl_xform *t, struct orl_error *err);

/* Size of a prefix for names (-n). */
enum { ORL_PREFIX_BYTES = 512 };

/* One use of the command after -a and -f have been expanded. */
struct orl_xform_use {
    struct orl_xform xform;
    const char *modifier;     /* -m; may be NULL */
    const char *prefix;       /* -n; may be NULL */
    const char *const *files; /* the words after the transforms */
    size_t n_files;
    size_t n_words; /* number of words read for it; combined transforms count as one */
};

/* Called for each use in order with borrowed arguments. A negative result ends the expansion. */
typedef int (*orl_xform_user)(void *ctx, const struct orl_xform_use *use, struct orl_error *err);

/* Reads the text of an argument file (-f) into an owned string. */
typedef int (*orl_xform_reader)(void *ctx, const char *name, char **ret_text,
                                struct orl_error *err);

/*
 * Expands "xform" with the words that follow it. Fails with ORL_ERR_SYNTAX, _RANGE, _LIMIT (more
 * than ORL_LIMIT_XFORM_ARRAY copies), or what the callbacks return.
 */
int orl_xform_expand(const char *const *words, size_t count, orl_xform_reader reader,
                     orl_xform_user user, void *ctx, struct orl_error *err);

#endif

/*
 * Similarity transforms as the xform command writes them, and the command's own options.
 *
 * Conventions: p' = linear p + offset; linear is |scale| times an orthogonal matrix, its
 * determinant negative when mirrored. "Inverted" (-I) turns surfaces inside out without moving
 * them. Transforms apply in the order written; -i N repeats those up to the next -i. Reference:
 * xform(1) of Radiance.
 */
#ifndef ORL_SCENE_GENERATE_XFORM_H
#define ORL_SCENE_GENERATE_XFORM_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_xform {
    struct orl_vec3 row[3]; /* of the linear part */
    struct orl_vec3 offset;
    double scale;  /* positive */
    bool mirrored; /* polygons must be listed the other way round */
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

/* First inner, then outer. */
struct orl_xform orl_xform_compose(const struct orl_xform *outer, const struct orl_xform *inner);

/*
 * Reads transforms from the front of words until one is none; ret_used says how many words that
 * took. Fails with ORL_ERR_SYNTAX or _RANGE (not finite, scale 0).
 */
int orl_xform_read(const char *const *words, size_t count, struct orl_xform *ret_xform,
                   size_t *ret_used, struct orl_error *err);

/* What it is made of: the number behind -i (NULL: there is none), the block repeated behind what is
 * there, and ORL_ERR_RANGE unless it is within range. */
int orl_xform_repeats(const char *word, int *ret_repeats, struct orl_error *err);
void orl_xform_repeat(struct orl_xform *total, const struct orl_xform *block, int times);
int orl_xform_check(const struct orl_xform *t, struct orl_error *err);

/* Room for the prefix that -n puts before names. */
enum { ORL_PREFIX_BYTES = 512 };

/* One plain use of the command: what -a and -f have been expanded to. */
struct orl_xform_use {
    struct orl_xform xform;
    const char *modifier;     /* -m, or NULL */
    const char *prefix;       /* -n, or NULL */
    const char *const *files; /* the words after the transforms */
    size_t n_files;
    size_t n_words; /* that were read for it, those of many transforms as one */
};

/* Called for each use in order; borrowed arguments. A negative result ends the expansion. */
typedef int (*orl_xform_user)(void *ctx, const struct orl_xform_use *use, struct orl_error *err);

/* Fetches the text of an argument file (-f) into an owned string. */
typedef int (*orl_xform_reader)(void *ctx, const char *name, char **ret_text,
                                struct orl_error *err);

/*
 * Expands "xform" with the words that follow it. Fails with ORL_ERR_SYNTAX, _RANGE, _LIMIT (more
 * than ORL_LIMIT_XFORM_ARRAY copies), or what the callbacks return.
 */
int orl_xform_expand(const char *const *words, size_t count, orl_xform_reader reader,
                     orl_xform_user user, void *ctx, struct orl_error *err);

#endif

#include "scene/geometry/concentric.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/crew.h>

enum family { SPHERES, CYLINDERS, CONES, NO_FAMILY };

/* A quadric; surfaces that may coincide have about the same key. */
struct round {
    enum family family;
    uint32_t surface;
    double key;
};

static const struct orl_vec3 odd = {0.5257311121191336, 0.3090169943749474, 0.7925302842541783};

static enum family family_of(const struct orl_surface *s)
{
    switch (s->kind) {
    case ORL_SURFACE_SPHERE:
    case ORL_SURFACE_BUBBLE:
        return SPHERES;
    case ORL_SURFACE_CYLINDER:
    case ORL_SURFACE_TUBE:
        return CYLINDERS;
    case ORL_SURFACE_CONE:
    case ORL_SURFACE_CUP:
        return CONES;
    default:
        return NO_FAMILY;
    }
}

/* Returns the axis with a fixed sign, whichever end is listed first. */
static struct orl_vec3 axis_of(const struct orl_surface *s)
{
    const struct orl_vec3 axis = orl_normalize(orl_sub(s->round->center[1], s->round->center[0]));
    return orl_dot(axis, odd) < 0 ? orl_neg(axis) : axis;
}

static double key_of(const struct orl_surface *s, enum family family,
                     const struct orl_same_place *place)
{
    const struct orl_vec3 from = orl_sub(s->round->center[0], place->middle);
    if (family == SPHERES)
        return orl_dot(from, odd) + s->round->radius[0];
    if (family == CONES)
        return orl_dot(orl_add(from, orl_sub(s->round->center[1], place->middle)), odd) +
               s->round->radius[0] + s->round->radius[1];
    const struct orl_vec3 axis = axis_of(s);
    return orl_dot(orl_madd(from, axis, -orl_dot(from, axis)), odd) +
           place->reach * orl_dot(axis, odd) + s->round->radius[0];
}

static int compare_rounds(const void *left, const void *right)
{
    const struct round *a = left, *b = right;
    if (a->family != b->family)
        return a->family < b->family ? -1 : 1;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->surface < b->surface ? -1 : a->surface > b->surface;
}

static bool are_near(struct orl_vec3 a, struct orl_vec3 b, double tolerance)
{
    return orl_length(orl_sub(a, b)) <= tolerance;
}

static bool are_alike(double a, double b, double tolerance)
{
    return fabs(a - b) <= tolerance;
}

/* Returns true if both are about the first one's axis, and overlap along it by more than the
 * seam. */
static bool cylinders_meet(const struct orl_surface *a, const struct orl_surface *b, double seam)
{
    const struct orl_vec3 along = orl_sub(a->round->center[1], a->round->center[0]);
    const double length = orl_length(along);
    double at[2];
    for (int i = 0; i < 2; i++) {
        const struct orl_vec3 from = orl_sub(b->round->center[i], a->round->center[0]);
        at[i] = orl_dot(from, along) / length;
        if (orl_length(orl_madd(from, along, -at[i] / length)) > seam)
            return false;
    }
    return are_alike(a->round->radius[0], b->round->radius[0], seam) &&
           fmin(fmax(at[0], at[1]), length) - fmax(fmin(at[0], at[1]), 0) > seam;
}

static bool cones_meet(const struct orl_surface *a, const struct orl_surface *b, double seam)
{
    for (int turn = 0; turn < 2; turn++) {
        bool all = true;
        for (int i = 0; i < 2; i++)
            all = all && are_near(a->round->center[i], b->round->center[i ^ turn], seam) &&
                  are_alike(a->round->radius[i], b->round->radius[i ^ turn], seam);
        if (all)
            return true;
    }
    return false;
}

static bool rounds_meet(const struct orl_surface *a, const struct orl_surface *b,
                        enum family family, double seam)
{
    if (family == SPHERES)
        return are_near(a->round->center[0], b->round->center[0], seam) &&
               are_alike(a->round->radius[0], b->round->radius[0], seam);
    return family == CYLINDERS ? cylinders_meet(a, b, seam) : cones_meet(a, b, seam);
}

static struct round *list_rounds(const struct orl_description *d,
                                 const struct orl_same_place *place, size_t *ret_n)
{
    size_t n = 0;
    for (size_t i = 0; i < d->n_surfaces; i++)
        n += family_of(&d->surfaces[i]) != NO_FAMILY;
    struct round *rounds = malloc((n + 1) * sizeof *rounds);
    *ret_n = n;
    n = 0;
    for (size_t i = 0; i < d->n_surfaces && rounds; i++) {
        const enum family family = family_of(&d->surfaces[i]);
        if (family != NO_FAMILY)
            rounds[n++] =
                (struct round){family, (uint32_t)i, key_of(&d->surfaces[i], family, place)};
    }
    return rounds;
}

int orl_concentric_find(const struct orl_description *description,
                        const struct orl_same_place *place, struct orl_pairs *pairs,
                        struct orl_looks *looks)
{
    const double seam = place->tolerance, apart = 4 * seam;
    size_t n;
    struct round *rounds = list_rounds(description, place, &n);
    int code = rounds ? 0 : ORL_ERR_NOMEM;
    if (rounds)
        qsort(rounds, n, sizeof *rounds, compare_rounds);
    for (size_t i = 0; i < n && code == 0 && !orl_is_cancelled(description->cancel); i++) {
        const struct orl_surface *s = &description->surfaces[rounds[i].surface];
        for (size_t j = i + 1; j < n && code == 0 && rounds[j].family == rounds[i].family &&
                               rounds[j].key - rounds[i].key <= apart && looks->n <= looks->most;
             j++) {
            looks->n++;
            if (rounds_meet(s, &description->surfaces[rounds[j].surface], rounds[i].family, seam) &&
                !orl_pairs_add(pairs, rounds[i].surface, rounds[j].surface))
                code = ORL_ERR_NOMEM;
        }
    }
    free(rounds);
    return code;
}

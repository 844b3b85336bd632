#include "scene/geometry/coincidence/coincident_quadrics.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

enum family { SPHERES, CYLINDERS, CONES, NO_FAMILY };

/* A quadric; surfaces that may coincide have about the same key. */
struct quadric {
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
    const struct orl_vec3 axis =
        orl_normalize(orl_sub(s->quadric->center[1], s->quadric->center[0]));
    return orl_dot(axis, odd) < 0 ? orl_neg(axis) : axis;
}

static double key_of(const struct orl_surface *s, enum family family,
                     const struct orl_coincidence_scale *scale)
{
    const struct orl_vec3 from = orl_sub(s->quadric->center[0], scale->middle);
    if (family == SPHERES)
        return orl_dot(from, odd) + s->quadric->radius[0];
    if (family == CONES)
        return orl_dot(orl_add(from, orl_sub(s->quadric->center[1], scale->middle)), odd) +
               s->quadric->radius[0] + s->quadric->radius[1];
    const struct orl_vec3 axis = axis_of(s);
    return orl_dot(orl_madd(from, axis, -orl_dot(from, axis)), odd) +
           scale->reach * orl_dot(axis, odd) + s->quadric->radius[0];
}

static int compare_quadrics(const void *left, const void *right)
{
    const struct quadric *a = left, *b = right;
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
    const struct orl_vec3 along = orl_sub(a->quadric->center[1], a->quadric->center[0]);
    const double length = orl_length(along);
    double at[2];
    for (int i = 0; i < 2; i++) {
        const struct orl_vec3 from = orl_sub(b->quadric->center[i], a->quadric->center[0]);
        at[i] = orl_dot(from, along) / length;
        if (orl_length(orl_madd(from, along, -at[i] / length)) > seam)
            return false;
    }
    return are_alike(a->quadric->radius[0], b->quadric->radius[0], seam) &&
           fmin(fmax(at[0], at[1]), length) - fmax(fmin(at[0], at[1]), 0) > seam;
}

static bool cones_meet(const struct orl_surface *a, const struct orl_surface *b, double seam)
{
    for (int turn = 0; turn < 2; turn++) {
        bool all = true;
        for (int i = 0; i < 2; i++)
            all = all && are_near(a->quadric->center[i], b->quadric->center[i ^ turn], seam) &&
                  are_alike(a->quadric->radius[i], b->quadric->radius[i ^ turn], seam);
        if (all)
            return true;
    }
    return false;
}

static bool quadrics_meet(const struct orl_surface *a, const struct orl_surface *b,
                          enum family family, double seam)
{
    if (family == SPHERES)
        return are_near(a->quadric->center[0], b->quadric->center[0], seam) &&
               are_alike(a->quadric->radius[0], b->quadric->radius[0], seam);
    return family == CYLINDERS ? cylinders_meet(a, b, seam) : cones_meet(a, b, seam);
}

static struct quadric *list_quadrics(const struct orl_parsed_scene *d,
                                     const struct orl_coincidence_scale *scale, size_t *ret_n)
{
    size_t n = 0;
    for (size_t i = 0; i < d->n_surfaces; i++)
        n += family_of(&d->surfaces[i]) != NO_FAMILY;
    struct quadric *quadrics = malloc((n + 1) * sizeof *quadrics);
    *ret_n = n;
    n = 0;
    for (size_t i = 0; i < d->n_surfaces && quadrics; i++) {
        const enum family family = family_of(&d->surfaces[i]);
        if (family != NO_FAMILY)
            quadrics[n++] =
                (struct quadric){family, (uint32_t)i, key_of(&d->surfaces[i], family, scale)};
    }
    return quadrics;
}

int orl_concentric_find(const struct orl_parsed_scene *parsed_scene,
                        const struct orl_coincidence_scale *scale, struct orl_pairs *pairs,
                        struct orl_comparison_budget *budget)
{
    const double seam = scale->tolerance, apart = 4 * seam;
    size_t n;
    struct quadric *quadrics = list_quadrics(parsed_scene, scale, &n);
    int code = quadrics ? 0 : ORL_ERR_NOMEM;
    if (quadrics)
        qsort(quadrics, n, sizeof *quadrics, compare_quadrics);
    for (size_t i = 0; i < n && code == 0 && !orl_is_cancelled(parsed_scene->cancel); i++) {
        const struct orl_surface *s = &parsed_scene->surfaces[quadrics[i].surface];
        for (size_t j = i + 1;
             j < n && code == 0 && quadrics[j].family == quadrics[i].family &&
             quadrics[j].key - quadrics[i].key <= apart && budget->n <= budget->most;
             j++) {
            budget->n++;
            if (quadrics_meet(s, &parsed_scene->surfaces[quadrics[j].surface], quadrics[i].family,
                              seam) &&
                !orl_pairs_add(pairs, quadrics[i].surface, quadrics[j].surface))
                code = ORL_ERR_NOMEM;
        }
    }
    free(quadrics);
    return code;
}

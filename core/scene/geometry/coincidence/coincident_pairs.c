#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

#include "base/statistics/numeric.h"
#include "scene/geometry/coincidence/coincident.h"
#include "scene/geometry/coincidence/coincident_pairs.h"
#include "scene/geometry/coincidence/cutting.h"

enum { MOST_CORNERS = 16 };

/* Excludes surfaces that antimatter cuts, among others: the search for all pairs decides about
 * them, and may refuse them. */
static bool may_be_covered(const struct orl_parsed_scene *d, const bool *is_cut,
                           const struct orl_surface *s)
{
    return s->kind == ORL_SURFACE_POLYGON && !is_cut[s->material] && !orl_surface_is_hole(d, s) &&
           !orl_surface_is_proxy(d, s) && orl_coincidence_class(&d->materials[s->material]) == 2;
}

/* Returns true if all corners of the loser lie in the winner's plane, on the inner side of each
 * line through its edges. Inside a concave winner the test fails at some such line. */
static bool holds_corners(const struct orl_surface *winner, const struct orl_surface *loser,
                          double tolerance)
{
    for (uint32_t i = 0; i < loser->n_vertices; i++)
        if (!(fabs(orl_dot(orl_sub(loser->vertices[i], winner->vertices[0]), winner->normal)) <=
              tolerance))
            return false;
    for (uint32_t k = 0; k < winner->n_vertices; k++) {
        const struct orl_vec3 from = winner->vertices[k];
        const struct orl_vec3 edge = orl_sub(winner->vertices[(k + 1) % winner->n_vertices], from);
        const struct orl_vec3 inwards = orl_cross(winner->normal, edge);
        for (uint32_t i = 0; i < loser->n_vertices; i++)
            if (orl_dot(orl_sub(loser->vertices[i], from), inwards) < 0)
                return false;
    }
    return true;
}

/*
 * Returns true if the winner covers the loser completely. Only corners are compared: the result may
 * be false for a concave winner, and is false for one with many corners. is_cut: by material, true
 * if antimatter cuts it.
 */
static bool polygon_covers(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                           const struct orl_surface *winner, const struct orl_surface *loser,
                           double tolerance)
{
    const struct orl_parsed_scene *const d = parsed_scene;
    return winner != loser && may_be_covered(d, is_cut, winner) &&
           may_be_covered(d, is_cut, loser) && winner->n_vertices <= MOST_CORNERS &&
           orl_coincidence_compare(d, winner, loser) > 0 && holds_corners(winner, loser, tolerance);
}

/* A polygon or ring, with the key of its plane. */
struct flat {
    double key; /* nearly equal for all surfaces of one plane */
    struct orl_box box;
    uint32_t surface;
};

struct search {
    const struct orl_parsed_scene *d;
    const bool *is_cut; /* by material: true if antimatter cuts it */
    struct orl_coincidence_scale scale;
    struct flat *flats;
    size_t n_flats;
    struct orl_pairs *pairs;
    struct orl_comparison_budget *budget;
    struct orl_box_tree tree;
};

static struct orl_vec3 point_of(const struct orl_surface *s)
{
    return s->kind == ORL_SURFACE_RING ? s->quadric->center[0] : s->vertices[0];
}

/* An arbitrary direction that no surface is likely to be parallel to. */
static const struct orl_vec3 odd_direction = {0.5257311121191336, 0.3090169943749474,
                                              0.7925302842541783};

/* Returns a number that distinguishes planes: the distance, plus the normal's component along
 * odd_direction. */
static double plane_key(const struct orl_coincidence_scale *scale, const struct orl_surface *s)
{
    const double sign = orl_dot(s->normal, odd_direction) < 0 ? -1 : 1;
    const double distance = orl_dot(s->normal, orl_sub(point_of(s), scale->middle));
    return sign * (distance + scale->reach * orl_dot(s->normal, odd_direction));
}

/* ---- Sorting --------------------------------------------------------------------------------- */

static bool list_flats(struct search *t)
{
    const struct orl_parsed_scene *d = t->d;
    struct orl_box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    t->flats = malloc((d->n_surfaces + 1) * sizeof *t->flats);
    if (!t->flats)
        return false;
    for (size_t i = 0; i < d->n_surfaces; i++) {
        struct flat *f = &t->flats[t->n_flats];
        if (!orl_surface_kind_is_flat(d->surfaces[i].kind))
            continue;
        f->box = orl_box_of_flat(&d->surfaces[i]);
        f->surface = (uint32_t)i;
        orl_box_include(f->box.low, &all.low, &all.high);
        orl_box_include(f->box.high, &all.low, &all.high);
        t->n_flats++;
    }
    if (t->n_flats > 0) {
        t->scale.middle = orl_scale(orl_add(all.low, all.high), 0.5);
        t->scale.reach = 0.5 * orl_length(orl_sub(all.high, all.low));
    }
    t->scale.tolerance = fmax(1e-6, t->scale.reach * 0x1p-21);
    for (size_t i = 0; i < t->n_flats; i++)
        t->flats[i].key = plane_key(&t->scale, &d->surfaces[t->flats[i].surface]);
    return true;
}

static int compare_keys(const void *left, const void *right)
{
    const struct flat *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->surface < b->surface ? -1 : a->surface > b->surface;
}

/* Coordinate along (1, 1, 1), which is perpendicular to no usual plane of a building. */
static double start_of(const struct flat *f)
{
    return f->box.low.x + f->box.low.y + f->box.low.z;
}

static int compare_starts(const void *left, const void *right)
{
    const struct flat *a = left, *b = right;
    const double first = start_of(a), second = start_of(b);
    if (first != second)
        return first < second ? -1 : 1;
    return a->surface < b->surface ? -1 : a->surface > b->surface;
}

/* ---- Pairs ----------------------------------------------------------------------------------- */

/* Returns true if all corners (or the ring's centre) lie in the other's plane. */
static bool lies_in(const struct search *t, const struct orl_surface *s,
                    const struct orl_surface *plane)
{
    const struct orl_vec3 origin = point_of(plane);
    const uint32_t n = s->kind == ORL_SURFACE_RING ? 1 : s->n_vertices;
    const struct orl_vec3 *points = s->kind == ORL_SURFACE_RING ? s->quadric->center : s->vertices;
    for (uint32_t i = 0; i < n; i++)
        if (!(fabs(orl_dot(orl_sub(points[i], origin), plane->normal)) <= t->scale.tolerance))
            return false;
    return true;
}

static bool test_pair(struct search *t, const struct flat *a, const struct flat *b)
{
    const double tolerance = t->scale.tolerance;
    const struct orl_surface *s = &t->d->surfaces[a->surface];
    const struct orl_surface *other = &t->d->surfaces[b->surface];
    if (!orl_boxes_meet(&a->box, &b->box, tolerance) ||
        fabs(orl_dot(s->normal, other->normal)) < 1 - 1e-6 ||
        (!lies_in(t, s, other) && !lies_in(t, other, s)))
        return true;
    if (s->kind == ORL_SURFACE_POLYGON && other->kind == ORL_SURFACE_POLYGON) {
        const struct orl_outline first = orl_outline_of(s), second = orl_outline_of(other);
        t->budget->n += 4 * ((uint64_t)first.n + second.n);
        if (orl_outlines_apart(&first, &second, tolerance))
            return true;
    }
    return orl_pairs_add(t->pairs, a->surface, b->surface);
}

/* Finds the pairs of many surfaces by a box tree, in the order of the sweep. */
static bool test_by_tree(struct search *t, const struct flat *flats, size_t n)
{
    struct orl_box_tree *const tree = &t->tree;
    const double tolerance = t->scale.tolerance;
    if (!orl_box_tree_build(tree, &flats[0].box, sizeof *flats, n))
        return false;
    for (size_t i = 0; i < n; i++) {
        if (i % 1024 == 0 && orl_is_cancelled(t->d->cancel))
            return true;
        if (!orl_box_tree_find(tree, &flats[i].box, (int64_t)i, tolerance, &t->budget->n))
            return false;
        for (size_t k = 0; k < tree->n_found; k++) {
            if (t->budget->n > t->budget->most || (k % 1024 == 0 && orl_is_cancelled(t->d->cancel)))
                return true;
            if (!test_pair(t, &flats[i], &flats[tree->found[k]]))
                return false;
        }
    }
    return true;
}

static double size_of(const struct flat *f)
{
    const struct orl_vec3 size = orl_sub(f->box.high, f->box.low);
    return orl_dot(size, size);
}

/* Moves the largest flats to the front, in descending order. */
static void bring_largest_first(struct flat *flats, size_t n, size_t n_largest,
                                const atomic_bool *cancel)
{
    for (size_t k = 0; k < n_largest && !orl_is_cancelled(cancel); k++)
        for (size_t i = n - 1; i > k; i--)
            if (size_of(&flats[i]) > size_of(&flats[i - 1])) {
                const struct flat one = flats[i];
                flats[i] = flats[i - 1];
                flats[i - 1] = one;
            }
}

/* Removes each polygon that one of the largest covers completely; only that pair of it is listed.
 * Returns false if out of memory. */
static bool remove_covered(struct search *t, struct flat *flats, size_t *n)
{
    enum { LARGEST = 8 };
    size_t kept = 0;
    bring_largest_first(flats, *n, LARGEST, t->d->cancel);
    for (size_t i = 0; i < *n; i++) {
        const struct orl_surface *const loser = &t->d->surfaces[flats[i].surface];
        size_t k = 0;
        if (i % 1024 == 0 && orl_is_cancelled(t->d->cancel))
            return true; /* the caller polls too */
        for (; k < LARGEST && k < kept; k++) {
            t->budget->n++;
            if (polygon_covers(t->d, t->is_cut, &t->d->surfaces[flats[k].surface], loser,
                               t->scale.tolerance))
                break;
        }
        if (k == LARGEST || k == kept)
            flats[kept++] = flats[i];
        else if (!orl_pairs_add(t->pairs, flats[k].surface, flats[i].surface))
            return false;
    }
    *n = kept;
    return true;
}

/* Finds all pairs of one plane, which are adjacent after sorting; a few are compared by a sweep. */
static bool test_plane(struct search *t, struct flat *flats, size_t n)
{
    enum { FEW = 16 };
    if (n > FEW && !remove_covered(t, flats, &n))
        return false;
    const int code = orl_sort(flats, n, sizeof *flats, compare_starts, t->d->cancel);
    if (code < 0)
        return code == ORL_ERR_CANCELLED;
    if (n > FEW)
        return test_by_tree(t, flats, n);
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 high = flats[i].box.high;
        const double end = high.x + high.y + high.z + 3 * t->scale.tolerance;
        for (size_t j = i + 1; j < n && start_of(&flats[j]) <= end; j++) {
            t->budget->n++;
            if (!test_pair(t, &flats[i], &flats[j]))
                return false;
        }
    }
    return true;
}

static bool find_pairs(struct search *t)
{
    const double apart = 4 * t->scale.tolerance;
    const int code = orl_sort(t->flats, t->n_flats, sizeof *t->flats, compare_keys, t->d->cancel);
    if (code < 0)
        return code == ORL_ERR_CANCELLED; /* the caller polls too */
    for (size_t first = 0, next; first < t->n_flats; first = next) {
        for (next = first + 1;
             next < t->n_flats && t->flats[next].key - t->flats[next - 1].key <= apart; next++)
            ;
        if (next - first > 1 && !test_plane(t, t->flats + first, next - first))
            return false;
        if (t->budget->n > t->budget->most || orl_is_cancelled(t->d->cancel))
            break;
    }
    return true;
}

int orl_coplanar_find(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                      struct orl_coincidence_scale *ret_scale, struct orl_pairs *pairs,
                      struct orl_comparison_budget *budget)
{
    struct search t = {.d = parsed_scene, .is_cut = is_cut, .pairs = pairs, .budget = budget};
    int code = list_flats(&t) && find_pairs(&t) ? 0 : ORL_ERR_NOMEM;
    if (code == 0 && orl_is_cancelled(parsed_scene->cancel))
        code = ORL_ERR_CANCELLED;
    *ret_scale = t.scale;
    orl_box_tree_done(&t.tree);
    free(t.flats);
    return code;
}

enum family { SPHERES, CYLINDERS, CONES, NO_FAMILY };

/* A quadric; surfaces that may coincide have about the same key. */
struct quadric {
    enum family family;
    uint32_t surface;
    double key;
};

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
    return orl_dot(axis, odd_direction) < 0 ? orl_neg(axis) : axis;
}

static double quadric_key(const struct orl_surface *s, enum family family,
                          const struct orl_coincidence_scale *scale)
{
    const struct orl_vec3 from = orl_sub(s->quadric->center[0], scale->middle);
    if (family == SPHERES)
        return orl_dot(from, odd_direction) + s->quadric->radius[0];
    if (family == CONES)
        return orl_dot(orl_add(from, orl_sub(s->quadric->center[1], scale->middle)),
                       odd_direction) +
               s->quadric->radius[0] + s->quadric->radius[1];
    const struct orl_vec3 axis = axis_of(s);
    return orl_dot(orl_madd(from, axis, -orl_dot(from, axis)), odd_direction) +
           scale->reach * orl_dot(axis, odd_direction) + s->quadric->radius[0];
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
                (struct quadric){family, (uint32_t)i, quadric_key(&d->surfaces[i], family, scale)};
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

#include "render/gather/direction_sampling.h"

#include <stdlib.h>
#include <string.h>

#include "scene/geometry/instances.h"
#include "scene/geometry/intersect.h"
#include "scene/material/scatter.h"

/* Largest radius of a target, as a share of the scene's; reflectance from which a flat surface is a
 * mirror. */
static const double largest = 0.25, least_mirrored = 0.2;
static const double parallel = 0.999; /* cosine between normals of surfaces that face one way */

/* A facet or a placed copy, with its bounding sphere. */
struct item {
    struct orl_target_sphere bound;
    uint32_t index;
    bool instance;
};

/* Facets of a material that are targets: none, round ones, all. */
enum rule { RULE_NONE, RULE_ROUND, RULE_ALL };

struct finder {
    const struct orl_lit_scene *lit_scene;
    struct orl_targets *targets;
    struct item *items;
    size_t n;
    struct orl_vec3 (*faces)[2]; /* by material: two normals of its flat facets */
    enum rule *rules;            /* by material */
    bool *prototypes;            /* by prototype: its copies are targets */
};

/* ---- Selection of targets -------------------------------------------------------------------- */

static enum rule rule_of(const struct orl_material *m)
{
    if (orl_material_deviates(m))
        return RULE_ROUND;
    return orl_material_is_mirror(m) && (orl_material_max_mirrored(m, true, 1) > least_mirrored ||
                                         orl_material_max_mirrored(m, false, 1) > least_mirrored)
               ? RULE_ALL
               : RULE_NONE;
}

/* Materials that refract and whose facets face more than two ways enclose a body that may be a
 * lens: panes of thick glass and water only shift light. */
static void find_solids(struct finder *f, const struct orl_geometry *geometry)
{
    struct orl_facet own;
    for (size_t i = 0; i < geometry->n_facets; i++) {
        const struct orl_facet *facet = orl_facet_get_own(geometry, i, &own);
        struct orl_vec3 *const faces = f->faces[facet->material];
        if (f->rules[facet->material] != RULE_ROUND || !orl_surface_kind_is_flat(facet->kind))
            continue;
        bool known = false;
        for (int side = 0; side < 2 && !known; side++) {
            if (!(orl_dot(faces[side], faces[side]) > 0))
                faces[side] = facet->normal;
            known = fabs(orl_dot(faces[side], facet->normal)) >= parallel;
        }
        if (!known)
            f->rules[facet->material] = RULE_ALL;
    }
}

static bool is_target(const struct finder *f, const struct orl_facet *facet)
{
    const enum rule rule = f->rules[facet->material];
    return rule == RULE_ALL || (rule == RULE_ROUND && !orl_surface_kind_is_flat(facet->kind));
}

/* ---- Bounding spheres ------------------------------------------------------------------------ */

static struct orl_target_sphere about_box(struct orl_vec3 low, struct orl_vec3 high)
{
    return (struct orl_target_sphere){orl_scale(orl_add(low, high), 0.5),
                                      0.5 * orl_length(orl_sub(high, low))};
}

static void extend_box(struct orl_vec3 *low, struct orl_vec3 *high, struct orl_vec3 point)
{
    *low = orl_v3(fmin(low->x, point.x), fmin(low->y, point.y), fmin(low->z, point.z));
    *high = orl_v3(fmax(high->x, point.x), fmax(high->y, point.y), fmax(high->z, point.z));
}

static struct orl_target_sphere about_facet(const struct orl_geometry *g,
                                            const struct orl_facet *facet)
{
    struct orl_vec3 low = orl_v3(INFINITY, INFINITY, INFINITY), high = orl_neg(low);
    if (facet->kind == ORL_SURFACE_SPHERE || facet->kind == ORL_SURFACE_BUBBLE)
        return (struct orl_target_sphere){facet->quadric->center[0], facet->quadric->radius[0]};
    if (facet->kind == ORL_SURFACE_POLYGON)
        for (uint32_t i = 0; i < facet->n_triangles; i++) {
            const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(facet, i));
            extend_box(&low, &high, t.a);
            extend_box(&low, &high, t.b);
            extend_box(&low, &high, t.c);
        }
    else
        orl_quadric_bounds(facet, &low, &high);
    return about_box(low, high);
}

static struct orl_target_sphere about_items(const struct item *items, size_t n)
{
    struct orl_vec3 low = orl_v3(INFINITY, INFINITY, INFINITY), high = orl_neg(low);
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 c = items[i].bound.center, r = orl_v3(1, 1, 1);
        extend_box(&low, &high, orl_madd(c, r, items[i].bound.radius));
        extend_box(&low, &high, orl_madd(c, r, -items[i].bound.radius));
    }
    struct orl_target_sphere bound = {orl_scale(orl_add(low, high), 0.5), 0};
    for (size_t i = 0; i < n; i++)
        bound.radius = fmax(bound.radius, orl_length(orl_sub(items[i].bound.center, bound.center)) +
                                              items[i].bound.radius);
    return bound;
}

/* ---- Groups ---------------------------------------------------------------------------------- */

static double along(struct orl_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Moves the items below the middle of the longest axis to the front; returns their number. */
static size_t divide_items(struct item *items, size_t n)
{
    struct orl_vec3 low = items[0].bound.center, high = low;
    for (size_t i = 1; i < n; i++)
        extend_box(&low, &high, items[i].bound.center);
    const struct orl_vec3 size = orl_sub(high, low);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const double middle = 0.5 * (along(low, axis) + along(high, axis));
    size_t front = 0;
    for (size_t i = 0; i < n; i++)
        if (along(items[i].bound.center, axis) < middle) {
            const struct item moved = items[i];
            items[i] = items[front];
            items[front++] = moved;
        }
    return front;
}

static void add_target(struct finder *f, const struct item *items, size_t n,
                       struct orl_target_sphere bound)
{
    struct orl_targets *const t = f->targets;
    if (t->n == ORL_MOST_TARGETS || bound.radius > largest * f->lit_scene->geometry->radius ||
        orl_lit_scene_is_outside(f->lit_scene, bound.center))
        return;
    for (size_t i = 0; i < n; i++)
        (items[i].instance ? t->of_instance : t->of_facet)[items[i].index] = (uint8_t)t->n;
    t->at[t->n++] = bound;
}

static void add_groups(struct finder *f, struct item *items, size_t n, uint32_t most)
{
    const struct orl_target_sphere bound = about_items(items, n);
    const size_t front = most > 1 ? divide_items(items, n) : 0;
    if (front > 0 && front < n) {
        const double r1 = about_items(items, front).radius,
                     r2 = about_items(items + front, n - front).radius;
        if (r1 * r1 + r2 * r2 < 0.5 * bound.radius * bound.radius) {
            add_groups(f, items, front, most / 2);
            add_groups(f, items + front, n - front, most / 2);
            return;
        }
    }
    add_target(f, items, n, bound);
}

/* ---- Search for targets ---------------------------------------------------------------------- */

/* Adds an item if there is memory for items; else only counts it. */
static void add_item(struct finder *f, struct orl_target_sphere bound, size_t index, bool instance)
{
    if (f->items)
        f->items[f->n] = (struct item){bound, (uint32_t)index, instance};
    f->n++;
}

static void find_facets(struct finder *f)
{
    const struct orl_geometry *const g = f->lit_scene->geometry;
    struct orl_facet own;
    for (size_t i = 0; i < g->n_facets; i++) {
        const struct orl_facet *facet = orl_facet_get_own(g, i, &own);
        if (facet->area > 0 && is_target(f, facet))
            add_item(f, about_facet(g, facet), i, false);
    }
}

static void find_places(struct finder *f)
{
    const struct orl_geometry *const g = f->lit_scene->geometry;
    for (size_t i = 0; i < g->n_instances; i++)
        if (f->prototypes[g->instance[i].number])
            add_item(f, about_box(g->instance[i].low, g->instance[i].high), i, true);
}

static void find_items(struct finder *f)
{
    f->n = 0;
    find_facets(f);
    find_places(f);
}

/* Finds out what materials and prototypes are targets. */
static void survey_scene(struct finder *f)
{
    const struct orl_geometry *const g = f->lit_scene->geometry;
    for (size_t i = 0; i < f->lit_scene->n_materials; i++)
        f->rules[i] = rule_of(&f->lit_scene->materials[i]);
    find_solids(f, g);
    for (size_t i = 0; i < g->n_prototypes; i++)
        find_solids(f, g->prototypes[i]);
    for (size_t i = 0; i < g->n_prototypes; i++) {
        const struct orl_geometry *const prototype = g->prototypes[i];
        struct orl_facet own;
        for (size_t k = 0; k < prototype->n_facets && !f->prototypes[i]; k++)
            f->prototypes[i] = is_target(f, orl_facet_get_own(prototype, k, &own));
    }
}

static bool has_specular(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (orl_material_deviates(&lit_scene->materials[i]) ||
            orl_material_is_mirror(&lit_scene->materials[i]))
            return true;
    return false;
}

/* Allocates the items, whose number is known, and the targets' tables. */
static bool allocate_tables(struct finder *f)
{
    const struct orl_geometry *const g = f->lit_scene->geometry;
    struct orl_targets *const t = f->targets;
    f->items = malloc(f->n * sizeof *f->items);
    t->of_facet = malloc(g->n_facets + 1);
    t->of_instance = malloc(g->n_instances + 1);
    if (!f->items || !t->of_facet || !t->of_instance)
        return false;
    memset(t->of_facet, ORL_NO_TARGET, g->n_facets + 1);
    memset(t->of_instance, ORL_NO_TARGET, g->n_instances + 1);
    return true;
}

static int find_targets(struct finder *f)
{
    const size_t materials = f->lit_scene->n_materials + 1;
    f->faces = calloc(materials, sizeof *f->faces);
    f->rules = calloc(materials, sizeof *f->rules);
    f->prototypes = calloc(f->lit_scene->geometry->n_prototypes + 1, sizeof *f->prototypes);
    if (!f->faces || !f->rules || !f->prototypes)
        return ORL_ERR_NOMEM;
    survey_scene(f);
    find_items(f); /* counts them */
    if (f->n == 0)
        return 0;
    if (!allocate_tables(f))
        return ORL_ERR_NOMEM;
    find_items(f);
    add_groups(f, f->items, f->n, ORL_MOST_TARGETS);
    return 0;
}

int orl_targets_init(struct orl_targets *targets, const struct orl_lit_scene *lit_scene)
{
    struct finder f = {.lit_scene = lit_scene, .targets = targets};
    memset(targets, 0, sizeof *targets);
    const int code = has_specular(lit_scene) ? find_targets(&f) : 0;
    free(f.items);
    free(f.faces);
    free(f.rules);
    free(f.prototypes);
    if (targets->n == 0)
        orl_targets_done(targets);
    return code;
}

void orl_targets_done(struct orl_targets *targets)
{
    free(targets->of_facet);
    free(targets->of_instance);
    memset(targets, 0, sizeof *targets);
}

uint32_t orl_targets_of(const struct orl_targets *targets, const struct orl_geometry *geometry,
                        uint32_t facet)
{
    if (targets->n == 0)
        return ORL_NO_TARGET;
    return orl_facet_is_instanced(geometry, facet)
               ? targets->of_instance[orl_instance_of(geometry, facet) - geometry->instance]
               : targets->of_facet[facet];
}

/* ---- Directions ------------------------------------------------------------------------------ */

/* The cone that a target fills: 1 minus the cosine of its half angle; 2 from within the sphere. */
static double opening_of(const struct orl_target_sphere *target, struct orl_vec3 way)
{
    const double d2 = orl_dot(way, way), sine2 = target->radius * target->radius / d2;
    return sine2 < 1 ? sine2 / (1 + sqrt(1 - sine2)) : 2;
}

struct orl_vec3 orl_target_sample(const struct orl_target_sphere *target, struct orl_vec3 point,
                                  const double u[2])
{
    const struct orl_vec3 way = orl_sub(target->center, point);
    const double down = u[0] * opening_of(target, way), phi = 2 * ORL_PI * u[1];
    const double sine = sqrt(fmax(0, down * (2 - down))), d = orl_length(way);
    const struct orl_frame frame = orl_frame_about(d > 0 ? orl_scale(way, 1 / d) : orl_v3(0, 0, 1));
    return orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), 1 - down));
}

double orl_target_pdf(const struct orl_target_sphere *target, struct orl_vec3 point,
                      struct orl_vec3 direction)
{
    const struct orl_vec3 way = orl_sub(target->center, point);
    const double opening = opening_of(target, way), d2 = orl_dot(way, way);
    /* The test uses the distance at which the ray passes the centre, which is exact for narrow
     * cones. */
    const double ahead = orl_dot(way, direction), past2 = d2 - ahead * ahead;
    if (opening < 1 && !(ahead > 0 && past2 <= target->radius * target->radius * (1 + 1e-9)))
        return 0;
    return 1 / (2 * ORL_PI * opening);
}

#include "scene/geometry/antimatter/linings.h"

#include "scene/geometry/antimatter/antimatter.h"
#include "scene/geometry/hit_refinement.h"

/* ---- Windows that face a lining
 * --------------------------------------------------------------- */

enum { WINDOW_PLACES = 16 };

/* Blocked share of the window area that counts: more than the narrow sides of thick panes, which
 * face the wall beside them. */
static const double much_blocked = 0.05;

/* Window area within a volume, and the part that faces its lining on exactly one side. */
struct windows {
    double area, blocked;
};

/* The view straight ahead from a place beside a window. */
struct outlook {
    bool inside; /* the place is inside the volume */
    bool matter; /* there is matter at the volume's end, or at the place itself */
};

static struct outlook look_ahead(const struct orl_geometry *g, const struct orl_hole *hole,
                                 struct orl_vec3 from, struct orl_vec3 direction)
{
    struct outlook outlook = {.inside = orl_hole_is_inside(hole, from)};
    struct orl_hit hit;
    if (outlook.inside)
        outlook.matter = orl_intersect_uncut(hole->shell, from, direction, INFINITY, &hit) &&
                         !hit.front && orl_hole_is_lining(g, hole, &hit);
    else
        outlook.matter =
            orl_intersect_uncut(hole->matter, from, direction, INFINITY, &hit) && !hit.front;
    return outlook;
}

static void add_window(const struct orl_geometry *g, const struct orl_hole *hole, uint32_t window,
                       struct windows *windows)
{
    const double area = orl_facet_area(g, window);
    int inside = 0, blocked = 0;
    for (int i = 0; i < WINDOW_PLACES; i++) {
        /* Roberts' sequence in two dimensions. */
        const double u[2] = {fmod(0.5 + 0.7548776662466927 * i, 1),
                             fmod(0.5 + 0.5698402909980532 * i, 1)};
        struct orl_vec3 point, normal;
        struct outlook sides[2];
        orl_facet_sample(g, window, u, &point, &normal);
        for (int k = 0; k < 2; k++) {
            const struct orl_vec3 direction = k ? orl_neg(normal) : normal;
            sides[k] = look_ahead(
                g, hole, orl_facet_ray_origin(g, window, point, normal, direction), direction);
        }
        inside += sides[0].inside || sides[1].inside;
        blocked += sides[0].matter != sides[1].matter && sides[sides[0].matter ? 0 : 1].inside;
    }
    windows->area += area * inside / WINDOW_PLACES;
    if (2 * blocked >= inside) /* otherwise it lies in a floor, for example */
        windows->blocked += area * blocked / WINDOW_PLACES;
}

static void omit_lining(struct orl_geometry *g, size_t antimatter)
{
    struct orl_hole *const hole = &g->holes->items[antimatter];
    hole->has_lining = false;
    hole->lining_omitted = true;
    for (size_t i = 0; i < g->n_facets; i++)
        if (g->holes->of_facet[i] == (int32_t)antimatter)
            orl_facet_set_material(g, i, hole->material);
}

void orl_linings_resolve(struct orl_geometry *geometry, const bool *is_window)
{
    const size_t n = orl_linings_count(geometry);
    for (size_t k = 0; k < n; k++) {
        const struct orl_hole *const hole = &geometry->holes->items[k];
        struct windows windows = {0};
        for (uint32_t i = 0; i < geometry->n_facets && hole->has_lining; i++) {
            struct orl_facet own;
            const struct orl_facet *const f = orl_facet_get_own(geometry, i, &own);
            if (f->kind == ORL_SURFACE_POLYGON && f->area > 0 && is_window[f->material] &&
                geometry->holes->of_facet[i] < 0)
                add_window(geometry, hole, i, &windows);
        }
        if (windows.blocked > much_blocked * windows.area)
            omit_lining(geometry, k);
    }
}

/* ---- Queries
 * ---------------------------------------------------------------------------------- */

size_t orl_linings_count(const struct orl_geometry *geometry)
{
    return geometry->holes ? geometry->holes->n : 0;
}

void orl_lining_of(const struct orl_geometry *geometry, size_t antimatter, uint32_t *ret_material,
                   uint32_t *ret_facet)
{
    uint32_t facet = 0;
    while (geometry->holes->of_facet[facet] != (int32_t)antimatter)
        facet++;
    *ret_material = geometry->holes->items[antimatter].material;
    *ret_facet = facet;
}

bool orl_lining_is_omitted(const struct orl_geometry *geometry, size_t antimatter)
{
    return geometry->holes->items[antimatter].lining_omitted;
}

bool orl_lining_matter_contains(const struct orl_geometry *geometry, size_t antimatter,
                                struct orl_vec3 place)
{
    /* Up to a third of the directions may show no back: objects standing in a room face into it. */
    enum { DIRECTIONS = 48, MOST_OTHERS = DIRECTIONS / 3 };
    const struct orl_hole *const hole = &geometry->holes->items[antimatter];
    int others = 0;
    for (int i = 0; i < DIRECTIONS && hole->has_lining; i++) {
        /* A spherical spiral by the golden angle, alternating between up and down. */
        const double z = (i % 2 ? -1 : 1) * (1 - (i + 0.5) / DIRECTIONS), s = sqrt(1 - z * z);
        const double phi = 2.399963229728653 * i;
        struct orl_hit hit;
        others += !orl_intersect_uncut(hole->matter, place, orl_v3(s * cos(phi), s * sin(phi), z),
                                       INFINITY, &hit) ||
                  hit.front;
        if (others > MOST_OTHERS)
            return false;
    }
    return hole->has_lining;
}

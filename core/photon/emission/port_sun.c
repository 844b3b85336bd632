#include "photon/emission/port_emission.h"

#include <stdlib.h>

#include "scene/geometry/instances.h"
#include "scene/geometry/intersect.h"

enum { MOST_SUN_BSDF_TABLES = 16 }; /* each takes some megabytes for fine data */
/* Limit of facets times strata, beyond which the search for shadow boxes would take longer than it
 * may save. */
static const double most_tests = 2e7;
/* Share of the scene's size: objects nearer than this count as occluders, because rays have
 * float coordinates. */
static const double margin = 1e-6;

/* ---- Shadow boxes ---------------------------------------------------------------------------- */

/* Projection onto the plane of a port, along the rays of a sun. */
struct shadow_projection {
    const struct orl_geometry *geometry;
    /* slide: movement along the sun's rays for one unit of height */
    struct orl_vec3 outward, slide;
    double plane;  /* distance from the origin, along outward */
    double spread; /* maximum width of a shadow's edge for one unit of height */
    double room;
    struct orl_shadow_boxes *shadow_boxes;
};

static struct orl_shadow_box empty_shadow_box(void)
{
    return (struct orl_shadow_box){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
}

/* Adds the projection of a point. */
static void cast_point(const struct shadow_projection *c, struct orl_vec3 point,
                       struct orl_shadow_box *shadow_box)
{
    const double height = orl_dot(point, c->outward) - c->plane;
    const struct orl_vec3 at = orl_madd(point, c->slide, -height);
    const double pad = fabs(height) * c->spread + c->room;
    for (int k = 0; k < 2; k++) {
        const double x = orl_dot(at, c->shadow_boxes->axis[k]);
        shadow_box->low[k] = fmin(shadow_box->low[k], x - pad);
        shadow_box->high[k] = fmax(shadow_box->high[k], x + pad);
    }
}

/* Adds the part of a triangle before the plane: its corners there, and the points where its
 * edges cross the plane. */
static void cast_triangle(const struct shadow_projection *c, struct orl_triangle t,
                          struct orl_shadow_box *shadow_box)
{
    const struct orl_vec3 corner[3] = {t.a, t.b, t.c};
    for (int k = 0; k < 3; k++) {
        const struct orl_vec3 p = corner[k], q = corner[(k + 1) % 3];
        const double from = orl_dot(p, c->outward) - c->plane;
        const double to = orl_dot(q, c->outward) - c->plane;
        if (from >= 0)
            cast_point(c, p, shadow_box);
        if (from * to < 0)
            cast_point(c, orl_madd(p, orl_sub(q, p), from / (from - to)), shadow_box);
    }
}

/* Adds a box. Its corners are enough: the box is convex, so the part before the plane is within
 * their bounds. */
static void cast_box(const struct shadow_projection *c, struct orl_vec3 low, struct orl_vec3 high,
                     struct orl_shadow_box *shadow_box)
{
    for (int k = 0; k < 8; k++)
        cast_point(c,
                   orl_v3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z),
                   shadow_box);
}

/* Adds the bounding box of a curved facet. */
static void cast_curved(const struct shadow_projection *c, const struct orl_facet *facet,
                        struct orl_shadow_box *shadow_box)
{
    struct orl_vec3 low, high;
    orl_quadric_bounds(facet, &low, &high);
    cast_box(c, low, high, shadow_box);
}

/* Returns how far a facet extends beyond the plane. */
static double reach_beyond_plane(const struct shadow_projection *c, const struct orl_facet *facet)
{
    const struct orl_vec3 o = c->outward;
    double most = -INFINITY;
    struct orl_vec3 low, high;
    if (facet->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_bounds(facet, &low, &high);
        return fmax(low.x * o.x, high.x * o.x) + fmax(low.y * o.y, high.y * o.y) +
               fmax(low.z * o.z, high.z * o.z) - c->plane;
    }
    for (uint32_t i = 0; i < facet->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(c->geometry, orl_facet_triangle(facet, i));
        most = fmax(most, fmax(orl_dot(t.a, o), fmax(orl_dot(t.b, o), orl_dot(t.c, o))));
    }
    return most - c->plane;
}

static struct orl_shadow_box shadow_box_of(const struct shadow_projection *c,
                                           const struct orl_facet *facet)
{
    struct orl_shadow_box shadow_box = empty_shadow_box();
    if (facet->kind != ORL_SURFACE_POLYGON)
        cast_curved(c, facet, &shadow_box);
    for (uint32_t i = 0; i < facet->n_triangles; i++)
        if (facet->kind == ORL_SURFACE_POLYGON)
            cast_triangle(c, orl_triangle_get(c->geometry, orl_facet_triangle(facet, i)),
                          &shadow_box);
    return shadow_box;
}

/* Returns the bounds of the pane itself, projected along its normal. */
static struct orl_shadow_box pane_of(const struct shadow_projection *c,
                                     const struct orl_facet *facet)
{
    struct orl_shadow_box pane = empty_shadow_box();
    struct shadow_projection still = *c;
    still.slide = still.outward;
    still.spread = 0;
    for (uint32_t i = 0; i < facet->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(c->geometry, orl_facet_triangle(facet, i));
        cast_point(&still, t.a, &pane);
        cast_point(&still, t.b, &pane);
        cast_point(&still, t.c, &pane);
    }
    return pane;
}

/* Returns false if there are too many. */
static bool add_shadow_box(struct orl_shadow_boxes *shadow_boxes,
                           const struct orl_shadow_box *shadow_box,
                           const struct orl_shadow_box *pane)
{
    for (int i = 0; i < 2; i++)
        if (!(shadow_box->low[i] <= pane->high[i] && pane->low[i] <= shadow_box->high[i]))
            return true;
    if (shadow_boxes->count == ORL_MOST_SHADOW_BOXES)
        return false;
    shadow_boxes->box[shadow_boxes->count++] = *shadow_box;
    return true;
}

/* Adds instances, by their bounding boxes. */
static bool cast_placed(const struct shadow_projection *c, const struct orl_shadow_box *pane,
                        struct orl_shadow_boxes *shadow_boxes)
{
    const struct orl_geometry *const g = c->geometry;
    const struct orl_vec3 o = c->outward;
    for (size_t i = 0; i < g->n_instances; i++) {
        const struct orl_vec3 low = g->instance[i].low, high = g->instance[i].high;
        const double most = fmax(low.x * o.x, high.x * o.x) + fmax(low.y * o.y, high.y * o.y) +
                            fmax(low.z * o.z, high.z * o.z) - c->plane;
        struct orl_shadow_box shadow_box = empty_shadow_box();
        if (most <= 0.1 * c->room)
            continue;
        cast_box(c, low, high, &shadow_box);
        if (!add_shadow_box(shadow_boxes, &shadow_box, pane))
            return false;
    }
    return true;
}

/* Lists the boxes on the pane. Returns false if there are too many, rays are nearly parallel to the
 * pane, or the pool is cancelled. */
static bool cast_shadow_boxes(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                              const struct orl_sun *sun, const struct orl_thread_pool *pool,
                              struct orl_shadow_boxes *shadow_boxes)
{
    const struct orl_geometry *g = lit_scene->geometry;
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(g, port->facet, &own);
    const struct orl_frame frame = orl_frame_about(port->outward);
    const double cosine = orl_dot(port->outward, sun->frame.n), cos_half = sun->cos_half_angle;
    const double sin_half = sqrt(fmax(0, 1 - cos_half * cos_half));
    /* Cosine for the ray of the disc that is most nearly parallel to the pane. */
    const double least = cosine * cos_half - sin_half * sqrt(fmax(0, 1 - cosine * cosine));
    *shadow_boxes = (struct orl_shadow_boxes){.axis = {frame.u, frame.v}};
    if (facet->kind != ORL_SURFACE_POLYGON || !(least > 0.01) || !(cos_half > 0.9))
        return false;
    /* Rays of unit height differ by at most their angle over the square of the cosine. */
    struct shadow_projection c = {.geometry = g,
                                  .outward = port->outward,
                                  .slide = orl_scale(sun->frame.n, 1 / cosine),
                                  .spread = 2 * (sin_half / cos_half) / (least * least),
                                  .room = margin * g->radius,
                                  .shadow_boxes = shadow_boxes};
    c.plane = reach_beyond_plane(&c, facet);
    const struct orl_shadow_box pane = pane_of(&c, facet);
    for (uint32_t i = 0; i < g->n_facets; i++) {
        if (i % 4096 == 0 && orl_thread_pool_cancelled(pool))
            return false;
        struct orl_facet room;
        const struct orl_facet *const f = orl_facet_get_own(g, i, &room);
        if (!(f->area > 0) || i == port->facet || reach_beyond_plane(&c, f) <= 0.1 * c.room)
            continue;
        const struct orl_shadow_box shadow_box = shadow_box_of(&c, f);
        if (!add_shadow_box(shadow_boxes, &shadow_box, &pane))
            return false;
    }
    return cast_placed(&c, &pane, shadow_boxes);
}

static int find_shadow_boxes(struct orl_emission *e, struct orl_stratum *s,
                             const struct orl_thread_pool *pool)
{
    struct orl_shadow_boxes *shadow_boxes = calloc(1, sizeof *shadow_boxes);
    if (!shadow_boxes)
        return ORL_ERR_NOMEM;
    if (e->lit_scene->ports[s->port].clear ||
        cast_shadow_boxes(e->lit_scene, &e->lit_scene->ports[s->port], &e->lit_scene->suns[s->sun],
                          pool, shadow_boxes))
        s->shadow_boxes = shadow_boxes;
    else
        free(shadow_boxes);
    return orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : 0;
}

/* ---- Sun BSDF tables ------------------------------------------------------------------------- */

/* Finds or makes the sun BSDF table of a port; ports of one wall share it. */
static int find_sun_bsdf_table(struct orl_emission *e, const struct orl_material *material,
                               struct orl_vec3 normal, const struct orl_sun *sun,
                               const struct orl_sun_bsdf_table **ret_table)
{
    const double half = acos(fmin(sun->cos_half_angle, 1));
    for (size_t i = 0; i < e->n_sun_bsdf_tables; i++) {
        if (orl_sun_bsdf_table_matches(e->sun_bsdf_tables[i], material, normal, sun->frame.n)) {
            *ret_table = e->sun_bsdf_tables[i];
            return 0;
        }
    }
    if (e->n_sun_bsdf_tables == MOST_SUN_BSDF_TABLES)
        return 0;
    const int code = orl_sun_bsdf_table_new(material, normal, sun->frame.n, half,
                                            &e->sun_bsdf_tables[e->n_sun_bsdf_tables]);
    if (code == 0 && e->sun_bsdf_tables[e->n_sun_bsdf_tables])
        *ret_table = e->sun_bsdf_tables[e->n_sun_bsdf_tables++];
    return code;
}

void orl_sun_bsdf_tables_free(struct orl_emission *emission)
{
    for (size_t i = 0; i < emission->n_sun_bsdf_tables; i++)
        orl_sun_bsdf_table_free(emission->sun_bsdf_tables[i]);
    free(emission->sun_bsdf_tables);
    emission->sun_bsdf_tables = NULL;
    emission->n_sun_bsdf_tables = 0;
    for (size_t i = 0; i < emission->n_strata; i++)
        emission->strata[i].sun_bsdf_table = NULL;
}

int orl_sun_bsdf_tables_make(struct orl_emission *emission)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    int code = 0;
    emission->sun_bsdf_tables = calloc(MOST_SUN_BSDF_TABLES, sizeof(struct orl_sun_bsdf_table *));
    if (!emission->sun_bsdf_tables)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < emission->n_strata && code == 0; i++) {
        struct orl_stratum *s = &emission->strata[i];
        struct orl_facet own;
        if (s->kind != ORL_STRATUM_PORT_SUN)
            continue;
        const struct orl_facet *facet =
            orl_facet_get_own(lit_scene->geometry, lit_scene->ports[s->port].facet, &own);
        code = find_sun_bsdf_table(emission, &lit_scene->materials[facet->material], facet->normal,
                                   &lit_scene->suns[s->sun], &s->sun_bsdf_table);
    }
    return code;
}

void orl_port_sun_done(struct orl_emission *emission)
{
    orl_sun_bsdf_tables_free(emission);
    for (size_t i = 0; i < emission->n_strata; i++)
        free(emission->strata[i].shadow_boxes);
}

int orl_port_sun_prepare(struct orl_emission *emission, const struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    const double facets =
        (double)(lit_scene->geometry->n_facets + lit_scene->geometry->n_instances);
    const bool look = facets * (double)emission->n_strata <= most_tests;
    int code = 0;
    for (size_t i = 0; i < emission->n_strata && code == 0; i++) {
        struct orl_stratum *s = &emission->strata[i];
        if (s->kind == ORL_STRATUM_PORT_SUN && (look || lit_scene->ports[s->port].clear))
            code = find_shadow_boxes(emission, s, pool);
    }
    return code < 0 ? code : orl_sun_bsdf_tables_make(emission);
}

#include "photon/flight/port_sun.h"

#include <stdlib.h>

#include "scene/geometry/placed.h"
#include "scene/geometry/quadric.h"

enum { MOST_PASSAGES = 16 }; /* each takes some megabytes for fine data */
/* Limit of facets times strata, beyond which the search for shades would take longer than it may
 * save. */
static const double most_looks = 2e7;
/* Share of the scene's size: objects nearer than this count as occluders, because rays have
 * float coordinates. */
static const double margin = 1e-6;

/* ---- Shades ---------------------------------------------------------------------------------- */

/* Projection onto the plane of a port, along the rays of a sun. */
struct casting {
    const struct orl_geometry *geometry;
    /* slide: movement along the sun's rays for one unit of height */
    struct orl_vec3 outward, slide;
    double plane;  /* distance from the origin, along outward */
    double spread; /* maximum width of a shadow's edge for one unit of height */
    double room;
    struct orl_shades *shades;
};

static struct orl_shade empty_shade(void)
{
    return (struct orl_shade){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
}

/* Adds the projection of a point. */
static void cast_point(const struct casting *c, struct orl_vec3 point, struct orl_shade *shade)
{
    const double height = orl_dot(point, c->outward) - c->plane;
    const struct orl_vec3 at = orl_madd(point, c->slide, -height);
    const double pad = fabs(height) * c->spread + c->room;
    for (int k = 0; k < 2; k++) {
        const double x = orl_dot(at, c->shades->axis[k]);
        shade->low[k] = fmin(shade->low[k], x - pad);
        shade->high[k] = fmax(shade->high[k], x + pad);
    }
}

/* Adds the part of a triangle before the plane: its corners there, and the points where its
 * edges cross the plane. */
static void cast_triangle(const struct casting *c, struct orl_triangle t, struct orl_shade *shade)
{
    const struct orl_vec3 corner[3] = {t.a, t.b, t.c};
    for (int k = 0; k < 3; k++) {
        const struct orl_vec3 p = corner[k], q = corner[(k + 1) % 3];
        const double from = orl_dot(p, c->outward) - c->plane;
        const double to = orl_dot(q, c->outward) - c->plane;
        if (from >= 0)
            cast_point(c, p, shade);
        if (from * to < 0)
            cast_point(c, orl_madd(p, orl_sub(q, p), from / (from - to)), shade);
    }
}

/* Adds a box. Its corners are enough: the box is convex, so the part before the plane is within
 * their bounds. */
static void cast_box(const struct casting *c, struct orl_vec3 low, struct orl_vec3 high,
                     struct orl_shade *shade)
{
    for (int k = 0; k < 8; k++)
        cast_point(c,
                   orl_v3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z),
                   shade);
}

/* Adds the bounding box of a curved facet. */
static void cast_curved(const struct casting *c, const struct orl_facet *facet,
                        struct orl_shade *shade)
{
    struct orl_vec3 low, high;
    orl_quadric_bounds(facet, &low, &high);
    cast_box(c, low, high, shade);
}

/* Returns how far a facet extends beyond the plane. */
static double reach_beyond_plane(const struct casting *c, const struct orl_facet *facet)
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
        const struct orl_triangle t = orl_triangle_of(c->geometry, orl_facet_triangle(facet, i));
        most = fmax(most, fmax(orl_dot(t.a, o), fmax(orl_dot(t.b, o), orl_dot(t.c, o))));
    }
    return most - c->plane;
}

static struct orl_shade shade_of(const struct casting *c, const struct orl_facet *facet)
{
    struct orl_shade shade = empty_shade();
    if (facet->kind != ORL_SURFACE_POLYGON)
        cast_curved(c, facet, &shade);
    for (uint32_t i = 0; i < facet->n_triangles; i++)
        if (facet->kind == ORL_SURFACE_POLYGON)
            cast_triangle(c, orl_triangle_of(c->geometry, orl_facet_triangle(facet, i)), &shade);
    return shade;
}

/* Returns the bounds of the pane itself, projected along its normal. */
static struct orl_shade pane_of(const struct casting *c, const struct orl_facet *facet)
{
    struct orl_shade pane = empty_shade();
    struct casting still = *c;
    still.slide = still.outward;
    still.spread = 0;
    for (uint32_t i = 0; i < facet->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_of(c->geometry, orl_facet_triangle(facet, i));
        cast_point(&still, t.a, &pane);
        cast_point(&still, t.b, &pane);
        cast_point(&still, t.c, &pane);
    }
    return pane;
}

static bool shades_overlap(const struct orl_shade *a, const struct orl_shade *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1];
}

/* Returns false if there are too many. */
static bool add_shade(struct orl_shades *shades, const struct orl_shade *shade,
                      const struct orl_shade *pane)
{
    if (!shades_overlap(shade, pane))
        return true;
    if (shades->count == ORL_MOST_SHADES)
        return false;
    shades->box[shades->count++] = *shade;
    return true;
}

/* Adds instances, by their bounding boxes. */
static bool cast_placed(const struct casting *c, const struct orl_shade *pane,
                        struct orl_shades *shades)
{
    const struct orl_geometry *const g = c->geometry;
    const struct orl_vec3 o = c->outward;
    for (size_t i = 0; i < g->n_placed; i++) {
        const struct orl_vec3 low = g->placed[i].low, high = g->placed[i].high;
        const double most = fmax(low.x * o.x, high.x * o.x) + fmax(low.y * o.y, high.y * o.y) +
                            fmax(low.z * o.z, high.z * o.z) - c->plane;
        struct orl_shade shade = empty_shade();
        if (most <= 0.1 * c->room)
            continue;
        cast_box(c, low, high, &shade);
        if (!add_shade(shades, &shade, pane))
            return false;
    }
    return true;
}

/* Lists the boxes on the pane. Returns false if there are too many, rays are nearly parallel to
 * the pane, or the crew is cancelled. */
static bool cast_shades(const struct orl_world *world, const struct orl_port *port,
                        const struct orl_sun *sun, const struct orl_crew *crew,
                        struct orl_shades *shades)
{
    const struct orl_geometry *g = world->geometry;
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_own(g, port->facet, &own);
    const struct orl_frame frame = orl_frame_about(port->outward);
    const double cosine = orl_dot(port->outward, sun->frame.n), cos_half = sun->cos_half_angle;
    const double sin_half = sqrt(fmax(0, 1 - cos_half * cos_half));
    /* Cosine for the ray of the disc that is most nearly parallel to the pane. */
    const double least = cosine * cos_half - sin_half * sqrt(fmax(0, 1 - cosine * cosine));
    *shades = (struct orl_shades){.axis = {frame.u, frame.v}};
    if (facet->kind != ORL_SURFACE_POLYGON || !(least > 0.01) || !(cos_half > 0.9))
        return false;
    /* Rays of unit height differ by at most their angle over the square of the cosine. */
    struct casting c = {.geometry = g,
                        .outward = port->outward,
                        .slide = orl_scale(sun->frame.n, 1 / cosine),
                        .spread = 2 * (sin_half / cos_half) / (least * least),
                        .room = margin * g->radius,
                        .shades = shades};
    c.plane = reach_beyond_plane(&c, facet);
    const struct orl_shade pane = pane_of(&c, facet);
    for (uint32_t i = 0; i < g->n_facets; i++) {
        if (i % 4096 == 0 && orl_crew_cancelled(crew))
            return false;
        struct orl_facet room;
        const struct orl_facet *const f = orl_facet_own(g, i, &room);
        if (!(f->area > 0) || i == port->facet || reach_beyond_plane(&c, f) <= 0.1 * c.room)
            continue;
        const struct orl_shade shade = shade_of(&c, f);
        if (!add_shade(shades, &shade, &pane))
            return false;
    }
    return cast_placed(&c, &pane, shades);
}

static int find_shades(struct orl_emission *e, struct orl_stratum *s, const struct orl_crew *crew)
{
    struct orl_shades *shades = calloc(1, sizeof *shades);
    if (!shades)
        return ORL_ERR_NOMEM;
    if (e->world->ports[s->port].clear ||
        cast_shades(e->world, &e->world->ports[s->port], &e->world->suns[s->sun], crew, shades))
        s->shades = shades;
    else
        free(shades);
    return orl_crew_cancelled(crew) ? ORL_ERR_CANCELLED : 0;
}

/* ---- Passages -------------------------------------------------------------------------------- */

/* Finds or makes the passage of a port; ports of one wall share it. */
static int find_passage(struct orl_emission *e, const struct orl_material *material,
                        struct orl_vec3 normal, const struct orl_sun *sun,
                        const struct orl_passage **ret_passage)
{
    const double half = acos(fmin(sun->cos_half_angle, 1));
    for (size_t i = 0; i < e->n_passages; i++) {
        if (orl_passage_serves(e->passages[i], material, normal, sun->frame.n)) {
            *ret_passage = e->passages[i];
            return 0;
        }
    }
    if (e->n_passages == MOST_PASSAGES)
        return 0;
    const int code =
        orl_passage_new(material, normal, sun->frame.n, half, &e->passages[e->n_passages]);
    if (code == 0 && e->passages[e->n_passages])
        *ret_passage = e->passages[e->n_passages++];
    return code;
}

void orl_port_sun_done(struct orl_emission *emission)
{
    for (size_t i = 0; i < emission->n_passages; i++)
        orl_passage_free(emission->passages[i]);
    free(emission->passages);
    for (size_t i = 0; emission->strata && i < emission->n_strata; i++)
        free(emission->strata[i].shades);
}

int orl_port_sun_prepare(struct orl_emission *emission, const struct orl_crew *crew)
{
    const struct orl_world *world = emission->world;
    emission->passages = calloc(MOST_PASSAGES, sizeof(struct orl_passage *));
    if (!emission->passages)
        return ORL_ERR_NOMEM;
    const double facets = (double)(world->geometry->n_facets + world->geometry->n_placed);
    const bool look = facets * (double)emission->n_strata <= most_looks;
    int code = 0;
    for (size_t i = 0; i < emission->n_strata && code == 0; i++) {
        struct orl_stratum *s = &emission->strata[i];
        if (s->kind != ORL_STRATUM_PORT_SUN)
            continue;
        struct orl_facet own;
        const struct orl_facet *facet =
            orl_facet_own(world->geometry, world->ports[s->port].facet, &own);
        if (look || world->ports[s->port].clear)
            code = find_shades(emission, s, crew);
        if (code == 0)
            code = find_passage(emission, &world->materials[facet->material], facet->normal,
                                &world->suns[s->sun], &s->passage);
    }
    return code;
}

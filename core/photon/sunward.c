#include "photon/sunward.h"

#include <stdlib.h>

enum { MOST_PASSAGES = 16 }; /* some megabytes each, of fine data */
/* Facets times strata: beyond this a look would take longer than it may save. */
static const double most_looks = 2e7;
/* Of the scene's size: nearer than this counts as in the way. Rays are floats. */
static const double margin = 1e-6;

/* How far a flat facet reaches along an axis, from and to. */
struct extent {
    double low, high;
};

static struct extent extent_of(const struct orl_geometry *g, uint32_t facet, struct orl_vec3 axis)
{
    const struct orl_facet *f = &g->facets[facet];
    struct extent e = {INFINITY, -INFINITY};
    for (uint32_t i = f->first_triangle; i < f->first_triangle + f->n_triangles; i++) {
        const struct orl_triangle *t = &g->triangles[i];
        const double at[3] = {orl_dot(t->a, axis), orl_dot(t->b, axis), orl_dot(t->c, axis)};
        for (int k = 0; k < 3; k++) {
            e.low = fmin(e.low, at[k]);
            e.high = fmax(e.high, at[k]);
        }
    }
    return e;
}

/* Seen along the facet's normal: the port lies to one side and the sun's rays lead away there. */
static bool leads_away(const struct orl_geometry *g, uint32_t facet, const struct orl_port *port,
                       const struct orl_sun *sun)
{
    const struct orl_vec3 axis = g->facets[facet].normal;
    const struct extent mine = extent_of(g, facet, axis), ports = extent_of(g, port->facet, axis);
    const double slope = orl_dot(axis, sun->frame.n), room = margin * g->radius;
    const double half = sqrt(fmax(0, 1 - sun->cos_half_angle * sun->cos_half_angle));
    return (slope > half && ports.low > mine.high + room) ||
           (slope < -half && ports.high < mine.low - room);
}

static bool is_free(const struct orl_world *world, const struct orl_port *port,
                    const struct orl_sun *sun)
{
    const struct orl_geometry *g = world->geometry;
    if (g->facets[port->facet].kind != ORL_SURFACE_POLYGON)
        return false;
    const double plane = extent_of(g, port->facet, port->outward).high;
    for (uint32_t i = 0; i < g->n_facets; i++) {
        if (!(g->facets[i].area > 0))
            continue;
        if (g->facets[i].kind != ORL_SURFACE_POLYGON)
            return false;
        /* What does not reach beyond the pane's own plane is behind it. */
        if (extent_of(g, i, port->outward).high > plane + 0.1 * margin * g->radius &&
            !leads_away(g, i, port, sun))
            return false;
    }
    return true;
}

/* Ports of one wall have one passage. */
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

void orl_sunward_done(struct orl_emission *emission)
{
    for (size_t i = 0; i < emission->n_passages; i++)
        orl_passage_free(emission->passages[i]);
    free(emission->passages);
}

int orl_sunward_prepare(struct orl_emission *emission)
{
    const struct orl_world *world = emission->world;
    emission->passages = calloc(MOST_PASSAGES, sizeof(struct orl_passage *));
    if (!emission->passages)
        return ORL_ERR_NOMEM;
    const bool look = (double)world->geometry->n_facets * (double)emission->n_strata <= most_looks;
    for (size_t i = 0; i < emission->n_strata; i++) {
        struct orl_stratum *s = &emission->strata[i];
        if (s->kind != ORL_STRATUM_PORT_SUN)
            continue;
        const struct orl_port *port = &world->ports[s->port];
        const struct orl_sun *sun = &world->suns[s->sun];
        const struct orl_facet *facet = &world->geometry->facets[port->facet];
        s->unobstructed = port->clear || (look && is_free(world, port, sun));
        const int code = find_passage(emission, &world->description.materials[facet->material],
                                      facet->normal, sun, &s->passage);
        if (code < 0)
            return code;
    }
    return 0;
}

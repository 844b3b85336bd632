#include <stdlib.h>

#include "base/multiversion.h"
#include "photon/emission/emit_sampling.h"
#include "photon/emission/port_emission.h"
#include "scene/geometry/intersect.h"
#include "scene/material/scatter.h"

enum { N = ORL_STARTS_AT_ONCE };

/* Data of several starts, in columns. */
struct columns {
    double place[N][2], direction_u[N][2], pdf[N];
    struct orl_vec3 points[N], out[N];
};

/* Maps points of the square to directions in the outer hemisphere. */
ORL_FOR_WIDE_VECTORS
static void map_to_hemisphere(struct orl_vec3 outward, size_t n, struct columns *c)
{
    for (size_t i = 0; i < n; i++)
        c->out[i] = orl_hemisphere_about(outward, c->direction_u[i][0], c->direction_u[i][1]);
}

static void sample_dome(const struct orl_emission *e, const struct orl_stratum *stratum, size_t n,
                        struct columns *c)
{
    double at[N][2];
    orl_distribution_2d_sample_many(&e->port_distributions[stratum->port],
                                    (const double(*)[2])c->direction_u, n, at, c->pdf);
    for (size_t i = 0; i < n; i++) {
        c->direction_u[i][0] = at[i][0];
        c->direction_u[i][1] = at[i][1];
    }
    map_to_hemisphere(e->lit_scene->ports[stratum->port].outward, n, c);
}

static void sample_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                       bool caustic, size_t n, struct columns *c)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    if (stratum->kind == ORL_STRATUM_PORT_IMAGE)
        for (size_t i = 0; i < n; i++)
            c->out[i] = orl_virtual_sun_sample(lit_scene, &lit_scene->images.nodes[stratum->image],
                                               c->direction_u[i]);
    else
        orl_sun_sample_many(&lit_scene->suns[stratum->sun], (const double(*)[2])c->direction_u, n,
                            c->out);
    if (!caustic || !stratum->place.weight)
        return;
    double place[N][2];
    orl_distribution_2d_sample_many(&stratum->place, (const double(*)[2])c->place, n, place,
                                    c->pdf);
    for (size_t i = 0; i < n; i++) {
        c->place[i][0] = place[i][0];
        c->place[i][1] = place[i][1];
    }
}

void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    struct columns c;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 2; k++) {
            c.place[i][k] = u[i][1 + k];
            c.direction_u[i][k] = u[i][3 + k];
        }
        c.pdf[i] = 1;
    }
    if (stratum->kind == ORL_STRATUM_PORT_DOME)
        sample_dome(emission, stratum, n, &c);
    else if (stratum->kind == ORL_STRATUM_PORT_LAMP)
        for (size_t i = 0; i < n; i++)
            /* the direction depends on the point; orl_port_lamp_arriving samples it */
            c.out[i] = lit_scene->ports[stratum->port].outward;
    else
        sample_sun(emission, stratum, caustic, n, &c);
    orl_facet_sample_many(lit_scene->geometry, lit_scene->ports[stratum->port].facet,
                          (const double(*)[2])c.place, n, c.points);
    for (size_t i = 0; i < n; i++)
        ret_starts[i] = (struct orl_port_start){c.points[i], c.out[i], c.pdf[i]};
}

enum { POINTS_OF_LAMP = 8 };

/* ---- Lamps that ports may see ---------------------------------------------------------------- */

/* Computes the bounding box of a facet. */
static void find_facet_box(const struct orl_geometry *g, uint32_t facet, struct orl_vec3 *ret_low,
                           struct orl_vec3 *ret_high)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    if (f->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_bounds(f, ret_low, ret_high);
        return;
    }
    *ret_low = orl_v3(INFINITY, INFINITY, INFINITY);
    *ret_high = orl_neg(*ret_low);
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; k++) {
            const struct orl_vec3 c = corners[k];
            *ret_low = orl_v3(fmin(ret_low->x, c.x), fmin(ret_low->y, c.y), fmin(ret_low->z, c.z));
            *ret_high =
                orl_v3(fmax(ret_high->x, c.x), fmax(ret_high->y, c.y), fmax(ret_high->z, c.z));
        }
    }
}

/* Returns true if a port may see the emitter: part of its bounding box is before the port's
 * plane. */
static bool is_before_a_port(const struct orl_lit_scene *lit_scene,
                             const struct orl_emitter *emitter)
{
    static const double half[2] = {0.5, 0.5};
    struct orl_vec3 low, high;
    find_facet_box(lit_scene->geometry, emitter->facet, &low, &high);
    for (size_t p = 0; p < lit_scene->n_ports; p++) {
        const struct orl_vec3 o = lit_scene->ports[p].outward;
        struct orl_vec3 on_port, normal;
        orl_facet_sample(lit_scene->geometry, lit_scene->ports[p].facet, half, &on_port, &normal);
        if (fmax(low.x * o.x, high.x * o.x) + fmax(low.y * o.y, high.y * o.y) +
                fmax(low.z * o.z, high.z * o.z) >
            orl_dot(on_port, o))
            return true;
    }
    return false;
}

/* Returns true if one of a few points of the lamp is outside. */
static bool shines_outside(const struct orl_emission *e, size_t emitter)
{
    const struct orl_geometry *g = e->lit_scene->geometry;
    const uint32_t facet = e->lit_scene->emitters[emitter].facet;
    for (uint32_t i = 0; i < POINTS_OF_LAMP; i++) {
        double u[2];
        struct orl_vec3 point, normal;
        orl_sobol_point(&e->sobol, i, 1, 2, u);
        orl_facet_sample(g, facet, u, &point, &normal);
        if (orl_lit_scene_is_outside(e->lit_scene,
                                     orl_facet_ray_origin(g, facet, point, normal, normal)))
            return true;
    }
    return false;
}

int orl_port_lamps_find(struct orl_emission *emission, const struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    emission->lamps_outside = calloc(lit_scene->n_emitters + 1, sizeof *emission->lamps_outside);
    if (!emission->lamps_outside)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_emitters && lit_scene->n_ports > 0; i++) {
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        if (lit_scene->emitters[i].direct && is_before_a_port(lit_scene, &lit_scene->emitters[i]) &&
            (lit_scene->open || shines_outside(emission, i)))
            emission->lamps_outside[emission->n_lamps_outside++] = (uint32_t)i;
    }
    return 0;
}

size_t orl_port_lamp_count_strata(const struct orl_emission *emission)
{
    const size_t ports = emission->lit_scene->n_ports, lamps = emission->n_lamps_outside;
    if (lamps == 0)
        return 0;
    return ports * lamps <= ORL_MOST_PORT_LAMPS ? ports * lamps : ports;
}

static int compare_lamps(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

bool orl_port_lamp_is_outside(const struct orl_emission *emission, size_t emitter)
{
    const uint32_t wanted = (uint32_t)emitter; /* they are in ascending order */
    return bsearch(&wanted, emission->lamps_outside, emission->n_lamps_outside, sizeof wanted,
                   compare_lamps);
}

/* ---- Arriving light -------------------------------------------------------------------------- */

double orl_emitter_focus(const struct orl_lit_scene *lit_scene, uint32_t emitter)
{
    const uint32_t facet = lit_scene->emitters[emitter].facet;
    return orl_material_focus(
        &lit_scene->materials[orl_facet_material(lit_scene->geometry, facet)]);
}

/* Samples a point of the lamp from a point near the port. Returns false if the sampled point is
 * not before the port. */
static bool sample_lamp(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                        uint32_t lamp, struct orl_vec3 from, const double *u,
                        struct orl_light_sample *ret_sample)
{
    const double both[2] = {u[0], u[1]};
    return orl_light_sample(lit_scene, &lit_scene->emitters[lamp], from, both, ret_sample) &&
           orl_dot(ret_sample->light, port->outward) > 0;
}

static struct orl_vec3 before_port(const struct orl_lit_scene *lit_scene,
                                   const struct orl_port *port, struct orl_vec3 point)
{
    return orl_facet_ray_origin(lit_scene->geometry, port->facet, point,
                                orl_facet_normal(lit_scene->geometry, port->facet), port->outward);
}

struct orl_rgb orl_port_lamp_arriving(const struct orl_emission *emission,
                                      const struct orl_stratum *stratum, struct orl_vec3 point,
                                      const double *u, struct orl_random *random,
                                      uint32_t *ret_lamp, struct orl_light_sample *ret_sample)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    const struct orl_port *port = &lit_scene->ports[stratum->port];
    const size_t n = emission->n_lamps_outside;
    const bool any = stratum->lamp == ORL_ANY_LAMP;
    const uint32_t lamp =
        any ? emission->lamps_outside[(size_t)(orl_random_uniform(random) * (double)n)]
            : stratum->lamp;
    const struct orl_vec3 from = before_port(lit_scene, port, point);
    *ret_lamp = lamp;
    if (!sample_lamp(lit_scene, port, lamp, from, u, ret_sample))
        return orl_gray(0);
    return orl_rgb_scale(
        orl_light_sample_radiance(lit_scene, &lit_scene->emitters[lamp], from, ret_sample, false),
        any ? (double)n : 1);
}

double orl_port_lamp_unoccluded_flux(const struct orl_emission *emission,
                                     const struct orl_stratum *stratum, uint32_t choice,
                                     const double u[4])
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    const struct orl_port *port = &lit_scene->ports[stratum->port];
    const size_t n = emission->n_lamps_outside;
    const bool any = stratum->lamp == ORL_ANY_LAMP;
    const uint32_t lamp = any ? emission->lamps_outside[choice % n] : stratum->lamp;
    struct orl_vec3 point, normal;
    struct orl_light_sample light_sample;
    orl_facet_sample(lit_scene->geometry, port->facet, u, &point, &normal);
    if (!sample_lamp(lit_scene, port, lamp, before_port(lit_scene, port, point), u + 2,
                     &light_sample))
        return 0;
    return orl_luma(lit_scene->emitters[lamp].radiance) * light_sample.measure_sr *
           orl_dot(light_sample.light, port->outward) * port->area * (any ? (double)n : 1);
}

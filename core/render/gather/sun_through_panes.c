#include "render/gather/sun_through_panes.h"

#include "base/sampling/random.h"
#include "scene/material/hemisphere.h"
#include "scene/material/scatter.h"

enum { PANE_POINTS = 64 }; /* points per pane, sun and strategy */

/* A pane and a sun whose light it may send to the place. */
struct pane {
    const struct orl_pane_query *query;
    uint32_t facet;
    const struct orl_port *port; /* NULL: the pane is no port */
    const struct orl_sun *sun;
    const struct orl_window_lobe *window_lobe; /* NULL: only uniform points */
};

/* A point of a pane, relative to the place. */
struct seen {
    struct orl_hit hit;
    struct orl_vec3 eye; /* from the point to the place */
    double distance;
};

/* Returns the window lobe of a port for a sun, or NULL if there is none. */
static const struct orl_window_lobe *find_window_lobe(const struct orl_direction_sampler *sampler,
                                                      int32_t port, const struct orl_sun *sun)
{
    if (!sampler || sampler->n_window_lobes == 0 || port == ORL_NO_PORT)
        return NULL;
    for (uint32_t i = sampler->first_window_lobe[port]; i < sampler->first_window_lobe[port + 1];
         i++)
        if (sampler->sun_lobes[sampler->window_lobes[i].sun_lobe].sun == sun)
            return &sampler->window_lobes[i];
    return NULL;
}

static struct seen seen_of(const struct pane *pane, const struct orl_hit *hit)
{
    const struct orl_vec3 way = orl_sub(pane->query->place->point, hit->point);
    const double d = orl_length(way);
    return (struct seen){*hit, orl_scale(way, 1 / d), d};
}

static struct seen spread_point(const struct pane *pane, const double u[2])
{
    struct orl_hit hit = {.facet = pane->facet};
    orl_facet_sample(pane->query->lit_scene->geometry, pane->facet, u, &hit.point, &hit.normal);
    return seen_of(pane, &hit);
}

/* Draws a point along the sun lobe. Returns false if none of the sun lobe reaches the place from
 * the pane. Occlusion is tested later. */
static bool draw_point(const struct pane *pane, const double u[2], struct seen *ret_seen)
{
    const struct orl_direction_sampler *sampler = pane->query->sampler;
    const struct orl_geometry *g = pane->query->lit_scene->geometry;
    const struct orl_vec3 from = pane->query->place->point;
    const struct orl_vec3 center = pane->window_lobe->center,
                          normal = orl_facet_normal(g, pane->facet);
    struct orl_vec3 direction;
    struct orl_hit hit;
    if (!orl_window_lobe_sample(pane->window_lobe, &sampler->sun_lobes[pane->window_lobe->sun_lobe],
                                sampler->cells, from, u, &direction))
        return false;
    const double t = orl_dot(orl_sub(center, from), normal) / orl_dot(direction, normal);
    const double near = 1e-4 * t;
    if (!(t > 0) || !isfinite(t) ||
        !orl_geometry_intersect(g, orl_add(from, orl_scale(direction, t - near)), direction,
                                2 * near, &hit) ||
        hit.facet != pane->facet)
        return false;
    *ret_seen = seen_of(pane, &hit);
    return true;
}

/* Returns the density of points per steradian, summed over both strategies. */
static double pdf_of(const struct pane *pane, const struct seen *seen)
{
    const struct orl_direction_sampler *sampler = pane->query->sampler;
    const double leaves = fmax(fabs(orl_dot(seen->eye, seen->hit.normal)), 1e-9);
    const double area = orl_facet_area(pane->query->lit_scene->geometry, pane->facet);
    double density = seen->distance * seen->distance / (area * leaves);
    if (pane->window_lobe)
        density +=
            orl_window_lobe_pdf(pane->window_lobe, &sampler->sun_lobes[pane->window_lobe->sun_lobe],
                                sampler->cells, pane->query->place->point, orl_neg(seen->eye));
    return PANE_POINTS * density;
}

/* Returns the light from a point, divided by the density of points. */
static struct orl_rgb light_from(const struct pane *pane, const struct seen *seen,
                                 struct orl_vec3 light)
{
    const struct orl_lit_scene *lit_scene = pane->query->lit_scene;
    const struct orl_hit *hit = &seen->hit;
    const double arrives = -orl_dot(seen->eye, pane->query->place->normal);
    if (!(seen->distance > 0) || !(arrives > 0) ||
        (pane->port && !orl_port_owns(lit_scene->geometry, pane->port, hit->point)))
        return orl_gray(0);
    const struct orl_rgb f =
        orl_material_eval_lobes(orl_lit_scene_material(lit_scene, hit), hit, light, seen->eye);
    if (!(orl_rgb_max(f) > 0))
        return orl_gray(0);
    const struct orl_rgb from_sun = orl_transmittance(
        lit_scene, orl_hit_ray_origin(lit_scene->geometry, hit, light), light, INFINITY, true);
    const struct orl_rgb to_eye =
        orl_transmittance(lit_scene, orl_hit_ray_origin(lit_scene->geometry, hit, seen->eye),
                          seen->eye, seen->distance * (1 - 1e-6), true);
    const double measure = fabs(orl_dot(light, hit->normal)) * arrives / pdf_of(pane, seen);
    return orl_rgb_scale(
        orl_rgb_mul(orl_rgb_mul(f, from_sun), orl_rgb_mul(to_eye, pane->sun->irradiance)), measure);
}

static struct orl_rgb light_by_pane(const struct pane *pane)
{
    const struct orl_pane_query *query = pane->query;
    struct orl_rgb sum = orl_gray(0);
    for (int way = 0; way < (pane->window_lobe ? 2 : 1); way++)
        for (uint32_t i = 0; i < PANE_POINTS; i++) {
            double u[4];
            struct seen seen;
            orl_sobol_point(query->sobol, i,
                            (uint32_t)orl_mix64(orl_mix64(query->sequences[way]) + pane->facet), 4,
                            u);
            if (way == 0)
                seen = spread_point(pane, u);
            else if (!draw_point(pane, u, &seen))
                continue;
            sum = orl_rgb_add(sum, light_from(pane, &seen, orl_sun_sample(pane->sun, u + 2)));
        }
    return sum;
}

struct orl_rgb orl_sun_through_panes(const struct orl_pane_query *query)
{
    const struct orl_lit_scene *lit_scene = query->lit_scene;
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t f = 0; f < lit_scene->geometry->n_facets; f++) {
        const uint32_t material = orl_facet_material(lit_scene->geometry, f);
        const int32_t port = lit_scene->port_of_facet[f];
        if (!orl_material_transmits_lobes(&lit_scene->materials[material]) ||
            !(orl_facet_area(lit_scene->geometry, f) > 0))
            continue;
        for (size_t s = 0; s < lit_scene->n_suns; s++) {
            const struct pane pane = {
                query, f, port == ORL_NO_PORT ? NULL : &lit_scene->ports[port], &lit_scene->suns[s],
                find_window_lobe(query->sampler, port, &lit_scene->suns[s])};
            sum = orl_rgb_add(sum, light_by_pane(&pane));
        }
    }
    return sum;
}

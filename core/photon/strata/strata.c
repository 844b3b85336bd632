#include <stdlib.h>
#include <string.h>

#include "light/path.h"
#include "photon/emission/emit_sampling.h"
#include "photon/emission/port_emission.h"
#include "photon/strata/strata.h"
#include "scene/material/scatter.h"

/* ---- First reflection ------------------------------------------------------------------------ */

/*
 * Emission of light whose first hit is not stored in the map. Shadow rays and caustic photons count
 * the direct light of suns and lamps, and maps that are viewed directly begin with its first
 * reflection (omit.counted_light). If all of it were emitted as photons of equal flux, most would
 * end on that first surface without leaving a photon.
 *
 * So such strata emit fewer photons with more flux each. The factor is the mean albedo of the
 * surfaces of their first hits, weighted by the reflected light. At the first reflection a photon
 * survives with a probability of its albedo over that mean, and its flux is multiplied by the mean.
 * So the photons that it deposits have the same flux as others. On brighter surfaces it always
 * survives, and has more flux. Any value is unbiased; a good one is efficient.
 */

enum { EMISSIONS = 1 << 15, MOST_EMISSIONS = 1 << 10, LEAST_EMISSIONS = 64, MOST_BOUNCES = 16 };

/* Lower bound, so that the few bright surfaces of a dark scene are not lit by a handful of heavy
 * photons. */
static const double least_reflected = 0.1;

struct reflection_pilot {
    struct orl_emission *emission;
    uint64_t seed;
    uint32_t emissions;
};

/* Finds the flux that reaches the first diffuse surface, and that surface's albedo. Returns false
 * if the photon never hits one. */
static bool find_first_diffuse_hit(const struct orl_lit_scene *lit_scene,
                                   const struct orl_photon_ray *photon_ray,
                                   struct orl_random *random, double *ret_flux, double *ret_albedo)
{
    struct orl_path path = orl_path_from(photon_ray->origin, photon_ray->direction);
    path.weight = photon_ray->flux;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return false;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        *ret_albedo = fmin(orl_luma(orl_material_diffuse(m, &hit)), 1);
        *ret_flux = orl_luma(path.weight);
        if (*ret_albedo > 0)
            return isfinite(*ret_flux);
        const struct orl_surface_sample s = orl_material_sample(
            m, &hit, orl_path_back(&path), ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return false;
        path.weight = orl_rgb_mul(path.weight, s.weight);
        orl_path_spawn_ray(&path, lit_scene, &hit, &s);
    }
    return false;
}

static void estimate_reflected(void *arg, size_t index, uint32_t member)
{
    const struct reflection_pilot *reflection_pilot = arg;
    const struct orl_emission *e = reflection_pilot->emission;
    struct orl_stratum *stratum = &e->strata[index];
    struct orl_health ignored = {0}; /* counters of pilot emissions are discarded */
    double reflected = 0, squares = 0;
    (void)member;
    for (uint32_t i = 0; i < reflection_pilot->emissions && orl_stratum_is_direct(e, stratum);
         i++) {
        double point[5], flux, albedo;
        struct orl_photon_ray photon_ray;
        struct orl_random random =
            orl_random_stream(reflection_pilot->seed, ORL_PURPOSE_FIRST, (uint64_t)index << 32 | i);
        orl_sobol_point(&e->sobol, i, (uint32_t)(reflection_pilot->seed + index), 5, point);
        if (!orl_emission_sample_stratum(e, stratum, false, point, &random, &ignored,
                                         &photon_ray) ||
            !find_first_diffuse_hit(e->lit_scene, &photon_ray, &random, &flux, &albedo))
            continue;
        reflected += flux * albedo;
        squares += flux * albedo * albedo;
    }
    if (reflected > 0 && isfinite(squares))
        stratum->reflected = fmin(fmax(squares / reflected, least_reflected), 1);
}

/*
 * Sets `reflected` of all strata by pilot emissions; 1 if all light is stored. Returns 0 or
 * ORL_ERR_CANCELLED.
 */
static int set_first_reflection(struct orl_emission *emission, uint64_t seed,
                                struct orl_thread_pool *pool)
{
    struct reflection_pilot reflection_pilot = {
        .emission = emission,
        .seed = seed,
        .emissions =
            orl_pilot_share(EMISSIONS, emission->n_strata + 1, LEAST_EMISSIONS, MOST_EMISSIONS)};
    for (size_t i = 0; i < emission->n_strata; i++)
        emission->strata[i].reflected = 1;
    return emission->lit_scene->omit.counted_light
               ? orl_parallel_try(pool, emission->n_strata, estimate_reflected, &reflection_pilot)
               : 0;
}

/* ---- Strata ---------------------------------------------------------------------------------- */

/*
 * Pilots of light at ports. Paths are distributed over the ports, so that a building of a thousand
 * windows costs no more than a room: few ports have fine distributions, many have coarse ones.
 */
enum { PILOT_PATHS = 1 << 18, PATHS_A_CELL = 16, FINEST_SIDE = 32, COARSEST_SIDE = 4 };
enum { DOME_SIDE_X = 128, DOME_SIDE_Y = 64 };
enum { IMAGE_EMISSIONS = 256, LAMP_EMISSIONS = 1 << 16, LEAST_EMISSIONS_OF_LAMP = 8 };
/* lower bound of a lamp's estimated flux, as a share of the unobstructed flux */
static const double least_of_open = 0.01;
/* share of cosine-weighted directions in every distribution */
static const double floor_share = 0.1;
/* Bounds on the share of photons that start at the sky of an open scene: with ports, and with
 * lamps only. */
static const double least_open = 0.25, most_open = 0.75, most_open_beside_lamps = 0.9;

struct pilot {
    struct orl_emission *emission;
    uint64_t seed;
    uint32_t side;
    double *values; /* side * side per port */
};

static double transmitted_luma(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                               struct orl_vec3 outwards)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, port->facet, &own);
    const struct orl_material *m = &lit_scene->materials[facet->material];
    const struct orl_hit hit = orl_hit_surface_mean(facet->normal, false);
    return orl_luma(orl_material_albedo(m, &hit, outwards, ORL_LOBE_TRANSMITTED));
}

/* Fills one cell of one port's distribution with the mean of the transmitted light. */
static void fill_cell(void *arg, size_t index, uint32_t member)
{
    struct pilot *pilot = arg;
    const struct orl_lit_scene *lit_scene = pilot->emission->lit_scene;
    const size_t cells = (size_t)pilot->side * pilot->side;
    const struct orl_port *port = &lit_scene->ports[index / cells];
    if (port->silent)
        return;
    const size_t x = index % cells % pilot->side, y = index % cells / pilot->side;
    struct orl_random random = orl_random_stream(pilot->seed, ORL_PURPOSE_PILOT, 2 * index);
    struct orl_health ignored = {0}; /* counters of pilot paths are discarded */
    double sum = 0;
    (void)member;
    for (int i = 0; i < PATHS_A_CELL; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        const double at_x = ((double)x + orl_random_uniform(&random)) / pilot->side;
        const double at_y = ((double)y + orl_random_uniform(&random)) / pilot->side;
        const struct orl_vec3 out = orl_hemisphere_about(port->outward, at_x, at_y);
        struct orl_vec3 point, normal;
        orl_facet_sample(lit_scene->geometry, port->facet, u, &point, &normal);
        point =
            orl_facet_ray_origin(lit_scene->geometry, port->facet, point, normal, port->outward);
        sum += orl_luma(orl_port_radiance(lit_scene, port, point, out, &random, &ignored)) *
               transmitted_luma(lit_scene, port, out);
    }
    pilot->values[index] = sum / PATHS_A_CELL;
}

static int build_port_distributions(struct pilot *pilot, struct orl_thread_pool *pool)
{
    struct orl_emission *e = pilot->emission;
    const size_t n_ports = e->lit_scene->n_ports;
    int code = 0;
    pilot->side = FINEST_SIDE;
    while (pilot->side > COARSEST_SIDE &&
           (size_t)pilot->side * pilot->side * n_ports * PATHS_A_CELL > PILOT_PATHS)
        pilot->side /= 2;
    const size_t cells = (size_t)pilot->side * pilot->side;
    pilot->values = calloc(n_ports * cells + 1, sizeof *pilot->values);
    e->port_distributions = calloc(n_ports + 1, sizeof *e->port_distributions);
    if (!pilot->values || !e->port_distributions)
        return ORL_ERR_NOMEM;
    code = orl_parallel_try(pool, n_ports * cells, fill_cell, pilot);
    for (size_t i = 0; i < n_ports && code == 0; i++)
        code = orl_distribution_2d_init(&e->port_distributions[i], pilot->side, pilot->side,
                                        pilot->values + i * cells, floor_share);
    return code;
}

/* Returns the projected area of the scene's box in a direction. */
static double box_area(const struct orl_geometry *g, struct orl_vec3 d)
{
    const struct orl_vec3 s = orl_sub(g->high, g->low);
    return fabs(d.x) * s.y * s.z + fabs(d.y) * s.x * s.z + fabs(d.z) * s.x * s.y;
}

/* Builds the distribution of dome directions by radiance and projected area of the scene; if
 * by_importance, also by the importance of light from there. */
static int build_dome_distribution(struct orl_emission *e, bool by_importance)
{
    double *values = malloc(sizeof *values * DOME_SIDE_X * DOME_SIDE_Y);
    if (!values)
        return ORL_ERR_NOMEM;
    orl_distribution_2d_done(&e->dome_distribution);
    for (int i = 0; i < DOME_SIDE_X * DOME_SIDE_Y; i++) {
        const int row = i / DOME_SIDE_X, column = i % DOME_SIDE_X;
        const double z = 2 * (row + 0.5) / DOME_SIDE_Y - 1, s = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * (column + 0.5) / DOME_SIDE_X;
        const struct orl_vec3 d = orl_v3(s * cos(phi), s * sin(phi), z);
        values[i] = orl_luma(orl_lit_scene_dome_radiance(e->lit_scene, d)) *
                    box_area(e->lit_scene->geometry, d) *
                    (by_importance ? orl_emission_importance_mean(e, d) : 1);
    }
    const int code = orl_distribution_2d_init(&e->dome_distribution, DOME_SIDE_X, DOME_SIDE_Y,
                                              values, floor_share);
    free(values);
    return code;
}

static void add_stratum(struct orl_emission *e, struct orl_stratum stratum, double flux_w)
{
    stratum.flux_w = flux_w;
    stratum.importance = 1;
    if (flux_w > 0)
        e->strata[e->n_strata++] = stratum;
}

static struct orl_stratum stratum_of(enum orl_stratum_kind kind, size_t port, size_t sun)
{
    return (struct orl_stratum){.kind = kind, .port = (uint32_t)port, .sun = (uint32_t)sun};
}

/* Returns the flux of a sun through a port, without shadows. Emissions find the part that is not in
 * shadow. */
static double port_sun_flux(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                            const struct orl_sun *sun)
{
    const double cosine = orl_dot(sun->frame.n, port->outward);
    const double half = sqrt(fmax(0, 1 - sun->cos_half_angle * sun->cos_half_angle));
    if (cosine < -half)
        return 0;
    /* Half of the disc of a sun in the pane's plane is still in front, so the flux is not zero. */
    const double seen = fmax(cosine, half);
    const struct orl_vec3 out =
        cosine > 0 ? sun->frame.n : orl_normalize(orl_madd(sun->frame.n, port->outward, half));
    return orl_luma(sun->irradiance) * seen * port->area *
           fmax(transmitted_luma(lit_scene, port, out), 1e-3);
}

/* Returns the mean flux of emissions by which a sun's image reaches a port. */
static double port_image_flux(const struct orl_emission *e, const struct orl_stratum *stratum)
{
    struct orl_health ignored = {0};
    double sum = 0;
    for (uint32_t i = 0; i < IMAGE_EMISSIONS; i++) {
        double point[5];
        struct orl_photon_ray photon_ray;
        struct orl_random random = orl_random_stream(stratum->port, ORL_PURPOSE_PILOT, i);
        orl_sobol_point(&e->sobol, i, stratum->image, 5, point);
        if (orl_emission_sample_stratum(e, stratum, false, point, &random, &ignored, &photon_ray))
            sum += orl_luma(photon_ray.flux) / IMAGE_EMISSIONS;
    }
    return sum;
}

/* Lists strata of the suns' images in mirrors outside, if some pilot emission reaches the port. */
static int list_images(struct orl_emission *e, const struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    for (size_t p = 0; p < lit_scene->n_ports; p++) {
        if (lit_scene->ports[p].clear || lit_scene->ports[p].silent || lit_scene->omit.exterior)
            continue;
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        for (size_t i = 0; i < lit_scene->images.n_nodes; i++) {
            const struct orl_virtual_sun *image = &lit_scene->images.nodes[i];
            const struct orl_stratum stratum = {.kind = ORL_STRATUM_PORT_IMAGE,
                                                .port = (uint32_t)p,
                                                .sun = image->sun,
                                                .image = (uint32_t)i};
            if (image->shown)
                add_stratum(e, stratum, port_image_flux(e, &stratum));
        }
    }
    return 0;
}

/* Returns the flux through the pane: from a few emissions, and at least a hundredth of the
 * unobstructed flux, because so few emissions may miss light through a gap. */
static double port_lamp_flux(const struct orl_emission *e, const struct orl_stratum *stratum)
{
    const uint32_t emissions = orl_pilot_share(LAMP_EMISSIONS, orl_port_lamp_count_strata(e),
                                               LEAST_EMISSIONS_OF_LAMP, IMAGE_EMISSIONS);
    struct orl_health ignored = {0};
    double passing = 0, open = 0;
    for (uint32_t i = 0; i < emissions; i++) {
        double point[5];
        struct orl_photon_ray photon_ray;
        struct orl_random random = orl_random_stream(stratum->port, ORL_PURPOSE_PILOT,
                                                     ((uint64_t)stratum->lamp << 32) + i);
        orl_sobol_point(&e->sobol, i, stratum->lamp, 5, point);
        if (orl_emission_sample_stratum(e, stratum, false, point, &random, &ignored, &photon_ray))
            passing += orl_luma(photon_ray.flux) / emissions;
        open += orl_port_lamp_unoccluded_flux(e, stratum, i, point + 1) / emissions;
    }
    return fmax(passing, least_of_open * open);
}

/* Lists strata of lamps outside: for each port one for each lamp, or one for all lamps. */
static int list_lamps(struct orl_emission *e, const struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    const size_t strata = orl_port_lamp_count_strata(e);
    const size_t each = strata > lit_scene->n_ports ? e->n_lamps_outside : strata > 0;
    for (size_t p = 0; p < lit_scene->n_ports; p++) {
        if (lit_scene->ports[p].silent)
            continue;
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        for (size_t i = 0; i < each; i++) {
            const struct orl_stratum stratum = {
                .kind = ORL_STRATUM_PORT_LAMP,
                .port = (uint32_t)p,
                .lamp = strata > lit_scene->n_ports ? e->lamps_outside[i] : ORL_ANY_LAMP};
            add_stratum(e, stratum, port_lamp_flux(e, &stratum));
        }
    }
    return 0;
}

/* Returns the flux of an emitter; for spotlights an upper bound. */
static double emitter_flux(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    const struct orl_material *m = &lit_scene->materials[facet->material];
    const double cone = m->kind == ORL_MATERIAL_SPOTLIGHT
                            ? 2 * ORL_PI * (1 - orl_spotlight_of(m)->cos_cone)
                            : ORL_PI;
    return fmin(cone, ORL_PI) * facet->area * orl_luma(emitter->radiance);
}

static int list_strata(struct orl_emission *e, const struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    int code = orl_port_lamps_find(e, pool);
    if (code < 0)
        return code;
    const size_t most = lit_scene->n_ports * (1 + lit_scene->n_suns + lit_scene->images.n_nodes) +
                        orl_port_lamp_count_strata(e) + lit_scene->n_emitters + lit_scene->n_suns +
                        1;
    e->strata = calloc(most, sizeof *e->strata);
    if (!e->strata)
        return ORL_ERR_NOMEM;
    for (size_t p = 0; p < lit_scene->n_ports; p++) {
        const struct orl_port *port = &lit_scene->ports[p];
        add_stratum(e, stratum_of(ORL_STRATUM_PORT_DOME, p, 0),
                    ORL_PI * port->area * e->port_distributions[p].mean);
        for (size_t s = 0; s < lit_scene->n_suns && !port->silent; s++)
            add_stratum(e, stratum_of(ORL_STRATUM_PORT_SUN, p, s),
                        port_sun_flux(lit_scene, port, &lit_scene->suns[s]));
    }
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        const struct orl_emitter *emitter = &lit_scene->emitters[i];
        if (lit_scene->open || !orl_port_lamp_is_outside(e, i))
            add_stratum(e, stratum_of(ORL_STRATUM_EMITTER, i, 0), emitter_flux(lit_scene, emitter));
    }
    code = list_lamps(e, pool);
    if (code == 0)
        code = list_images(e, pool);
    if (code < 0 || !lit_scene->open)
        return code;
    add_stratum(e, stratum_of(ORL_STRATUM_OPEN_DOME, 0, 0), 4 * ORL_PI * e->dome_distribution.mean);
    for (size_t s = 0; s < lit_scene->n_suns; s++)
        add_stratum(e, stratum_of(ORL_STRATUM_OPEN_SUN, 0, s),
                    orl_luma(lit_scene->suns[s].irradiance) *
                        box_area(lit_scene->geometry, lit_scene->suns[s].frame.n));
    return 0;
}

static bool starts_at_sky(const struct orl_stratum *s)
{
    return s->kind == ORL_STRATUM_OPEN_DOME || s->kind == ORL_STRATUM_OPEN_SUN;
}

static double flux_to_keep(const struct orl_stratum *s)
{
    return s->flux_w * s->reflected;
}

/* Sets the importance of the sky's light, from the importance maps. */
static int set_sky_importance(struct orl_emission *e)
{
    const double before = e->dome_distribution.mean;
    int code = 0;
    for (size_t i = 0; i < e->n_strata && code == 0; i++) {
        struct orl_stratum *s = &e->strata[i];
        if (s->kind == ORL_STRATUM_OPEN_SUN)
            s->importance = e->sun_importance[s->sun].mean;
        if (s->kind != ORL_STRATUM_OPEN_DOME)
            continue;
        code = build_dome_distribution(e, true);
        s->importance = before > 0 ? e->dome_distribution.mean / before : 1;
    }
    return code;
}

/* Returns the sky's share of photons: that of its important flux, within bounds. The light on
 * the whole neighbourhood never takes all photons, and the small part that enters is not carried
 * by a few heavy ones. */
static double share_of_sky(const struct orl_emission *e, double sky, double weighted_sky,
                           double rest)
{
    const double by_flux = sky / (sky + rest);
    if (!(sky > 0) || !(rest > 0))
        return sky > 0;
    if (e->lit_scene->n_ports == 0)
        return fmin(by_flux, most_open_beside_lamps);
    return fmax(fmin(by_flux, least_open), fmin(weighted_sky / (weighted_sky + rest), most_open));
}

/* Distributes global photons by flux. */
static void set_shares(struct orl_emission *e)
{
    double sky = 0, weighted_sky = 0, rest = 0, cdf = 0;
    for (size_t i = 0; i < e->n_strata; i++) {
        const struct orl_stratum *s = &e->strata[i];
        if (starts_at_sky(s)) {
            sky += flux_to_keep(s);
            weighted_sky += flux_to_keep(s) * s->importance;
        } else {
            rest += flux_to_keep(s);
        }
    }
    const double of_sky = share_of_sky(e, sky, weighted_sky, rest);
    for (size_t i = 0; i < e->n_strata; i++) {
        struct orl_stratum *s = &e->strata[i];
        s->share = starts_at_sky(s) ? of_sky * flux_to_keep(s) * s->importance / weighted_sky
                                    : (1 - of_sky) * flux_to_keep(s) / rest;
        s->cdf = cdf;
        cdf += s->share;
    }
}

int orl_emission_new(const struct orl_lit_scene *lit_scene, enum orl_photon_use use, uint64_t seed,
                     struct orl_thread_pool *pool, struct orl_emission **ret_emission,
                     struct orl_error *err)
{
    struct orl_emission *e = calloc(1, sizeof *e);
    struct pilot pilot = {.emission = e, .seed = seed};
    int code = e ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        e->lit_scene = lit_scene;
        e->n_ports = lit_scene->n_ports;
        e->n_suns = lit_scene->n_suns;
        e->use = use;
        e->seed = seed;
        orl_sobol_init(&e->sobol);
        code = build_port_distributions(&pilot, pool);
    }
    if (code == 0 && lit_scene->open)
        code = build_dome_distribution(e, false);
    if (code == 0)
        code = list_strata(e, pool);
    if (code == 0)
        code = orl_port_sun_prepare(e, pool);
    if (code == 0 && lit_scene->open)
        code = orl_emission_importance_build(e, seed, pool);
    if (code == 0 && lit_scene->open)
        code = set_sky_importance(e);
    if (code == 0)
        code = set_first_reflection(e, seed, pool);
    if (code == 0) {
        set_shares(e);
        code = orl_caustic_pilot(e, seed, pool);
    }
    free(pilot.values);
    if (code < 0) {
        orl_emission_free(e);
        return orl_error_set(err, code, "%s preparing photon emission",
                             code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    }
    *ret_emission = e;
    return 0;
}

void orl_emission_free(struct orl_emission *emission)
{
    if (!emission)
        return;
    for (size_t i = 0; emission->port_distributions && i < emission->n_ports; i++)
        orl_distribution_2d_done(&emission->port_distributions[i]);
    free(emission->port_distributions);
    orl_distribution_2d_done(&emission->dome_distribution);
    orl_emission_importance_done(emission);
    orl_port_sun_done(emission);
    for (size_t i = 0; emission->strata && i < emission->n_strata; i++)
        orl_distribution_2d_done(&emission->strata[i].place);
    free(emission->strata);
    free(emission->lamps_outside);
    free(emission);
}

uint64_t orl_emission_detach(struct orl_emission *emission)
{
    uint64_t bytes = sizeof *emission + emission->n_strata * sizeof *emission->strata +
                     orl_distribution_2d_bytes(&emission->dome_distribution) +
                     orl_emission_importance_bytes(emission);
    for (size_t i = 0; i < emission->n_ports; i++)
        bytes += orl_distribution_2d_bytes(&emission->port_distributions[i]);
    for (size_t i = 0; i < emission->n_strata; i++)
        bytes += orl_distribution_2d_bytes(&emission->strata[i].place) +
                 (emission->strata[i].shadow_boxes ? sizeof *emission->strata[i].shadow_boxes : 0);
    orl_sun_bsdf_tables_free(emission);
    emission->lit_scene = NULL;
    return bytes;
}

int orl_emission_attach(struct orl_emission *emission, const struct orl_lit_scene *lit_scene)
{
    emission->lit_scene = lit_scene;
    return orl_sun_bsdf_tables_make(emission);
}

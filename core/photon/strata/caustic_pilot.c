#include "photon/strata/strata.h"

#include <math.h>
#include <stdlib.h>

#include "light/path.h"
#include "photon/emission/emit_sampling.h"
#include "photon/tracing/trace.h"
#include "scene/material/scatter.h"

/* ---- Targets of caustics --------------------------------------------------------------------- */

/*
 * Importance of points on a window for caustics: where a sun's light continues to a mirror, a lens
 * or a lobe. A mirror of a square centimetre behind a window of three square metres gets one photon
 * in 30 000. That is too few for a caustic, and a pilot easily finds none. So the search is
 * reversed: rays from points on every such facet are traced towards the sun, and the points where
 * they pass a window are recorded. If only a small part of the window leads to targets, nine in ten
 * caustic photons start there.
 */

enum { TARGET_SIDE = 64, TARGET_CELLS = TARGET_SIDE * TARGET_SIDE };

enum { MOST_RAYS = 1 << 17, MOST_A_FACET = 1024, LEAST_A_FACET = 4, MOST_PANES = 64 };
static const double uniform_share = 0.1; /* share of photons that start anywhere on the pane */
/* if a larger share of the cells leads to targets, photons start anywhere */
static const double most_cells = 0.5;

static bool is_target_material(const struct orl_material *m)
{
    return orl_material_is_mirror(m) || orl_material_has_lobes(m);
}

/* Inverts orl_facet_sample: computes the two numbers that give a point on a polygon. */
static void invert_facet_sample(const struct orl_geometry *g, const struct orl_facet *f,
                                struct orl_vec3 point, double ret_u[2])
{
    double below = 0, best = -INFINITY;
    ret_u[0] = ret_u[1] = 0;
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        const struct orl_vec3 ab = orl_sub(t.b, t.a), ac = orl_sub(t.c, t.a);
        const struct orl_vec3 ap = orl_sub(point, t.a), n = orl_cross(ab, ac);
        const double n2 = orl_dot(n, n), area = 0.5 * sqrt(n2);
        const double b = n2 > 0 ? orl_dot(orl_cross(ap, ac), n) / n2 : 0;
        const double c = n2 > 0 ? orl_dot(orl_cross(ab, ap), n) / n2 : 0;
        const double inside = fmin(fmin(b, c), 1 - b - c);
        if (inside > best) {
            const double s = fmin(fmax(b + c, 0), 1);
            best = inside;
            ret_u[0] = (below + s * s * area) / f->area;
            ret_u[1] = s > 0 ? fmin(fmax(c / s, 0), 1) : 0;
        }
        below += area;
    }
}

/*
 * Returns the port by which a ray from inside leaves the scene, straight through panes; ORL_NO_PORT
 * if it does not. Of several ports it is the last, where the light entered first.
 */
static int32_t find_exit_port(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                              struct orl_vec3 direction, struct orl_hit *ret_hit, double *ret_share)
{
    struct orl_path path = orl_path_from(point, direction);
    int32_t port = ORL_NO_PORT;
    *ret_share = 1;
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return port;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        *ret_share *= orl_luma(orl_material_straight(m, &hit, orl_path_back(&path)));
        if (!(*ret_share > 0))
            return ORL_NO_PORT;
        orl_path_skip_surface(&path, lit_scene, &hit);
        if (orl_lit_scene_crossing(lit_scene, &hit) == ORL_CROSSING_OUTWARDS) {
            *ret_hit = hit;
            port = lit_scene->port_of_facet[hit.facet];
        }
    }
    return ORL_NO_PORT;
}

/* Returns the cell of the two numbers that sample a point on a facet. */
static size_t target_cell(const double u[2])
{
    const size_t x = (size_t)(u[0] * TARGET_SIDE), y = (size_t)(u[1] * TARGET_SIDE);
    const size_t last = TARGET_SIDE - 1;
    return (y < last ? y : last) * TARGET_SIDE + (x < last ? x : last);
}

static int add_watts(double **target_flux, size_t cell, double watts)
{
    if (!*target_flux)
        *target_flux = calloc(TARGET_CELLS, sizeof **target_flux);
    if (!*target_flux)
        return ORL_ERR_NOMEM;
    (*target_flux)[cell] += watts;
    return 0;
}

/* Traces rays from points of one facet towards one sun. of_port: per port, the stratum of the
 * port and that sun. */
static int trace_from_facet(const struct orl_emission *e, uint32_t facet, uint32_t sun,
                            uint32_t samples, const size_t *of_port, double **target_flux)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    const struct orl_geometry *g = lit_scene->geometry;
    int code = 0;
    for (uint32_t i = 0; i < samples && code == 0; i++) {
        struct orl_vec3 point, normal;
        struct orl_hit hit = {.facet = 0};
        double u[4], at[2], share;
        orl_sobol_point(&e->sobol, i, facet, 4, u);
        orl_facet_sample(g, facet, u, &point, &normal);
        const struct orl_vec3 towards = orl_sun_sample(&lit_scene->suns[sun], u + 2);
        point = orl_facet_ray_origin(g, facet, point, normal, towards);
        const int32_t port = find_exit_port(lit_scene, point, towards, &hit, &share);
        if (port == ORL_NO_PORT || !(share > 0) || of_port[port] == SIZE_MAX)
            continue;
        struct orl_facet own;
        invert_facet_sample(g, orl_facet_get_own(g, hit.facet, &own), hit.point, at);
        code = add_watts(&target_flux[of_port[port]], target_cell(at),
                         share * orl_luma(lit_scene->suns[sun].irradiance) *
                             fabs(orl_dot(towards, normal)) * orl_facet_area(g, facet) / samples);
    }
    return code;
}

/*
 * Adds to target_flux[stratum], for suns in ports, the flux through each cell that reaches such
 * facets, in watts of luma. Allocates entries that are NULL if they get any flux. pool: polled for
 * cancellation. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
static int find_target_flux(const struct orl_emission *emission, const struct orl_thread_pool *pool,
                            double **target_flux)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    const struct orl_geometry *g = lit_scene->geometry;
    size_t *of_port = malloc((lit_scene->n_ports + 1) * sizeof *of_port);
    size_t facets = 1;
    int code = of_port ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->n_facets; i++)
        facets += orl_facet_area(g, i) > 0 &&
                  is_target_material(&lit_scene->materials[orl_facet_material(g, i)]);
    const uint32_t samples =
        orl_pilot_share(MOST_RAYS, facets * (lit_scene->n_suns + 1), LEAST_A_FACET, MOST_A_FACET);
    for (uint32_t sun = 0; sun < lit_scene->n_suns && lit_scene->n_ports > 0 && code == 0; sun++) {
        for (size_t p = 0; p < lit_scene->n_ports; p++)
            of_port[p] = SIZE_MAX;
        for (size_t s = 0; s < emission->n_strata; s++)
            if (emission->strata[s].kind == ORL_STRATUM_PORT_SUN && emission->strata[s].sun == sun)
                of_port[emission->strata[s].port] = s;
        for (uint32_t i = 0; i < g->n_facets && code == 0; i++)
            if (orl_facet_area(g, i) > 0 &&
                is_target_material(&lit_scene->materials[orl_facet_material(g, i)]))
                code = orl_thread_pool_cancelled(pool)
                           ? ORL_ERR_CANCELLED
                           : trace_from_facet(emission, i, sun, samples, of_port, target_flux);
    }
    free(of_port);
    return code;
}

/* Makes a stratum's distribution of starts from that flux; leaves it empty if most of the pane
 * leads to targets. Returns 0 or ORL_ERR_NOMEM. */
static int build_target_distribution(struct orl_stratum *stratum, const double *target_flux)
{
    size_t cells = 0;
    for (size_t i = 0; i < TARGET_CELLS; i++)
        cells += target_flux[i] > 0;
    if (cells == 0 || (double)cells > most_cells * TARGET_CELLS)
        return 0;
    return orl_distribution_2d_init(&stratum->place, TARGET_SIDE, TARGET_SIDE, target_flux,
                                    uniform_share);
}

/* ---- Pilot ----------------------------------------------------------------------------------- */

enum {
    CAUSTIC_EMISSIONS = 1 << 17,
    MOST_EMISSIONS_A_STRATUM = 1 << 14,
    LEAST_EMISSIONS_A_STRATUM = 512
};
enum { CAUSTIC_RAYS = 1 << 20 }; /* per stratum: enough where photons bounce between mirrors */
/* share of caustic photons distributed by flux over all strata that may yield some */
static const double caustic_floor = 0.02;

struct pilot {
    struct orl_emission *emission;
    uint64_t seed;
    uint32_t emissions, open_emissions; /* per stratum; per stratum of a sun on the whole scene */
    double *yield;                      /* per stratum: caustic flux deposited per emission */
    /* for some strata: flux by the cell of the port where it would start (find_target_flux) */
    double **target_flux;
};

/* Estimates the caustic flux per emission of one stratum by tracing some. */
static void trace_caustics(void *arg, size_t index, uint32_t member)
{
    struct pilot *pilot = arg;
    const struct orl_stratum *stratum = &pilot->emission->strata[index];
    const uint32_t emissions =
        stratum->kind == ORL_STRATUM_OPEN_SUN ? pilot->open_emissions : pilot->emissions;
    struct orl_deposits deposits = {0};
    uint32_t emitted = 0;
    double sum = 0;
    (void)member;
    for (uint32_t i = 0; i < emissions && deposits.health.rays < CAUSTIC_RAYS; i++) {
        double point[5];
        struct orl_photon_ray photon_ray;
        emitted++;
        struct orl_random random =
            orl_random_stream(pilot->seed, ORL_PURPOSE_PILOT, 2 * ((uint64_t)index << 32 | i) + 1);
        orl_sobol_point(&pilot->emission->sobol, i, (uint32_t)(pilot->seed + index), 5, point);
        if (!orl_emission_sample_stratum(pilot->emission, stratum, true, point, &random,
                                         &deposits.health, &photon_ray))
            continue;
        if (!photon_ray.from_light)
            break;
        orl_trace_photon(pilot->emission->lit_scene, &photon_ray, true, 0, &random, &deposits);
    }
    for (size_t i = 0; i < deposits.count; i++)
        sum += orl_photon_luma(&deposits.photons[i]);
    free(deposits.photons);
    pilot->yield[index] = sum / emitted;
}

/* Returns true if the pane itself scatters, so that every point on it makes caustic photons. */
static bool pane_scatters(const struct orl_emission *e, const struct orl_stratum *s)
{
    const uint32_t facet = e->lit_scene->ports[s->port].facet;
    const uint32_t material = orl_facet_material(e->lit_scene->geometry, facet);
    return orl_material_transmits_lobes(&e->lit_scene->materials[material]);
}

/*
 * Combines two estimates of caustic flux: that of the emissions, and that of rays traced back from
 * the mirrors. The first misses small mirrors, the second light that reaches mirrors by way of
 * other surfaces.
 */
static int find_targets(struct pilot *pilot, const struct orl_thread_pool *pool)
{
    struct orl_emission *e = pilot->emission;
    int code = 0;
    pilot->target_flux = calloc(e->n_strata + 1, sizeof *pilot->target_flux);
    if (!pilot->target_flux)
        return ORL_ERR_NOMEM;
    code = find_target_flux(e, pool, pilot->target_flux);
    for (size_t i = 0; i < e->n_strata && code == 0; i++) {
        double sum = 0;
        if (!pilot->target_flux[i])
            continue;
        for (size_t k = 0; k < TARGET_CELLS; k++)
            sum += pilot->target_flux[i][k];
        if (!pane_scatters(e, &e->strata[i]))
            code = build_target_distribution(&e->strata[i], pilot->target_flux[i]);
        if (e->strata[i].place.weight)
            pilot->yield[i] = fmax(pilot->yield[i], sum);
    }
    return code;
}

/* Returns the number of emissions for each of `strata` strata. */
static uint32_t emissions_each(size_t strata)
{
    return orl_pilot_share(CAUSTIC_EMISSIONS, strata + 1, LEAST_EMISSIONS_A_STRATUM,
                           MOST_EMISSIONS_A_STRATUM);
}

/* Windows share the emissions. A sun on a whole building has separate ones, because few of them
 * hit any pane: of 512 none may be mirrored if one photon in 2000 is. */
static void allot_emissions(struct pilot *pilot)
{
    const struct orl_emission *e = pilot->emission;
    size_t open = 0;
    for (size_t i = 0; i < e->n_strata; i++)
        open += e->strata[i].kind == ORL_STRATUM_OPEN_SUN;
    pilot->emissions = emissions_each(e->n_strata);
    pilot->open_emissions = emissions_each(open);
}

/* Distributes caustic photons by the flux that the pilot found, and a small share everywhere. */
static int set_caustic_shares(struct pilot *pilot, struct orl_thread_pool *pool)
{
    struct orl_emission *e = pilot->emission;
    double sum = 0, flux = 0, cdf = 0;
    pilot->yield = calloc(e->n_strata + 1, sizeof *pilot->yield);
    if (!pilot->yield)
        return ORL_ERR_NOMEM;
    if (e->lit_scene->omit.mirror_caustics && e->lit_scene->omit.lobe_caustics)
        return 0;
    allot_emissions(pilot);
    int code = orl_parallel_try(pool, e->n_strata, trace_caustics, pilot);
    if (code == 0)
        code = find_targets(pilot, pool);
    if (code < 0)
        return code;
    for (size_t i = 0; i < e->n_strata; i++) {
        sum += pilot->yield[i];
        flux += orl_stratum_is_direct(e, &e->strata[i]) ? e->strata[i].flux_w : 0;
    }
    const double spread = sum > 0 ? caustic_floor : 1;
    e->has_caustics = sum > 0 || (e->lit_scene->caustics_lit && flux > 0);
    for (size_t i = 0; i < e->n_strata && e->has_caustics; i++) {
        struct orl_stratum *s = &e->strata[i];
        s->share_caustic = sum > 0 ? (1 - caustic_floor) * pilot->yield[i] / sum : 0;
        if (orl_stratum_is_direct(e, s))
            s->share_caustic += spread * s->flux_w / flux;
        s->cdf_caustic = cdf;
        cdf += s->share_caustic;
    }
    return 0;
}

int orl_caustic_pilot(struct orl_emission *emission, uint64_t seed, struct orl_thread_pool *pool)
{
    struct pilot pilot = {.emission = emission, .seed = seed};
    const int code = set_caustic_shares(&pilot, pool);
    for (size_t i = 0; pilot.target_flux && i < emission->n_strata; i++)
        free(pilot.target_flux[i]);
    free(pilot.target_flux);
    free(pilot.yield);
    return code;
}

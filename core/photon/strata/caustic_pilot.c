#include "photon/strata/caustic_pilot.h"

#include <math.h>
#include <stdlib.h>

#include "photon/strata/caustic_targets.h"
#include "photon/tracing/trace.h"

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
    /* for some strata: flux by the cell of the port where it would start (caustic_targets.h) */
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
        sum += orl_luma((struct orl_rgb){deposits.photons[i].flux[0], deposits.photons[i].flux[1],
                                         deposits.photons[i].flux[2]});
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
    code = orl_caustic_target_find(e, pool, pilot->target_flux);
    for (size_t i = 0; i < e->n_strata && code == 0; i++) {
        double sum = 0;
        if (!pilot->target_flux[i])
            continue;
        for (size_t k = 0; k < ORL_CAUSTIC_TARGET_CELLS; k++)
            sum += pilot->target_flux[i][k];
        if (!pane_scatters(e, &e->strata[i]))
            code = orl_caustic_target_build(&e->strata[i], pilot->target_flux[i]);
        if (e->strata[i].place.weight)
            pilot->yield[i] = fmax(pilot->yield[i], sum);
    }
    return code;
}

/* Returns the number of emissions for each of `strata` strata. */
static uint32_t emissions_each(size_t strata)
{
    const size_t each = CAUSTIC_EMISSIONS / (strata + 1);
    return (uint32_t)(each > MOST_EMISSIONS_A_STRATUM    ? MOST_EMISSIONS_A_STRATUM
                      : each < LEAST_EMISSIONS_A_STRATUM ? LEAST_EMISSIONS_A_STRATUM
                                                         : each);
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

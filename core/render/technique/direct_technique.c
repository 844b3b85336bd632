/*
 * Direct display of the photon map (technique direct).
 *
 * Estimates indirect light at a surface by the density of global photons at the place itself,
 * without rays. It is fast, and its errors are seen as they are.
 *
 * Estimator: with the photons i of flux F_i within radius r of x, on the surface of x,
 *   E_rest(x) = sum_i F_i / A(x, r)
 * where A is the area of the surface about x within r, less what walls cut off (footprint.h). The
 * radius is chosen at each place by comparing nested discs: it grows until the estimates differ by
 * more than their scatter (Lepski 1991). Beside walls and edges a fitted plane replaces the mean
 * (Jones 1993; adaptive_density.h). The map then has no photons of the light that shadow rays or
 * caustic photons count (omit.counted_light). In free space and outside no photon is stored, and a
 * hemisphere of rays reads the map elsewhere, as in gather_technique.c.
 *
 * Bias: in proportion to r^2 and to the curvature of the light over the disc: shadows and corners
 * are blurred. The choice of r limits it to about the scatter, a part of it is subtracted (bias
 * compensation, Schregle 2003), and what wider discs show of the remainder is reported. It
 * vanishes with more photons.
 *
 * Variance: relative to the square of E_rest about 1 / k for the k photons in the disc, at most
 * 2048. Neighbouring places share photons, so that noise is seen as patches.
 *
 * References: Jensen 2001, chapters 7 and 8 (radiance estimate, direct display); Schregle 2003;
 * Lepski 1991; Jones 1993 (adaptive_density.h has the full list); Grobe 2019.
 */
#include "render/technique/photon_maps.h"

static int init_density(struct orl_gather *gather, double widest, struct orl_thread_pool *pool,
                        struct orl_search *search)
{
    return orl_adaptive_density_init(&gather->adaptive, gather->maps[ORL_MAP_GLOBAL], widest, pool,
                                     search);
}

/* found and radius of the result are those of the photons. */
static struct orl_density estimate_density(const struct orl_gather *gather,
                                           const struct orl_surface_point *surface_point,
                                           struct orl_search *search)
{
    const struct orl_density_query query = {.point = surface_point->point,
                                            .normal = surface_point->normal,
                                            .k = ORL_ADAPTIVE_DENSITY_MOST,
                                            .max_radius = gather->adaptive.reach,
                                            .surface_point = surface_point};
    return orl_adaptive_density_estimate(&gather->adaptive, &query, search);
}

const struct orl_indirect_estimator orl_indirect_density = {.name = "density",
                                                            .map = ORL_MAP_GLOBAL,
                                                            .init = init_density,
                                                            .at_surface = estimate_density,
                                                            .at_hit = orl_gather_read_leaf};

const struct orl_technique_definition orl_direct_technique = {
    .facts = {.name = "direct",
              .alternative = ORL_TECHNIQUE_BACKWARD,
              .photons = ORL_PHOTONS_FOR_MAPS,
              .reads_map = {[ORL_MAP_GLOBAL] = true, [ORL_MAP_CAUSTIC] = true},
              .final_gather = ORL_GATHER_NOWHERE,
              .shows_map = true,
              .shows_density = true},
    .methods = &orl_photon_map_methods,
    .indirect = &orl_indirect_density};

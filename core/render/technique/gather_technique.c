/*
 * Final gather (technique gather; GCx in Grobe 2019).
 *
 * Estimates indirect light at a place as the mean of rays over its hemisphere. A ray that meets a
 * diffuse surface reads the density of global photons there, so that errors of the density are
 * averaged and not seen.
 *
 * Estimator: with N rays w_j from x, drawn by strategies s (n_s rays of density p_s),
 *   E_rest(x) = sum_j L(x, w_j) cos_j / sum_s n_s p_s(w_j)
 *   L(x, w)   = L_e(y) + rho(y) / pi E_g(y),  y: the first diffuse surface along w
 *   E_g(y)    = sum of the fluxes of the k photons nearest to y / area of their disc.
 * L_e is the radiance of skies, glows and lamps. Sensors draw rays by the cosine, towards patches
 * that photons show to be bright (photon_guiding.h), towards ports, and towards small mirrors and
 * lenses. The weights are the multi-sample balance heuristic (Veach 1997, section 9.2). Views
 * compute a stratified hemisphere at few places, with its gradients (Ward and Heckbert 1992), and
 * interpolate between these records (icache.h).
 *
 * Bias: that of E_g, averaged over the hemisphere: a kernel moves light by its radius. Where this
 * would show, in corners and between slats, the surface y is lit again by shadow rays, caustic
 * photons and one more ray, instead of by E_g. Views add the error of interpolation, at most in
 * proportion to ORL_ICACHE_ACCURACY. All vanish with more photons and smaller radii.
 *
 * Variance: the rays' falls faster than 1 / N, because they are stratified (Sobol points). The
 * photons' falls as one over their number, whatever N, and is common to all sensors; batches of
 * emissions measure it.
 *
 * References: Jensen 2001, chapters 8 and 9 (final gathering); Jensen 1995 (guiding by
 * photons); Ward and Heckbert 1992; Veach 1997; Grobe 2019.
 */
#include "render/technique/photon_maps.h"

/* Makes the patches that guide sensors' rays. */
static int init_guide(struct orl_gather *gather, double widest, struct orl_thread_pool *pool,
                      struct orl_search *search)
{
    (void)widest; /* only of searches */
    (void)search;
    return orl_photon_guide_init(&gather->guide, gather->maps[ORL_MAP_GLOBAL], pool);
}

const struct orl_indirect_estimator orl_indirect_gathered = {.name = "gathered",
                                                             .map = ORL_MAP_GLOBAL,
                                                             .gathered = true,
                                                             .init = init_guide,
                                                             .at_hit = orl_gather_read_leaf};

const struct orl_technique_definition orl_gather_technique = {
    .facts = {.name = "gather",
              .alternative = ORL_TECHNIQUE_BACKWARD,
              .photons = ORL_PHOTONS_FOR_MAPS,
              .reads_map = {[ORL_MAP_GLOBAL] = true, [ORL_MAP_CAUSTIC] = true},
              .final_gather = ORL_GATHER_EVERYWHERE},
    .methods = &orl_photon_map_methods,
    .indirect = &orl_indirect_gathered};

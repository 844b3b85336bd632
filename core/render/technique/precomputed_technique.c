/*
 * Precomputed irradiance (technique precomputed; xCP in Grobe 2019).
 *
 * Estimates indirect light at a surface from irradiance that was computed once, at a fraction of
 * the photons. Rendering reads these records, and not the global map that they were made of.
 *
 * Estimator: with the records i about x, of irradiance E_i and position x_i,
 *   E_rest(x) = a,  where (a, b) minimise sum_i w_i (E_i - a - b . (x_i - x))^2
 * is a local linear fit (Fan and Gijbels 1996). The weights w_i fall to zero at the nearest record
 * that is not used, and are 0 for records that are occluded from x. E_i is the estimate of
 * direct_technique.c at x_i. Rays of a hemisphere, which are averaged anyway, read the mean of the
 * nearest records instead. Where records differ much, in dark places beside lit ones, they do not
 * resolve the light: views then gather a hemisphere (lighting.h). So they do in free space and
 * outside, where there are no records.
 *
 * Bias: that of E_i, which the records store, and that of the fit: in proportion to the square of
 * the records' distance and to the curvature of the light. A fit instead of a mean keeps dark
 * places, where records are few, from taking the light of bright ones.
 *
 * Variance: about that of one E_i, because neighbouring records share most of their photons.
 *
 * References: Christensen 1999 (precomputed irradiance); Fan and Gijbels 1996, chapter 3; Grobe
 * 2019; photon/density/precomputed_irradiance.h has the records' format and how they are made.
 */
#include "photon/density/precomputed_irradiance.h"
#include "render/technique/photon_maps.h"

/* found of the result only says that there were records. */
static struct orl_density fit_records(const struct orl_gather *gather,
                                      const struct orl_surface_point *surface_point,
                                      struct orl_search *search)
{
    return orl_precomputed_estimate(gather->maps[ORL_MAP_PRECOMPUTED], surface_point,
                                    gather->max_radius[ORL_MAP_PRECOMPUTED], search);
}

/* Returns the irradiance that a ray reads; it is 0, and lit again, where the records do not
 * determine it. */
static struct orl_rgb read_records(const struct orl_gather *gather,
                                   const struct orl_surface_point *surface_point, bool roughly,
                                   bool *relit, struct orl_search *search, struct orl_tally *tally)
{
    const struct orl_photon_map *const map = gather->maps[ORL_MAP_PRECOMPUTED];
    struct orl_density records = {.found = 0};
    if (map && roughly)
        records = orl_precomputed_mean(map, surface_point, gather->max_radius[ORL_MAP_PRECOMPUTED],
                                       search);
    else if (map)
        records = fit_records(gather, surface_point, search);
    *relit = records.unreliable;
    if (*relit)
        return orl_gray(0);
    tally->parts[ORL_MAP_PRECOMPUTED] = records.parts;
    return records.irradiance;
}

const struct orl_indirect_estimator orl_indirect_records = {.name = "records",
                                                            .map = ORL_MAP_PRECOMPUTED,
                                                            .knows_spread = true,
                                                            .at_surface = fit_records,
                                                            .at_hit = read_records};

const struct orl_technique_definition orl_precomputed_technique = {
    .facts = {.name = "precomputed",
              .alternative = ORL_TECHNIQUE_BACKWARD,
              .photons = ORL_PHOTONS_FOR_MAPS,
              .reads_map = {[ORL_MAP_CAUSTIC] = true, [ORL_MAP_PRECOMPUTED] = true},
              .final_gather = ORL_GATHER_WHERE_DOUBTFUL,
              .shows_map = true},
    .methods = &orl_photon_map_methods,
    .indirect = &orl_indirect_records};

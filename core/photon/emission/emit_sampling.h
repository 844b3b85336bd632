/*
 * Sampling for emissions that pass no port: piecewise-constant distributions, which ports use, too;
 * a parallel beam as wide as the scene; importance maps of the open sky.
 */
#ifndef ORL_PHOTON_EMISSION_EMIT_SAMPLING_H
#define ORL_PHOTON_EMISSION_EMIT_SAMPLING_H

#include "photon/emission/emit.h"
#include "scene/geometry/geometry.h"

/*
 * Piecewise-constant distributions over the unit square: rows are sampled by their sums, then cells
 * in a row.
 */

/*
 * Makes the distribution from side_x * side_y values (row by row), mixed with floor_share of
 * uniform. Returns 0, or ORL_ERR_NOMEM, in which case the distribution is empty.
 */
int orl_distribution_2d_init(struct orl_distribution_2d *distribution, uint32_t side_x,
                             uint32_t side_y, const double *values, double floor_share);
void orl_distribution_2d_done(struct orl_distribution_2d *distribution);
uint64_t orl_distribution_2d_bytes(const struct orl_distribution_2d *distribution); /* its memory */

/* Samples a point of the square with two uniform numbers. Returns its pdf (1 for a uniform
 * distribution). */
double orl_distribution_2d_sample(const struct orl_distribution_2d *distribution, const double u[2],
                                  double ret_point[2]);

/* Samples the distribution for many pairs of numbers, as orl_distribution_2d_sample does for one;
 * fastest in groups of ORL_DISTRIBUTION_2D_LANES. */
enum { ORL_DISTRIBUTION_2D_LANES = 16 };
void orl_distribution_2d_sample_many(const struct orl_distribution_2d *distribution,
                                     const double (*u)[2], size_t n, double (*ret_points)[2],
                                     double *ret_pdfs);

/* A parallel beam as wide as the scene, in which distant light from one direction starts. */

/*
 * Samples a point on the faces of the scene's box that face the light, uniform by projected area.
 * Returns the projected area.
 */
double orl_parallel_beam_sample(const struct orl_geometry *geometry, struct orl_vec3 towards,
                                const double u[2], struct orl_vec3 *ret_point);

/*
 * Importance map for photons from the open sky. Over a city block all but a few photons would light
 * the ground and leave; the map sends more to where light stays. For each sun and each patch of the
 * dome it is a distribution over the scene's box. A pilot estimates for each cell the share of
 * paths that hit surfaces three times more. For caustic photons it is the share of light that is
 * deflected, by the first surface or behind panes. For virtual point lights the importance is the
 * square root of that share, blurred, because a light's contribution is either that share or zero.
 * A tenth of the photons is distributed uniformly, so that no light is lost.
 */

/* Builds the importance maps of an emission whose strata are listed. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_emission_importance_build(struct orl_emission *emission, uint64_t seed,
                                  struct orl_thread_pool *pool);
void orl_emission_importance_done(struct orl_emission *emission);
uint64_t orl_emission_importance_bytes(const struct orl_emission *emission); /* its memory */

/* Returns the mean importance of the dome's photons from that direction; 1 if there is no map. */
double orl_emission_importance_mean(const struct orl_emission *emission, struct orl_vec3 towards);

/* Returns the distribution for light from that direction; NULL if there is none. */
const struct orl_distribution_2d *orl_emission_importance_find(const struct orl_emission *emission,
                                                               const struct orl_stratum *stratum,
                                                               bool caustic,
                                                               struct orl_vec3 towards);

#endif

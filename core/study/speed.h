/*
 * Speed of the machine on which a study runs: rays per second that Embree intersects with the
 * study's scene, one at a time, on one thread. Seconds times that rate are ray-times, which can be
 * compared with other machines and other programs.
 *
 * The rays imitate light paths: from one surface to the next, with cosine-weighted directions.
 * Their order is random, so that neighbours are not coherent.
 */
#ifndef ORL_STUDY_SPEED_H
#define ORL_STUDY_SPEED_H

#include <oriel/job/study.h>

#include "scene/geometry/geometry.h"

/* Returns the median of runs, each with that many rays; NaN if no ray hits anything, or out of
 * memory. Ends early with an undefined result once *cancel is set; cancel may be NULL. */
enum { ORL_SPEED_MOST_RUNS = 9 };
double orl_ray_rate(const struct orl_geometry *geometry, size_t n_rays, int runs,
                    const atomic_bool *cancel, double (*now_s)(void *ctx), void *ctx);

/* Measures the rate of the request's scene in a fraction of a second. Errors are those of loading
 * the scene. */
int orl_study_measure_speed(const struct orl_study_request *request,
                            const struct orl_study_env *env, double *ret_rays_per_s,
                            struct orl_error *err);

#endif

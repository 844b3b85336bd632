/*
 * How fast the machine is where a study runs: single rays a second that Embree alone answers in the
 * study's scene, on one thread. Seconds times that rate are ray-times, which other machines and
 * other programs can be held against.
 *
 * Rays are as light takes them: from one surface to the next, cosine-weighted, in random order, so
 * that no two neighbours have anything in common.
 */
#ifndef ORL_STUDY_SPEED_H
#define ORL_STUDY_SPEED_H

#include <oriel/study.h>

#include "scene/geometry/geometry.h"

/* The median of runs, each of that many rays; NaN where no ray meets anything, or out of memory.
 * Ends early, with no meaning, once *cancel (which may be NULL) is set. */
enum { ORL_SPEED_MOST_RUNS = 9 };
double orl_ray_rate(const struct orl_geometry *geometry, size_t n_rays, int runs,
                    const atomic_bool *cancel, double (*now_s)(void *ctx), void *ctx);

/* The same of the request's scene, in a fraction of a second. Errors are those of loading it. */
int orl_study_measure_speed(const struct orl_study_request *request,
                            const struct orl_study_env *env, double *ret_rays_per_s,
                            struct orl_error *err);

#endif

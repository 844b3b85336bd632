/*
 * The planner: chooses the technique of a job, and the effects of light to simulate.
 *
 * The plan is a function of the job and the scene; only its seconds are estimates. Its inputs are
 * the content of the scene, rays towards features that matter and are easily missed, and a pilot of
 * about 1 % of the photons. Parts that are left out (suns, domes, emitters, ports) are missing from
 * the lit scene that is built from scene and lights, or are listed in its omissions. Higher layers
 * read the omissions.
 */
#ifndef ORL_PLAN_PLAN_H
#define ORL_PLAN_PLAN_H

#include <oriel/job/run.h>

#include "light/lit_scene.h"
#include "photon/shooting/shoot.h"

struct orl_plan_request {
    const struct orl_job *job; /* its own sensors are ignored in favour of `sensors` */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_thread_pool *pool;
    double (*now_s)(void *ctx); /* for the estimates of seconds */
    void *ctx;
};

/*
 * Makes the plan, and the lit scene to be simulated; scene and lights stay unchanged. Returns 0 and
 * a lit scene that the caller owns, or ORL_ERR_NOMEM.
 */
int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_lit_scene **ret_lit_scene,
                  struct orl_error *err);

/*
 * Chooses the number of caustic photons if the job does not give it, from the statistics of a pilot
 * (photon/shooting/shoot.h), and estimates the cost of a plan's photons.
 *
 * The weight of caustics is their share of the light times their contrast where they land. From 5 %
 * on they get as many photons as the global map. Below that they get fewer, in proportion, since
 * noise and blur of faint light are faint; but never so few that a kernel is empty. Their rays are
 * bounded relative to those of the global photons: 0.5 at no weight, 30 more at full weight, and in
 * between by the square of the weight. A second bound on their rays is half of the global ones,
 * plus the number for which the light where they land has the least error (Neyman 1934, Journal of
 * the Royal Statistical Society 97, 558). Beyond that, global photons improve the picture more. The
 * first bound, or a larger one if caustics outshine the other light there, also limits a job's
 * request, unless the job asks for an exact number.
 */

/* Requests up to this number do not justify the cost of a pilot. */
enum { ORL_FEW_PHOTONS = 5000 };

/* Returns true if the job asks for a number of caustic photons that a pilot may reduce. */
bool orl_plan_bounds_caustics(const struct orl_job *job);

/* Fills the plan's forecast. Sets its caustic photons if the job leaves them open, or asks for more
 * than pay off. */
void orl_plan_budget(const struct orl_job *job, const struct orl_photon_pilot *pilot,
                     struct orl_plan *plan);

#endif

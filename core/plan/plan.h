/*
 * The planner: chooses the technique of a job, and the effects of light to simulate.
 *
 * The plan is a function of the job and the scene; only its seconds are estimates. Its inputs are
 * the content of the scene, rays aimed at features that matter and are easily missed, and a pilot
 * of about 1 % of the photons. Parts that are left out (suns, domes, emitters, ports) are missing
 * from the world that is built from scene and lights, or are listed in that world's omissions.
 * Higher layers read the omissions.
 */
#ifndef ORL_PLAN_PLAN_H
#define ORL_PLAN_PLAN_H

#include <oriel/job/run.h>

#include "light/lit_scene.h"

struct orl_plan_request {
    const struct orl_job *job; /* its own sensors are ignored in favour of `sensors` */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_thread_pool *pool;
    double (*now_s)(void *ctx); /* for the estimates of seconds */
    void *ctx;
};

/*
 * Makes the plan, and the world to be simulated; scene and lights stay unchanged. Returns 0 and a
 * world that the caller owns, or ORL_ERR_NOMEM.
 */
int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_lit_scene **ret_lit_scene,
                  struct orl_error *err);

#endif

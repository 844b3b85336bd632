/*
 * The planner: which technique serves a job, and which effects of light it has to simulate.
 *
 * The plan is a function of the job and the scene; only its seconds are estimates. It is made from
 * what the scene holds, from rays aimed at what could matter and is easily missed, and from a pilot
 * of about 1 % of the photons. What it leaves out (suns, domes, emitters, ports) is not in the
 * world that it makes of scene and lights, or is among that world's omissions; everything above
 * reads those.
 */
#ifndef ORL_PLAN_PLAN_H
#define ORL_PLAN_PLAN_H

#include <oriel/run.h>

#include "light/world.h"

struct orl_plan_request {
    const struct orl_job *job; /* its own sensors are not looked at: */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_crew *crew;
    double (*now_s)(void *ctx); /* for the estimates of seconds */
    void *ctx;
};

/*
 * Makes the plan, and the world as it is to be simulated: scene and lights stay as they are.
 * Returns 0, and a world that the caller owns, or ORL_ERR_NOMEM.
 */
int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_world **ret_world, struct orl_error *err);

#endif

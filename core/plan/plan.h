/*
 * The planner: which technique serves a job, and which effects of light it has to simulate.
 *
 * The plan is a function of the job and the scene; only its seconds are estimates. It is made from
 * what the scene holds, from rays aimed at what could matter and is easily missed, and from a pilot
 * of about 1 % of the photons. It is put into effect by taking from the world what it leaves out
 * (suns, domes, emitters, ports) and by the world's omissions; everything above reads those.
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

/* Makes the plan and puts it into effect. Returns 0 or ORL_ERR_NOMEM. */
int orl_plan_make(const struct orl_plan_request *request, struct orl_world *world,
                  struct orl_plan *ret_plan, struct orl_error *err);

#endif

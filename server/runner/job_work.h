/*
 * How much work a job is, by what its document asks for: enough to tell what is worth a queue from
 * what is not, before its scene is loaded. Scenes differ by a factor of several.
 */
#ifndef ORL_SERVER_RUNNER_JOB_WORK_H
#define ORL_SERVER_RUNNER_JOB_WORK_H

#include <stdbool.h>

#include <oriel/plan.h>

#include "store/bundle.h"
#include "task_json.h"

/* Seconds of one core, above 0; 0: its document does not tell. bundle: the files it names. */
double orl_job_work_s(const struct orl_task *task, const struct orl_bundle *bundle);

/* Whether it goes in parts, and why so or not: least_s is the least work that is worth it. */
bool orl_job_goes_in_parts(const struct orl_task *task, const struct orl_bundle *bundle,
                           double least_s, char ret_why[ORL_WHY_MAX]);

#endif

/*
 * How much work a job is, by what its document asks for: enough to tell what is worth a queue from
 * what is not, before its scene is loaded. Scenes differ by a factor of several.
 */
#ifndef ORL_SERVER_RUNNER_JOB_WORK_H
#define ORL_SERVER_RUNNER_JOB_WORK_H

#include <stdbool.h>

#include <oriel/files.h>
#include <oriel/plan.h>

#include "task_json.h"

enum orl_job_way {
    ORL_WAY_WHOLE,    /* its kind is not done in parts */
    ORL_WAY_DEADLINE, /* nor are jobs for one */
    ORL_WAY_UNKNOWN,  /* its document does not tell how much it is */
    ORL_WAY_KNOWN,
    ORL_WAY_COUNT
};

struct orl_job_work {
    enum orl_job_way way;
    double s; /* where it is known: of one core */
};

/* files: those that it names. */
struct orl_job_work orl_job_work(const struct orl_task *task, const struct orl_files *files);

/* Whether it goes in parts, and why so or not: least_s is the least work that is worth it. */
bool orl_job_goes_in_parts(const struct orl_job_work *work, double least_s,
                           char ret_why[ORL_WHY_MAX]);

#endif

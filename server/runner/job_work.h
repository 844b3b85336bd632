/*
 * Estimate of a job's work from its document, before its scene is loaded. It decides if submitting
 * parts to a Slurm queue is worthwhile. Scenes differ by a factor of several.
 */
#ifndef ORL_SERVER_RUNNER_JOB_WORK_H
#define ORL_SERVER_RUNNER_JOB_WORK_H

#include <stdbool.h>

#include <oriel/files.h>
#include <oriel/plan.h>

#include "task_json.h"

enum orl_job_way {
    ORL_WAY_WHOLE,    /* this kind of job is not split into parts */
    ORL_WAY_DEADLINE, /* jobs with a deadline are not split either */
    ORL_WAY_UNKNOWN,  /* the document does not determine the work */
    ORL_WAY_KNOWN,
    ORL_WAY_COUNT
};

struct orl_job_work {
    enum orl_job_way way;
    double s; /* seconds of one core, for ORL_WAY_KNOWN */
};

/* Estimates the work. files: the files that the task names. */
struct orl_job_work orl_job_work(const struct orl_task *task, const struct orl_files *files);

/* Returns true if the job is split into parts; ret_why is the reason for either. least_s: the least
 * work that is worth splitting. */
bool orl_job_goes_in_parts(const struct orl_job_work *work, double least_s,
                           char ret_why[ORL_WHY_MAX]);

#endif

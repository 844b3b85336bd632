/*
 * Estimate of a job's work from its document, before its scene is loaded. It decides if submitting
 * parts to a Slurm queue is worthwhile. Scenes differ by a factor of several.
 */
#ifndef ORL_SERVER_RUNNER_ESTIMATE_JOB_WORK_H
#define ORL_SERVER_RUNNER_ESTIMATE_JOB_WORK_H

#include <stdbool.h>

#include <oriel/base/files.h>
#include <oriel/job/plan.h>

#include "job/job_request_json.h"

enum orl_job_work_class {
    ORL_WORK_INDIVISIBLE, /* this kind of job is not split into parts */
    ORL_WORK_DEADLINE,    /* jobs with a deadline are not split either */
    ORL_WORK_UNKNOWN,     /* the document does not determine the work */
    ORL_WORK_ESTIMATED,
    ORL_WORK_CLASS_COUNT
};

struct orl_job_work {
    enum orl_job_work_class work_class;
    double s; /* seconds of one core, for ORL_WORK_ESTIMATED */
};

/* Estimates the work. files: the files that the job request names. */
struct orl_job_work orl_job_work(const struct orl_job_request *job_request,
                                 const struct orl_files *files);

/* Returns true if the job is split into parts; ret_why is the reason for either. least_s: the least
 * work that is worth splitting. */
bool orl_job_is_split(const struct orl_job_work *work, double least_s, char ret_why[ORL_WHY_MAX]);

#endif

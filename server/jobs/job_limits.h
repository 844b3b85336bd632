/*
 * Bounds on jobs in time: how long a job may run, and how long and how many ended jobs are kept.
 * Internal to jobs.h; its rules apply.
 */
#ifndef ORL_SERVER_JOBS_JOB_LIMITS_H
#define ORL_SERVER_JOBS_JOB_LIMITS_H

#include "jobs/jobs.h"

/* Enforces the bounds; called about every second. Logs news of jobs' parts, and stops jobs that run
 * too long. Removes the oldest ended jobs that are too many or too old, a few at a time. Results
 * that were not fetched yet are spared, as from eviction (storage.h). */
void orl_jobs_enforce_limits(struct orl_jobs *jobs);

#endif

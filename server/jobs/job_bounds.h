/*
 * Bounds on jobs in time: how long a job may run, and how long and how many ended jobs are kept.
 * Internal to jobs.h; its rules apply.
 */
#ifndef ORL_SERVER_JOBS_JOB_BOUNDS_H
#define ORL_SERVER_JOBS_JOB_BOUNDS_H

#include "jobs/jobs.h"

/* Logs news of jobs' parts, stops jobs that run too long, and removes, a few at a time, the oldest
 * ended jobs that are too many or too old. Results that were not fetched yet are spared, as from
 * eviction (storage.h). Called about every second. */
void orl_jobs_bound(struct orl_jobs *jobs);

#endif

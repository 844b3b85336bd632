/*
 * Bounds on jobs in time: how long one may run, and how long and how many of those that have ended
 * are remembered. Inside of jobs.h, whose rules hold.
 */
#ifndef ORL_SERVER_JOBS_JOB_BOUNDS_H
#define ORL_SERVER_JOBS_JOB_BOUNDS_H

#include "jobs/jobs.h"

/* To be called every second or so: writes into the log what became of parts, has those stopped that
 * run too long, and removes, a few at a time, the oldest of those that have ended and are too many
 * or too old. Results that nobody has asked for yet are spared as from eviction (storage.h). */
void orl_jobs_bound(struct orl_jobs *jobs);

#endif

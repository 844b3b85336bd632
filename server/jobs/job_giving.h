/*
 * A computation's results for those who follow its leader, made on the pool: they may be thousands
 * of files. Inside of jobs.h, whose rules hold.
 *
 * Meanwhile the leader is `settling`: it neither ends nor is removed, and nobody joins it. Whoever
 * leaves it before the end gets nothing.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOB_GIVING_H
#define ORL_SERVER_JOBS_JOB_GIVING_H

#include "jobs/jobs.h"

struct orl_giving;

/* giving is valid during the call. */
typedef void orl_giving_done(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                             const struct orl_giving *giving);

/* done comes in a later turn of the loop, with a copy of outcome. False: nobody follows, or there
 * is no memory; it does not come then. */
bool orl_giving_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                      orl_giving_done *done);

/* What became of a job's share; of one that giving (may be NULL) does not know it is made now. */
int orl_giving_find(const struct orl_giving *giving, const struct orl_jobs_job *leader,
                    const struct orl_jobs_job *job, struct orl_error *ret_err);

#endif

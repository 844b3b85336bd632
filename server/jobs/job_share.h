/*
 * Identical jobs share one computation: the first leads, the others follow it, each with an id, a
 * state and results of its own.
 *
 * Jobs are identical when their documents ask for the same, whatever the order of members and the
 * priority. They share from when the second comes until the computation ends; a job that comes
 * later is computed anew. Who leads owns the place in the queue and the worker. A leader that is
 * cancelled while others follow goes on leading, cancelled, until the computation ends. What
 * is done by then belongs to the last of them that is cancelled; to those before it nothing.
 *
 * Threads: the loop thread only, but for the identity.
 */
#ifndef ORL_SERVER_JOBS_JOB_SHARE_H
#define ORL_SERVER_JOBS_JOB_SHARE_H

#include "jobs/jobs.h"

/* The digest of what a document asks for; "" when it cannot be told. Any thread. */
void orl_share_identity(const char *text, size_t size, char ret_identity[ORL_SHA_HEX]);

/* Lets job follow leader; takes it out again. */
void orl_share_follow(struct orl_jobs_job *leader, struct orl_jobs_job *job);
void orl_share_leave(struct orl_jobs_job *job);

/* Gives a job the results of another: links to the same files, in a folder of its own. */
int orl_share_results(const struct orl_folders *folders, const char *from, const char *to,
                      struct orl_error *err);

#endif

/*
 * Identical jobs share one computation: the first leads, the others follow it. Each has an id, a
 * state and results of its own.
 *
 * Jobs are identical if their documents ask for identical results, regardless of the order of
 * members and the priority. They share from the arrival of the second until the computation ends; a
 * job that arrives later is computed anew. The leader owns the place in the queue and the worker. A
 * leader that is cancelled while others follow still leads, as cancelled, until the computation
 * ends. Partial results go to the last job that is cancelled; jobs cancelled before it get none.
 *
 * Threads: the loop thread only, except for orl_dedup_identity.
 */
#ifndef ORL_SERVER_JOBS_JOB_DEDUP_H
#define ORL_SERVER_JOBS_JOB_DEDUP_H

#include "jobs/jobs.h"

/* Computes the digest of a document's request; "" if it cannot be computed. Any thread. */
void orl_dedup_identity(const char *text, size_t size, char ret_identity[ORL_SHA_HEX]);

/* follow: makes job a follower of leader. leave: takes it out again. */
void orl_dedup_follow(struct orl_jobs_job *leader, struct orl_jobs_job *job);
void orl_dedup_leave(struct orl_jobs_job *job);

/* Gives a job the results of another: links to the same files, in a folder of its own. */
int orl_dedup_link_results(const struct orl_folders *folders, const char *from, const char *to,
                           struct orl_error *err);

#endif

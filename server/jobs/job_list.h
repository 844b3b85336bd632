/*
 * The list of jobs: by age, by id, and counts by state. Also the functions of jobs.h that only read
 * jobs. Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOB_LIST_H
#define ORL_SERVER_JOBS_JOB_LIST_H

#include "jobs/jobs.h"

/* Adds a job as the newest one. */
void orl_job_list_add(struct orl_jobs *jobs, struct orl_jobs_job *job);
void orl_job_list_remove(struct orl_jobs *jobs, struct orl_jobs_job *job);

/* Gives the job copies of name and tags (NULL: none). ORL_ERR_NOMEM. */
int orl_job_set_labels(struct orl_jobs_job *job, const char *name, const char *tags);

/* Frees a job that is not in the list; NULL is allowed. */
void orl_job_free(struct orl_jobs_job *job);

#endif

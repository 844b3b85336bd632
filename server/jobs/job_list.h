/*
 * The jobs that there are: by age, by id, and how many of each state. What jobs.h tells of them
 * without changing any is here too. Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOB_LIST_H
#define ORL_SERVER_JOBS_JOB_LIST_H

#include "jobs/jobs.h"

/* As the newest one. */
void orl_job_list_add(struct orl_jobs *jobs, struct orl_jobs_job *job);
void orl_job_list_remove(struct orl_jobs *jobs, struct orl_jobs_job *job);

/* Gives it copies of name and tags (NULL: none). ORL_ERR_NOMEM. */
int orl_job_label(struct orl_jobs_job *job, const char *name, const char *tags);

/* One that is not in it; NULL is fine. */
void orl_job_free(struct orl_jobs_job *job);

#endif

/*
 * A job at a glance, for its events:
 *
 *     {"id", "state", "stage", "percent", "eta_s", "queue_position", "rounds", "views",
 *      "points", "cancelling"}
 *
 * stage, percent and eta_s as in job_status.h, of a study the run under way; queue_position while
 * it waits; rounds of a job with a goal, views of any other that are there to fetch, points
 * of a study while they run.
 */
#ifndef ORL_SERVER_RESOURCES_JOB_EVENT_H
#define ORL_SERVER_RESOURCES_JOB_EVENT_H

#include "jobs/jobs.h"

enum { ORL_JOB_EVENT_ID = 192 };

/* What the event shows, but for the ETA, in a word: equal when there is nothing new. Cheap. */
void orl_job_event_id(const struct orl_jobs *jobs, const struct orl_jobs_job *job,
                      char ret_id[ORL_JOB_EVENT_ID]);

/* A new reference; NULL when out of memory. */
json_t *orl_job_event(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

#endif

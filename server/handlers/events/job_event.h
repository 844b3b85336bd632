/*
 * Short form of a job's status, for its events:
 *
 *     {"id", "state", "stage", "percent", "eta_s", "queue_position", "rounds", "views",
 *      "points", "cancelling"}
 *
 * stage, percent and eta_s are as in job_status.h; in a study, of its current run. queue_position
 * is present while the job waits. While it runs there are rounds of a job with a goal, views of any
 * other job that can be fetched, and points of a study.
 */
#ifndef ORL_SERVER_HANDLERS_EVENTS_JOB_EVENT_H
#define ORL_SERVER_HANDLERS_EVENTS_JOB_EVENT_H

#include "jobs/jobs.h"

enum { ORL_JOB_EVENT_ID = 192 };

/* Writes an id of the event's contents without the ETA: equal ids mean no news. Cheap. */
void orl_job_event_id(const struct orl_jobs *jobs, const struct orl_jobs_job *job,
                      char ret_id[ORL_JOB_EVENT_ID]);

/* Returns a new reference; NULL when out of memory. */
json_t *orl_job_event(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

#endif

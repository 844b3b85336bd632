/*
 * Events of jobs: streams of one job (events.c), their contents (job_event.c), and the stream of
 * all jobs (event_broker.c).
 */
#ifndef ORL_SERVER_HANDLERS_EVENTS_EVENTS_H
#define ORL_SERVER_HANDLERS_EVENTS_EVENTS_H

#include "http/request/request.h"
#include "job/job_json.h"
#include "jobs/jobs.h"

/*
 * Streams of one job: GET /v1/jobs/{id}/events as server-sent events (WHATWG HTML, 9.2).
 *
 * An event is a short form of a job's status (orl_job_event), sent when it differs from the last
 * one. Its id encodes the contents. So a client that returns with a Last-Event-ID, even to another
 * daemon on the same data, gets only news. Nothing is replayed: the latest event says everything. A
 * stream (event_stream.h) ends after the job's final state.
 *
 * Only watched jobs are checked; streams of one job share the text of its event. A slow client
 * misses events, never part of one.
 *
 * Threads: the loop thread only.
 */

struct orl_events;

/* Opens the source of job events. Borrows server, whose jobs and http may be set later. */
int orl_events_open(struct orl_server *server, struct orl_events **ret_events,
                    struct orl_error *err);
/* Ends all streams and closes the timer in the loop's next turns. Call it before http stops. */
void orl_events_stop(struct orl_events *events); /* NULL is allowed */
/* Frees the source. Call it once the loop has ended and no response exists. */
void orl_events_free(struct orl_events *events);

/* Announces that a job may have changed. Call it anywhere on the loop thread, including in
 * handlers. */
void orl_events_wake(struct orl_events *events);

/* Announces that an ended job is removed. Its streams send its final state and end. */
void orl_events_job_removed(struct orl_events *events, const struct orl_jobs_job *job);

/* Returns the number of open streams. */
size_t orl_events_count(const struct orl_events *events);

/*
 * Returns a response that streams the job's events. last_id: the last event the client has seen, or
 * NULL. NULL when out of memory.
 */
struct MHD_Response *orl_events_stream(struct orl_events *events, struct orl_request *request,
                                       const struct orl_jobs_job *job, const char *last_id);

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

enum { ORL_JOB_EVENT_ID = 192 };

/* Writes an id of the event's contents without the ETA: equal ids mean no news. Cheap. */
void orl_job_event_id(const struct orl_jobs *jobs, const struct orl_jobs_job *job,
                      char ret_id[ORL_JOB_EVENT_ID]);

/* Returns a new reference; NULL when out of memory. */
json_t *orl_job_event(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

/*
 * Events of all jobs in one stream: GET /v1/events.
 *
 *     event: job        a JobSummary (job_status.h): the job is new, or has changed
 *     event: removed    {"id"}
 *     event: reset      {}: earlier events are not known here, so fetch all lists again
 *
 * The latest event of each job is kept, in order of arrival, up to ORL_SERVER_BROKER_EVENTS events
 * and ORL_SERVER_BROKER_BYTES. Ids are "<this daemon's start>-<serial>". A stream (event_stream.h)
 * is a place in that order: it costs a small struct regardless of its reader. A stream with a
 * Last-Event-ID continues after that event. It begins with a reset if the id is missing or another
 * daemon's, or if later events are no longer all kept. A reader so slow that its unread events are
 * dropped is cut off. Otherwise a slow reader misses only events that newer ones replace.
 *
 * Running jobs are checked while there are streams. Changes of state are recorded as they happen,
 * with or without streams.
 *
 * Threads: the loop thread only.
 */

struct orl_event_broker;

/* Selects the jobs of a stream. */
enum { ORL_EVENT_FILTER_JOBS = 16, ORL_EVENT_FILTER_TAGS = 4 };
struct orl_event_filter {
    char jobs[ORL_EVENT_FILTER_JOBS]
             [ORL_JOB_ID]; /* any of these, by their first digits; none: all jobs */
    char tags[ORL_EVENT_FILTER_TAGS][4 * ORL_LABEL_TAG + 1]; /* all of these tags */
    size_t n_jobs, n_tags;
};

/* Opens the event broker. Borrows server, whose jobs and http may be set later. */
int orl_event_broker_open(struct orl_server *server, struct orl_event_broker **ret_broker,
                          struct orl_error *err);
/* Ends all streams and closes the timer in the loop's next turns. Call it before http stops. */
void orl_event_broker_stop(struct orl_event_broker *broker); /* NULL is allowed */
/* Frees the event broker. Call it once the loop has ended and no response exists. */
void orl_event_broker_free(struct orl_event_broker *broker);

/* job_changed: announces that the job is new or has changed. job_removed: announces that it is
 * about to be removed. */
void orl_event_broker_job_changed(struct orl_event_broker *broker, const struct orl_jobs_job *job);
void orl_event_broker_job_removed(struct orl_event_broker *broker, const struct orl_jobs_job *job);

/* Returns the number of open streams. */
size_t orl_event_broker_count(const struct orl_event_broker *broker);

/* Returns a response that streams the jobs of filter. last_id: the last event the client has seen,
 * or NULL. NULL when out of memory. */
struct MHD_Response *orl_event_broker_stream(struct orl_event_broker *broker,
                                             struct orl_request *request,
                                             const struct orl_event_filter *filter,
                                             const char *last_id);

#endif

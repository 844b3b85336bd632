/*
 * Events of all jobs in one stream: GET /v1/events.
 *
 *     event: job        a JobSummary (job_summary.h): the job is new, or has changed
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
#ifndef ORL_SERVER_HANDLERS_EVENTS_EVENT_BROKER_H
#define ORL_SERVER_HANDLERS_EVENTS_EVENT_BROKER_H

#include "http/request/request.h"
#include "job/labels_json.h"
#include "jobs/jobs.h"

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

/* changed: announces that the job is new or has changed. forget: announces that it is about to be
 * removed. */
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

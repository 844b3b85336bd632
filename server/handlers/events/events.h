/*
 * Event streams: GET /v1/jobs/{id}/events as server-sent events (WHATWG HTML, 9.2).
 *
 * An event is a short form of a job's status (job_event.h), sent when it differs from the last one.
 * Its id encodes the contents. So a client that returns with a Last-Event-ID, even to another
 * daemon on the same data, gets only news. Nothing is replayed: the latest event says everything. A
 * stream (event_stream.h) ends after the job's final state.
 *
 * Only watched jobs are checked; streams of one job share the text of its event. A slow client
 * misses events, never part of one.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HANDLERS_EVENTS_EVENTS_H
#define ORL_SERVER_HANDLERS_EVENTS_EVENTS_H

#include "http/request/request.h"
#include "jobs/jobs.h"

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

#endif

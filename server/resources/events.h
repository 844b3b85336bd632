/*
 * Event streams: GET /v1/jobs/{id}/events as server-sent events (WHATWG HTML, 9.2).
 *
 * An event is a job at a glance (job_event.h), sent when it differs from the last; its id
 * says what it shows, so that a client that comes back with a Last-Event-ID, even to another
 * daemon on the same data, is told only what is new to it. Nothing is replayed: the latest says
 * all. A stream (event_stream.h) ends after the job's final state.
 *
 * Looked at are the jobs that somebody watches; streams of one job share the text of its event. A
 * slow client misses events, never part of one.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_RESOURCES_EVENTS_H
#define ORL_SERVER_RESOURCES_EVENTS_H

#include "http/request.h"
#include "jobs/jobs.h"

struct orl_events;

/* Borrows server, whose jobs and http may come later. */
int orl_events_open(struct orl_server *server, struct orl_events **ret_events,
                    struct orl_error *err);
/* Ends all streams and closes the timer with the loop's next turns. Before http stops. */
void orl_events_stop(struct orl_events *events); /* NULL is allowed */
/* Once the loop has run dry and no response lives. */
void orl_events_free(struct orl_events *events);

/* A job may have changed. From anywhere on the loop thread, handlers included. */
void orl_events_wake(struct orl_events *events);

/* A job that has ended is removed: who watches it is told how it ended, and no more. */
void orl_events_forget(struct orl_events *events, const struct orl_jobs_job *job);

/* How many streams are open. */
size_t orl_events_count(const struct orl_events *events);

/*
 * A response that streams the job's events; last_id is what the client has seen, or NULL. NULL when
 * out of memory.
 */
struct MHD_Response *orl_events_stream(struct orl_events *events, struct orl_request *request,
                                       const struct orl_jobs_job *job, const char *last_id);

#endif

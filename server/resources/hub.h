/*
 * Events of all jobs in one stream: GET /v1/events.
 *
 *     event: job        a JobSummary (job_summary.h): it is new, or differs from the last one
 *     event: removed    {"id"}
 *     event: reset      {}: what was before is not known here, so that lists are to be asked for
 * anew
 *
 * Of each job the latest event is kept, up to ORL_SERVER_HUB_EVENTS of them and
 * ORL_SERVER_HUB_BYTES, in the order they came; ids are "<this daemon's start>-<serial>". A stream
 * (event_stream.h) is a place in that order: it costs a small struct whatever its reader does. One
 * that comes back with a Last-Event-ID goes on behind it; where that was another daemon's, or what
 * came since is not all kept, and with none, it begins with a reset. A reader so slow that what it
 * has yet to read is let go is cut off. A slow one misses what newer events say better.
 *
 * Jobs that run are looked at while there are streams; changes of state are noted as they happen,
 * with or without.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_RESOURCES_HUB_H
#define ORL_SERVER_RESOURCES_HUB_H

#include "http/request.h"
#include "jobs/jobs.h"
#include "labels_json.h"

struct orl_hub;

/* What a stream is about. */
enum { ORL_HUB_JOBS = 16, ORL_HUB_TAGS = 4 };
struct orl_hub_filter {
    char jobs[ORL_HUB_JOBS][ORL_JOB_ID]; /* any of them, by their first digits; none: all */
    char tags[ORL_HUB_TAGS][4 * ORL_LABEL_TAG + 1]; /* all of them */
    size_t n_jobs, n_tags;
};

/* Borrows server, whose jobs and http may come later. */
int orl_hub_open(struct orl_server *server, struct orl_hub **ret_hub, struct orl_error *err);
/* Ends all streams and closes the timer with the loop's next turns. Before http stops. */
void orl_hub_stop(struct orl_hub *hub); /* NULL is allowed */
/* Once the loop has run dry and no response lives. */
void orl_hub_free(struct orl_hub *hub);

/* The job is new, or is not what it was; it is about to be removed. */
void orl_hub_changed(struct orl_hub *hub, const struct orl_jobs_job *job);
void orl_hub_forget(struct orl_hub *hub, const struct orl_jobs_job *job);

/* How many streams are open. */
size_t orl_hub_count(const struct orl_hub *hub);

/* A response that streams what filter wants; last_id is what the client has seen, or NULL. NULL
 * when out of memory. */
struct MHD_Response *orl_hub_stream(struct orl_hub *hub, struct orl_request *request,
                                    const struct orl_hub_filter *filter, const char *last_id);

#endif

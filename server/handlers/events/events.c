#include "handlers/events/events.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handlers/events/event_stream.h"
#include "server.h"

/* A watched job. */
struct feed {
    const struct orl_jobs_job *job; /* NULL: the job has ended and been removed */
    char id[ORL_JOB_EVENT_ID];
    struct orl_event_text *latest;
    uint64_t serial; /* serial number of latest */
    bool final;
    size_t n_streams;
    struct feed *next;
};

struct stream {
    struct orl_event_stream base;
    struct orl_events *events;
    struct feed *feed;
    uint64_t serial; /* last event whose sending has begun */
};

struct orl_events {
    struct orl_event_source source;
    struct feed *feeds;
};

/* ---- Feeds ---------------------------------------------------------------------------------- */

/* Checks the job. Returns true if there is a new event. */
static bool refresh_feed(const struct orl_events *events, struct feed *feed)
{
    const struct orl_jobs *jobs = events->source.server->jobs;
    char id[ORL_JOB_EVENT_ID];
    if (!feed->job)
        return false;
    orl_job_event_id(jobs, feed->job, id);
    if (feed->latest && strcmp(id, feed->id) == 0)
        return false;
    struct orl_event_text *text = orl_event_text_of(id, "status", orl_job_event(jobs, feed->job));
    if (!text)
        return false; /* the next check tries again */
    orl_event_text_unref(feed->latest);
    feed->latest = text;
    feed->serial++;
    feed->final = feed->job->row.state >= ORL_JOB_SUCCEEDED;
    snprintf(feed->id, sizeof feed->id, "%s", id);
    return true;
}

static struct feed *find_feed(struct orl_events *events, const struct orl_jobs_job *job)
{
    struct feed *feed = events->feeds;
    while (feed && feed->job != job)
        feed = feed->next;
    if (feed)
        return feed;
    feed = calloc(1, sizeof *feed);
    if (!feed)
        return NULL;
    feed->job = job;
    feed->next = events->feeds;
    events->feeds = feed;
    return feed;
}

static void drop_feed(struct orl_events *events, struct feed *feed)
{
    struct feed **at = &events->feeds;
    while (*at != feed)
        at = &(*at)->next;
    *at = feed->next;
    orl_event_text_unref(feed->latest);
    free(feed);
}

void orl_events_wake(struct orl_events *events)
{
    if (events)
        orl_event_source_wake(&events->source);
}

void orl_events_job_removed(struct orl_events *events, const struct orl_jobs_job *job)
{
    struct feed *feed = events->feeds;
    while (feed && feed->job != job)
        feed = feed->next;
    if (!feed)
        return;
    refresh_feed(events, feed);
    feed->job = NULL;
    feed->final = true;
    orl_events_wake(events);
}

/* ---- Streams -------------------------------------------------------------------------------- */

static void refresh_feeds(struct orl_event_source *source)
{
    struct orl_events *events = (struct orl_events *)source;
    for (struct feed *feed = events->feeds; feed; feed = feed->next)
        refresh_feed(events, feed);
}

static bool has_news(const struct orl_event_stream *base)
{
    const struct stream *stream = (const struct stream *)base;
    return stream->serial != stream->feed->serial || !stream->feed->job;
}

static bool next_text(struct orl_event_stream *base, struct orl_event_text **ret_text)
{
    struct stream *stream = (struct stream *)base;
    const struct feed *feed = stream->feed;
    if (stream->serial == feed->serial)
        return !feed->final && !base->source->stopping;
    stream->serial = feed->serial;
    *ret_text = feed->latest;
    feed->latest->refs++;
    return true;
}

static void free_stream(struct orl_event_stream *base)
{
    struct stream *stream = (struct stream *)base;
    if (--stream->feed->n_streams == 0)
        drop_feed(stream->events, stream->feed);
    free(stream);
}

struct MHD_Response *orl_events_stream(struct orl_events *events, struct orl_request *request,
                                       const struct orl_jobs_job *job, const char *last_id)
{
    struct stream *stream = calloc(1, sizeof *stream);
    struct feed *feed = stream ? find_feed(events, job) : NULL;
    if (!feed) {
        free(stream);
        return NULL;
    }
    feed->n_streams++;
    refresh_feed(events, feed);
    stream->events = events;
    stream->feed = feed;
    if (last_id && strcmp(last_id, feed->id) == 0)
        stream->serial = feed->serial;
    return orl_event_stream_open(&events->source, &stream->base, request);
}

size_t orl_events_count(const struct orl_events *events)
{
    return events->source.count;
}

/* ---- Start and end -------------------------------------------------------------------------- */

int orl_events_open(struct orl_server *server, struct orl_events **ret_events,
                    struct orl_error *err)
{
    static const struct orl_event_calls calls = {refresh_feeds, has_news, next_text, free_stream};
    struct orl_events *events = calloc(1, sizeof *events);
    if (!events)
        return orl_error_no_memory(err);
    const int rc = orl_event_source_init(&events->source, server, &calls, err);
    if (rc)
        free(events);
    else
        *ret_events = events;
    return rc;
}

void orl_events_stop(struct orl_events *events)
{
    if (!events || events->source.stopping)
        return;
    refresh_feeds(&events->source);
    orl_event_source_stop(&events->source);
}

void orl_events_free(struct orl_events *events)
{
    if (!events)
        return;
    orl_event_source_done(&events->source);
    free(events);
}

#include "resources/events.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/http.h"
#include "process/times.h"
#include "resources/event_text.h"
#include "resources/job_event.h"
#include "server.h"

enum { LOOK_MS = 250, HEARTBEAT_S = 15 };

/* A job that somebody watches. */
struct feed {
    const struct orl_jobs_job *job; /* NULL: it has ended and been removed */
    char id[ORL_JOB_EVENT_ID];
    struct orl_event_text *latest;
    uint64_t serial; /* of latest */
    bool final;
    struct stream *streams;
    struct feed *next;
};

struct stream {
    struct orl_events *events;
    struct feed *feed;
    struct MHD_Connection *connection;
    struct orl_client *client; /* counted there; or NULL */
    struct orl_event_text *sending;
    size_t sent;     /* of it */
    uint64_t serial; /* of the last event begun */
    double active_s; /* when something was last begun */
    bool suspended, beat;
    struct stream *next, **link;
};

struct orl_events {
    struct orl_server *server;
    uv_timer_t timer;
    struct feed *feeds;
    struct orl_event_text *heartbeat;
    double heartbeat_s;
    size_t count;
    bool stopping;
};

/* ---- Feeds ---------------------------------------------------------------------------------- */

/* Looks at the job. True when there is an event that was not there before. */
static bool refresh(const struct orl_events *events, struct feed *feed)
{
    const struct orl_jobs *jobs = events->server->jobs;
    char id[ORL_JOB_EVENT_ID];
    if (!feed->job)
        return false;
    orl_job_event_id(jobs, feed->job, id);
    if (feed->latest && strcmp(id, feed->id) == 0)
        return false;
    struct orl_event_text *text = orl_event_text_of(id, "status", orl_job_event(jobs, feed->job));
    if (!text)
        return false; /* the next look tries again */
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

/* ---- The timer ------------------------------------------------------------------------------ */

static void resume(struct stream *stream)
{
    if (!stream->suspended)
        return;
    stream->suspended = false;
    MHD_resume_connection(stream->connection);
}

static void look(uv_timer_t *timer)
{
    struct orl_events *events = timer->data;
    const double now_s = orl_time_steady_s();
    for (struct feed *feed = events->feeds; feed; feed = feed->next) {
        const bool fresh = refresh(events, feed);
        for (struct stream *stream = feed->streams; stream; stream = stream->next) {
            stream->beat = now_s - stream->active_s >= events->heartbeat_s;
            if (fresh || stream->beat || !feed->job)
                resume(stream);
        }
    }
    if (!events->feeds)
        uv_timer_stop(timer);
    orl_http_kick(events->server->http);
}

void orl_events_wake(struct orl_events *events)
{
    if (events && events->feeds && !events->stopping)
        uv_timer_start(&events->timer, look, 0, LOOK_MS);
}

void orl_events_forget(struct orl_events *events, const struct orl_jobs_job *job)
{
    struct feed *feed = events->feeds;
    while (feed && feed->job != job)
        feed = feed->next;
    if (!feed)
        return;
    refresh(events, feed);
    feed->job = NULL;
    feed->final = true;
    orl_events_wake(events);
}

/* ---- Streams -------------------------------------------------------------------------------- */

/* What the stream is to send now, if anything. */
static struct orl_event_text *next_text(struct stream *stream)
{
    const struct feed *feed = stream->feed;
    if (stream->serial != feed->serial) {
        stream->serial = feed->serial;
        return feed->latest;
    }
    return stream->beat ? stream->events->heartbeat : NULL;
}

/* MHD's: fills buffer; without anything to say the connection sleeps until look wakes it. */
static ssize_t read_stream(void *ctx, uint64_t position, char *buffer, size_t max)
{
    struct stream *stream = ctx;
    (void)position;
    if (!stream->sending) {
        stream->sending = next_text(stream);
        if (!stream->sending && (stream->feed->final || stream->events->stopping))
            return MHD_CONTENT_READER_END_OF_STREAM;
        if (!stream->sending) {
            stream->suspended = true;
            MHD_suspend_connection(stream->connection);
            return 0;
        }
        stream->sending->refs++;
        stream->sent = 0;
        stream->beat = false;
        stream->active_s = orl_time_steady_s();
    }
    const size_t left = stream->sending->size - stream->sent, size = left < max ? left : max;
    memcpy(buffer, stream->sending->data + stream->sent, size);
    stream->sent += size;
    if (stream->sent == stream->sending->size) {
        orl_event_text_unref(stream->sending);
        stream->sending = NULL;
    }
    return (ssize_t)size;
}

static void free_stream(void *ctx)
{
    struct stream *stream = ctx;
    struct feed *feed = stream->feed;
    *stream->link = stream->next;
    if (stream->next)
        stream->next->link = stream->link;
    stream->events->count--;
    if (stream->client)
        stream->client->streams--;
    orl_client_unref(&stream->events->server->context.clients, stream->client);
    orl_event_text_unref(stream->sending);
    if (!feed->streams)
        drop_feed(stream->events, feed);
    free(stream);
}

static struct stream *new_stream(struct orl_events *events, struct orl_request *request,
                                 const struct orl_jobs_job *job)
{
    struct stream *stream = calloc(1, sizeof *stream);
    struct feed *feed = stream ? find_feed(events, job) : NULL;
    if (!feed) {
        free(stream);
        return NULL;
    }
    *stream = (struct stream){.events = events,
                              .feed = feed,
                              .connection = request->connection,
                              .client = orl_client_ref(request),
                              .active_s = orl_time_steady_s(),
                              .next = feed->streams,
                              .link = &feed->streams};
    if (feed->streams)
        feed->streams->link = &stream->next;
    feed->streams = stream;
    events->count++;
    if (stream->client)
        stream->client->streams++;
    return stream;
}

struct MHD_Response *orl_events_stream(struct orl_events *events, struct orl_request *request,
                                       const struct orl_jobs_job *job, const char *last_id)
{
    enum { BLOCK = 1024 };
    struct stream *stream = new_stream(events, request, job);
    if (!stream)
        return NULL;
    refresh(events, stream->feed);
    if (last_id && strcmp(last_id, stream->feed->id) == 0)
        stream->serial = stream->feed->serial;
    struct MHD_Response *response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, BLOCK, read_stream, stream, free_stream);
    if (!response)
        free_stream(stream);
    else if (!uv_is_active((const uv_handle_t *)&events->timer))
        uv_timer_start(&events->timer, look, LOOK_MS, LOOK_MS);
    return response;
}

size_t orl_events_count(const struct orl_events *events)
{
    return events->count;
}

/* ---- Start and end -------------------------------------------------------------------------- */

int orl_events_open(struct orl_server *server, struct orl_events **ret_events,
                    struct orl_error *err)
{
    struct orl_events *events = calloc(1, sizeof *events);
    if (events)
        events->heartbeat = orl_event_text_new(":\n\n", 3);
    if (!events || !events->heartbeat) {
        free(events);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    /* Well before whoever is as impatient as this daemon is gives a stream up. */
    const double half_s = server->config.idle_timeout_s / 2.0;
    events->heartbeat_s = half_s < HEARTBEAT_S ? half_s : HEARTBEAT_S;
    events->server = server;
    uv_timer_init(&server->loop, &events->timer);
    events->timer.data = events;
    *ret_events = events;
    return 0;
}

void orl_events_stop(struct orl_events *events)
{
    if (!events || events->stopping)
        return;
    events->stopping = true;
    for (struct feed *feed = events->feeds; feed; feed = feed->next) {
        refresh(events, feed);
        for (struct stream *stream = feed->streams; stream; stream = stream->next)
            resume(stream);
    }
    orl_http_kick(events->server->http);
    uv_close((uv_handle_t *)&events->timer, NULL);
}

void orl_events_free(struct orl_events *events)
{
    if (!events)
        return;
    orl_event_text_unref(events->heartbeat);
    free(events);
}

#include "handlers/events/event_stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/http_server.h"
#include "process/times.h"
#include "server.h"
#include "json/encode.h"

/* Returns a text with one reference. NULL when out of memory. */
static struct orl_event_text *new_text(const char *data, size_t size)
{
    struct orl_event_text *text = malloc(sizeof *text + size);
    if (!text)
        return NULL;
    text->refs = 1;
    text->size = size;
    memcpy(text->data, data, size);
    return text;
}

void orl_event_text_unref(struct orl_event_text *text)
{
    if (text && --text->refs == 0)
        free(text);
}

struct orl_event_text *orl_event_text_of(const char *id, const char *name, json_t *data)
{
    char *json = orl_json_text(data, JSON_COMPACT | JSON_REAL_PRECISION(6));
    struct orl_event_text *text = NULL;
    char *line = NULL;
    const int size = json ? asprintf(&line, "id: %s\nevent: %s\ndata: %s\n\n", id, name, json) : -1;
    if (size > 0)
        text = new_text(line, (size_t)size);
    if (size >= 0)
        free(line);
    free(json);
    json_decref(data);
    return text;
}

enum { POLL_MS = 250, HEARTBEAT_S = 15, CREDENTIALS_S = 5 };

/* ---- The timer ------------------------------------------------------------------------------ */

static void resume_stream(struct orl_event_stream *stream)
{
    if (!stream->suspended)
        return;
    stream->suspended = false;
    MHD_resume_connection(stream->connection);
}

/* Ends the stream if the token or session that admitted it has ended. */
static void check_credentials(struct orl_event_stream *stream, double now_s)
{
    if (now_s - stream->checked_s < CREDENTIALS_S)
        return;
    stream->checked_s = now_s;
    stream->ended = !orl_access_is_valid(&stream->source->server->context, &stream->credentials);
}

static void poll_streams(uv_timer_t *timer)
{
    struct orl_event_source *source = timer->data;
    const double now_s = orl_time_steady_s();
    source->calls->poll(source);
    for (struct orl_event_stream *stream = source->streams; stream; stream = stream->next) {
        stream->heartbeat_due = now_s - stream->active_s >= source->heartbeat_s;
        check_credentials(stream, now_s);
        if (stream->heartbeat_due || stream->ended || source->calls->has_news(stream))
            resume_stream(stream);
    }
    if (!source->streams)
        uv_timer_stop(timer);
    orl_http_kick(source->server->http);
}

void orl_event_source_wake(struct orl_event_source *source)
{
    if (source->streams && !source->stopping)
        uv_timer_start(&source->timer, poll_streams, 0, POLL_MS);
}

/* ---- Streams -------------------------------------------------------------------------------- */

/* MHD's content reader: fills buffer. If there is no news, it suspends the connection until
 * poll_streams resumes it. */
static ssize_t read_stream(void *ctx, uint64_t position, char *buffer, size_t max)
{
    struct orl_event_stream *stream = ctx;
    struct orl_event_source *source = stream->source;
    (void)position;
    if (!stream->sending) {
        if (stream->ended || !source->calls->next(stream, &stream->sending))
            return MHD_CONTENT_READER_END_OF_STREAM;
        if (!stream->sending && stream->heartbeat_due) {
            stream->sending = source->heartbeat;
            stream->sending->refs++;
        }
        if (!stream->sending) {
            stream->suspended = true;
            MHD_suspend_connection(stream->connection);
            return 0;
        }
        stream->sent = 0;
        stream->heartbeat_due = false;
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
    struct orl_event_stream *stream = ctx;
    struct orl_event_source *source = stream->source;
    *stream->link = stream->next;
    if (stream->next)
        stream->next->link = stream->link;
    source->count--;
    if (stream->client)
        stream->client->streams--;
    orl_client_unref(&source->server->context.clients, stream->client);
    orl_event_text_unref(stream->sending);
    source->calls->free(stream);
}

struct MHD_Response *orl_event_stream_open(struct orl_event_source *source,
                                           struct orl_event_stream *stream,
                                           struct orl_request *request)
{
    enum { BLOCK = 1024 };
    const double now_s = orl_time_steady_s();
    *stream = (struct orl_event_stream){.source = source,
                                        .connection = request->connection,
                                        .client = orl_client_ref(request),
                                        .credentials = orl_access_credentials(request),
                                        .checked_s = now_s,
                                        .active_s = now_s,
                                        .next = source->streams,
                                        .link = &source->streams};
    if (source->streams)
        source->streams->link = &stream->next;
    source->streams = stream;
    source->count++;
    if (stream->client)
        stream->client->streams++;
    struct MHD_Response *response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, BLOCK, read_stream, stream, free_stream);
    if (!response)
        free_stream(stream);
    else if (!uv_is_active((const uv_handle_t *)&source->timer))
        uv_timer_start(&source->timer, poll_streams, POLL_MS, POLL_MS);
    return response;
}

/* ---- Start and end -------------------------------------------------------------------------- */

int orl_event_source_init(struct orl_event_source *source, struct orl_server *server,
                          const struct orl_event_calls *calls, struct orl_error *err)
{
    /* Send heartbeats well before a proxy with this daemon's idle timeout closes a stream. */
    const double half_s = server->config.idle_timeout_s / 2.0;
    *source = (struct orl_event_source){.server = server,
                                        .calls = calls,
                                        .heartbeat = new_text(":\n\n", 3),
                                        .heartbeat_s = half_s < HEARTBEAT_S ? half_s : HEARTBEAT_S};
    if (!source->heartbeat)
        return orl_error_no_memory(err);
    uv_timer_init(&server->loop, &source->timer);
    source->timer.data = source;
    return 0;
}

void orl_event_source_done(struct orl_event_source *source)
{
    orl_event_text_unref(source->heartbeat);
}

void orl_event_source_stop(struct orl_event_source *source)
{
    source->stopping = true;
    for (struct orl_event_stream *stream = source->streams; stream; stream = stream->next)
        resume_stream(stream);
    orl_http_kick(source->server->http);
    uv_close((uv_handle_t *)&source->timer, NULL);
}

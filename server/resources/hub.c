#include "resources/hub.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/http.h"
#include "process/limits.h"
#include "process/times.h"
#include "resources/event_text.h"
#include "resources/job_event.h"
#include "resources/job_summary.h"
#include "server.h"

enum { LOOK_MS = 250, HEARTBEAT_S = 15, ID = 48 };

/* The latest event of a job. */
struct event {
    uint64_t serial;
    char job[ORL_JOB_ID];
    char *tags;                  /* labels_json.h; NULL: none */
    char seen[ORL_JOB_EVENT_ID]; /* what it shows, while the job runs */
    struct orl_event_text *text;
    struct event *older, *newer;
};

struct stream {
    struct orl_hub *hub;
    struct MHD_Connection *connection;
    struct orl_client *client; /* counted there; or NULL */
    struct orl_hub_filter filter;
    struct orl_event_text *sending;
    size_t sent;     /* of it */
    uint64_t serial; /* of the last event begun or passed over */
    double active_s; /* when something was last begun */
    bool suspended, beat, reset;
    struct stream *next, **link;
};

struct orl_hub {
    struct orl_server *server;
    uv_timer_t timer;
    char start[17]; /* told apart from others by it */
    struct event *oldest, *newest;
    size_t count, bytes;
    uint64_t serial, let_go; /* of the newest there was; of the newest that is kept no more */
    struct orl_event_text *heartbeat;
    double heartbeat_s;
    struct stream *streams;
    size_t n_streams;
    bool stopping;
};

/* ---- Events --------------------------------------------------------------------------------- */

static void unlink_event(struct orl_hub *hub, struct event *event)
{
    if (event->older)
        event->older->newer = event->newer;
    else
        hub->oldest = event->newer;
    if (event->newer)
        event->newer->older = event->older;
    else
        hub->newest = event->older;
    hub->count--;
    hub->bytes -= event->text ? event->text->size : 0;
}

static void free_event(struct event *event)
{
    orl_event_text_unref(event->text);
    free(event->tags);
    free(event);
}

static void append(struct orl_hub *hub, struct event *event)
{
    event->older = hub->newest;
    event->newer = NULL;
    if (hub->newest)
        hub->newest->newer = event;
    else
        hub->oldest = event;
    hub->newest = event;
    hub->count++;
    hub->bytes += event->text ? event->text->size : 0;
}

/* Never the newest. */
static void bound(struct orl_hub *hub)
{
    struct event *event = hub->oldest;
    while (event && event->newer &&
           (hub->count > ORL_SERVER_HUB_EVENTS || hub->bytes > ORL_SERVER_HUB_BYTES)) {
        struct event *newer = event->newer;
        hub->let_go = event->serial;
        hub->count--;
        hub->bytes -= event->text ? event->text->size : 0;
        free_event(event);
        newer->older = NULL;
        hub->oldest = newer;
        event = newer;
    }
}

static struct event *find(const struct orl_hub *hub, const char *job)
{
    struct event *event = hub->newest;
    while (event && strcmp(event->job, job) != 0)
        event = event->older;
    return event;
}

/* The job's event, out of the order; NULL when out of memory. */
static struct event *take_event(struct orl_hub *hub, const struct orl_jobs_job *job)
{
    struct event *event = find(hub, job->row.id);
    if (event) {
        unlink_event(hub, event);
        return event;
    }
    event = calloc(1, sizeof *event);
    if (!event)
        return NULL;
    snprintf(event->job, sizeof event->job, "%s", job->row.id);
    event->tags = job->row.tags ? strdup(job->row.tags) : NULL;
    if (!event->tags && job->row.tags) {
        free(event);
        return NULL;
    }
    return event;
}

static void name_event(const struct orl_hub *hub, uint64_t serial, char ret_id[ID])
{
    snprintf(ret_id, ID, "%s-%llu", hub->start, (unsigned long long)serial);
}

/* Takes data. Whoever has no memory for it is told to ask anew. */
static void note(struct orl_hub *hub, const struct orl_jobs_job *job, const char *name,
                 json_t *data)
{
    char id[ID];
    struct event *event = take_event(hub, job);
    name_event(hub, ++hub->serial, id);
    struct orl_event_text *text = orl_event_text_of(id, name, data);
    if (!event || !text) {
        hub->let_go = hub->serial;
        orl_event_text_unref(text);
        if (event)
            free_event(event);
        return;
    }
    orl_event_text_unref(event->text);
    event->text = text;
    event->serial = hub->serial;
    orl_job_event_id(job->jobs, job, event->seen);
    append(hub, event);
    bound(hub);
}

/* ---- The timer ------------------------------------------------------------------------------ */

static void resume(struct stream *stream)
{
    if (!stream->suspended)
        return;
    stream->suspended = false;
    MHD_resume_connection(stream->connection);
}

static void look_at_job(void *ctx, const struct orl_jobs_job *job)
{
    struct orl_hub *hub = ctx;
    char seen[ORL_JOB_EVENT_ID];
    const struct event *event = find(hub, job->row.id);
    orl_job_event_id(job->jobs, job, seen);
    if (!event || strcmp(event->seen, seen) != 0)
        note(hub, job, "job", orl_job_summary(job->jobs, job));
}

static void look(uv_timer_t *timer)
{
    struct orl_hub *hub = timer->data;
    const double now_s = orl_time_steady_s();
    if (hub->server->jobs)
        orl_jobs_running(hub->server->jobs, look_at_job, hub);
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        stream->beat = now_s - stream->active_s >= hub->heartbeat_s;
        if (stream->beat || stream->serial != hub->serial)
            resume(stream);
    }
    if (!hub->streams)
        uv_timer_stop(timer);
    orl_http_kick(hub->server->http);
}

static void wake(struct orl_hub *hub)
{
    if (hub->streams && !hub->stopping)
        uv_timer_start(&hub->timer, look, 0, LOOK_MS);
}

void orl_hub_changed(struct orl_hub *hub, const struct orl_jobs_job *job)
{
    if (!hub)
        return;
    note(hub, job, "job", orl_job_summary(job->jobs, job));
    wake(hub);
}

void orl_hub_forget(struct orl_hub *hub, const struct orl_jobs_job *job)
{
    if (!hub)
        return;
    note(hub, job, "removed", json_pack("{s:s}", "id", job->row.id));
    wake(hub);
}

/* ---- Streams -------------------------------------------------------------------------------- */

static bool is_wanted(const struct orl_hub_filter *filter, const struct event *event)
{
    bool wanted = filter->n_jobs == 0;
    for (size_t i = 0; i < filter->n_jobs && !wanted; i++)
        wanted = strncmp(event->job, filter->jobs[i], strlen(filter->jobs[i])) == 0;
    for (size_t i = 0; i < filter->n_tags && wanted; i++)
        wanted = orl_labels_have(event->tags, filter->tags[i]);
    return wanted;
}

/* The first event behind the stream's place that it wants; NULL: none. Those before are passed
 * over. */
static const struct event *next_event(struct stream *stream)
{
    const struct event *event = stream->hub->newest;
    while (event && event->older && event->older->serial > stream->serial)
        event = event->older;
    if (event && event->serial <= stream->serial)
        event = NULL;
    for (; event; event = event->newer) {
        stream->serial = event->serial;
        if (is_wanted(&stream->filter, event))
            return event;
    }
    return NULL;
}

/* What the stream is to send now, with a reference of its own; NULL: nothing. */
static struct orl_event_text *next_text(struct stream *stream)
{
    struct orl_hub *hub = stream->hub;
    char id[ID];
    if (stream->reset) {
        stream->reset = false;
        name_event(hub, stream->serial, id);
        return orl_event_text_of(id, "reset", json_object());
    }
    const struct event *event = next_event(stream);
    struct orl_event_text *text = event ? event->text : stream->beat ? hub->heartbeat : NULL;
    if (text)
        text->refs++;
    return text;
}

/* Has it yet to read what is kept no more? */
static bool is_left_behind(const struct stream *stream)
{
    return stream->serial < stream->hub->let_go;
}

/* MHD's: fills buffer; without anything to say the connection sleeps until look wakes it. */
static ssize_t read_stream(void *ctx, uint64_t position, char *buffer, size_t max)
{
    struct stream *stream = ctx;
    (void)position;
    if (!stream->sending) {
        if (stream->hub->stopping || is_left_behind(stream))
            return MHD_CONTENT_READER_END_OF_STREAM;
        stream->sending = next_text(stream);
        if (!stream->sending) {
            stream->suspended = true;
            MHD_suspend_connection(stream->connection);
            return 0;
        }
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
    *stream->link = stream->next;
    if (stream->next)
        stream->next->link = stream->link;
    stream->hub->n_streams--;
    if (stream->client)
        stream->client->streams--;
    orl_client_unref(&stream->hub->server->context.clients, stream->client);
    orl_event_text_unref(stream->sending);
    free(stream);
}

/* Where a client is that has seen last_id; false: that is not known here. */
static bool find_place(const struct orl_hub *hub, const char *last_id, uint64_t *ret_serial)
{
    const size_t head = strlen(hub->start);
    if (!last_id || strncmp(last_id, hub->start, head) != 0 || last_id[head] != '-')
        return false;
    const char *digits = last_id + head + 1;
    const size_t count = strlen(digits);
    if (count == 0 || count > 18 || digits[strspn(digits, "0123456789")])
        return false;
    *ret_serial = strtoull(digits, NULL, 10);
    return *ret_serial >= hub->let_go && *ret_serial <= hub->serial;
}

struct MHD_Response *orl_hub_stream(struct orl_hub *hub, struct orl_request *request,
                                    const struct orl_hub_filter *filter, const char *last_id)
{
    enum { BLOCK = 1024 };
    struct stream *stream = calloc(1, sizeof *stream);
    if (!stream)
        return NULL;
    *stream = (struct stream){.hub = hub,
                              .connection = request->connection,
                              .client = orl_client_ref(request),
                              .filter = *filter,
                              .serial = hub->serial,
                              .active_s = orl_time_steady_s(),
                              .next = hub->streams,
                              .link = &hub->streams};
    stream->reset = !find_place(hub, last_id, &stream->serial);
    if (stream->reset)
        stream->serial = hub->serial;
    if (hub->streams)
        hub->streams->link = &stream->next;
    hub->streams = stream;
    hub->n_streams++;
    if (stream->client)
        stream->client->streams++;
    struct MHD_Response *response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, BLOCK, read_stream, stream, free_stream);
    if (!response)
        free_stream(stream);
    else if (!uv_is_active((const uv_handle_t *)&hub->timer))
        uv_timer_start(&hub->timer, look, LOOK_MS, LOOK_MS);
    return response;
}

size_t orl_hub_count(const struct orl_hub *hub)
{
    return hub->n_streams;
}

/* ---- Start and end -------------------------------------------------------------------------- */

int orl_hub_open(struct orl_server *server, struct orl_hub **ret_hub, struct orl_error *err)
{
    unsigned char start[8];
    struct orl_hub *hub = calloc(1, sizeof *hub);
    if (hub)
        hub->heartbeat = orl_event_text_new(":\n\n", 3);
    if (!hub || !hub->heartbeat) {
        free(hub);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    randombytes_buf(start, sizeof start);
    sodium_bin2hex(hub->start, sizeof hub->start, start, sizeof start);
    /* Well before whoever is as impatient as this daemon is gives a stream up. */
    const double half_s = server->config.idle_timeout_s / 2.0;
    hub->heartbeat_s = half_s < HEARTBEAT_S ? half_s : HEARTBEAT_S;
    hub->server = server;
    uv_timer_init(&server->loop, &hub->timer);
    hub->timer.data = hub;
    *ret_hub = hub;
    return 0;
}

void orl_hub_stop(struct orl_hub *hub)
{
    if (!hub || hub->stopping)
        return;
    hub->stopping = true;
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        resume(stream);
    orl_http_kick(hub->server->http);
    uv_close((uv_handle_t *)&hub->timer, NULL);
}

void orl_hub_free(struct orl_hub *hub)
{
    if (!hub)
        return;
    for (struct event *event = hub->newest; event;) {
        struct event *older = event->older;
        free_event(event);
        event = older;
    }
    orl_event_text_unref(hub->heartbeat);
    free(hub);
}

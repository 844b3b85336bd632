#include "handlers/events/events.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handlers/events/event_stream.h"
#include "handlers/jobs/job_status.h"
#include "process/limits.h"
#include "server.h"

enum { ID = 48 };

/* The latest event of a job. */
struct event {
    uint64_t serial;
    char job[ORL_JOB_ID];
    char *tags;                        /* job_json.h; NULL: none */
    char content_id[ORL_JOB_EVENT_ID]; /* the id of its contents while the job runs */
    struct orl_event_text *text;
    struct event *older, *newer;
};

struct stream {
    struct orl_event_stream base;
    struct orl_event_broker *broker;
    struct orl_event_filter filter;
    uint64_t serial; /* last event begun or skipped */
    bool reset;
};

struct orl_event_broker {
    struct orl_event_source source;
    char start[17]; /* random; identifies this run of the daemon */
    struct event *oldest, *newest;
    size_t count, bytes;
    uint64_t serial, dropped; /* newest event so far; newest dropped event */
};

/* ---- Events --------------------------------------------------------------------------------- */

static void unlink_event(struct orl_event_broker *broker, struct event *event)
{
    if (event->older)
        event->older->newer = event->newer;
    else
        broker->oldest = event->newer;
    if (event->newer)
        event->newer->older = event->older;
    else
        broker->newest = event->older;
    broker->count--;
    broker->bytes -= event->text ? event->text->size : 0;
}

static void free_event(struct event *event)
{
    orl_event_text_unref(event->text);
    free(event->tags);
    free(event);
}

static void append_event(struct orl_event_broker *broker, struct event *event)
{
    event->older = broker->newest;
    event->newer = NULL;
    if (broker->newest)
        broker->newest->newer = event;
    else
        broker->oldest = event;
    broker->newest = event;
    broker->count++;
    broker->bytes += event->text ? event->text->size : 0;
}

/* Drops the oldest events until the limits hold. Keeps the newest. */
static void drop_oldest_events(struct orl_event_broker *broker)
{
    struct event *event = broker->oldest;
    while (event && event->newer &&
           (broker->count > ORL_SERVER_BROKER_EVENTS || broker->bytes > ORL_SERVER_BROKER_BYTES)) {
        struct event *newer = event->newer;
        broker->dropped = event->serial;
        unlink_event(broker, event);
        free_event(event);
        event = newer;
    }
}

static struct event *find_event(const struct orl_event_broker *broker, const char *job)
{
    struct event *event = broker->newest;
    while (event && strcmp(event->job, job) != 0)
        event = event->older;
    return event;
}

/* Returns the job's event, taken out of the list; NULL when out of memory. */
static struct event *take_event(struct orl_event_broker *broker, const struct orl_jobs_job *job)
{
    struct event *event = find_event(broker, job->row.id);
    if (event) {
        unlink_event(broker, event);
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

static void name_event(const struct orl_event_broker *broker, uint64_t serial, char ret_id[ID])
{
    snprintf(ret_id, ID, "%s-%llu", broker->start, (unsigned long long)serial);
}

/* Records an event. Takes ownership of data. Without memory, the streams that miss it are cut off,
 * and start again with a reset. */
static void record_event(struct orl_event_broker *broker, const struct orl_jobs_job *job,
                         const char *name, json_t *data)
{
    char id[ID];
    struct event *event = take_event(broker, job);
    name_event(broker, ++broker->serial, id);
    struct orl_event_text *text = orl_event_text_of(id, name, data);
    if (!event || !text) {
        broker->dropped = broker->serial;
        orl_event_text_unref(text);
        if (event)
            free_event(event);
        return;
    }
    orl_event_text_unref(event->text);
    event->text = text;
    event->serial = broker->serial;
    orl_job_event_id(job->jobs, job, event->content_id);
    append_event(broker, event);
    drop_oldest_events(broker);
}

/* ---- Changes of jobs ------------------------------------------------------------------------ */

static void check_job(void *ctx, const struct orl_jobs_job *job)
{
    struct orl_event_broker *broker = ctx;
    char content_id[ORL_JOB_EVENT_ID];
    const struct event *event = find_event(broker, job->row.id);
    orl_job_event_id(job->jobs, job, content_id);
    if (!event || strcmp(event->content_id, content_id) != 0)
        record_event(broker, job, "job", orl_job_summary(job->jobs, job));
}

static void check_running_jobs(struct orl_event_source *source)
{
    if (source->server->jobs)
        orl_jobs_running(source->server->jobs, check_job, source);
}

void orl_event_broker_job_changed(struct orl_event_broker *broker, const struct orl_jobs_job *job)
{
    if (!broker)
        return;
    record_event(broker, job, "job", orl_job_summary(job->jobs, job));
    orl_event_source_wake(&broker->source);
}

void orl_event_broker_job_removed(struct orl_event_broker *broker, const struct orl_jobs_job *job)
{
    if (!broker)
        return;
    record_event(broker, job, "removed", json_pack("{s:s}", "id", job->row.id));
    orl_event_source_wake(&broker->source);
}

/* ---- Streams -------------------------------------------------------------------------------- */

static bool is_wanted(const struct orl_event_filter *filter, const struct event *event)
{
    bool wanted = filter->n_jobs == 0;
    for (size_t i = 0; i < filter->n_jobs && !wanted; i++)
        wanted = strncmp(event->job, filter->jobs[i], strlen(filter->jobs[i])) == 0;
    for (size_t i = 0; i < filter->n_tags && wanted; i++)
        wanted = orl_labels_have(event->tags, filter->tags[i]);
    return wanted;
}

/* Returns the next event that the stream wants; NULL: none. Skips the events before it. */
static const struct event *next_event(struct stream *stream)
{
    const struct event *event = stream->broker->newest;
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

static bool has_news(const struct orl_event_stream *base)
{
    const struct stream *stream = (const struct stream *)base;
    return stream->reset || stream->serial != stream->broker->serial;
}

/* Returns the next text. A stream whose unread events were dropped ends. */
static bool next_text(struct orl_event_stream *base, struct orl_event_text **ret_text)
{
    struct stream *stream = (struct stream *)base;
    struct orl_event_broker *broker = stream->broker;
    char id[ID];
    if (broker->source.stopping || stream->serial < broker->dropped)
        return false;
    if (stream->reset) {
        name_event(broker, stream->serial, id);
        *ret_text = orl_event_text_of(id, "reset", json_object());
        stream->reset = !*ret_text;
        return true;
    }
    const struct event *event = next_event(stream);
    if (event) {
        *ret_text = event->text;
        event->text->refs++;
    }
    return true;
}

static void free_stream(struct orl_event_stream *base)
{
    free((struct stream *)base);
}

/* Returns the place of a client that has seen last_id. False: it is not known here. */
static bool find_position(const struct orl_event_broker *broker, const char *last_id,
                          uint64_t *ret_serial)
{
    const size_t head = strlen(broker->start);
    if (!last_id || strncmp(last_id, broker->start, head) != 0 || last_id[head] != '-')
        return false;
    const char *digits = last_id + head + 1;
    const size_t count = strlen(digits);
    if (count == 0 || count > 18 || digits[strspn(digits, "0123456789")])
        return false;
    *ret_serial = strtoull(digits, NULL, 10);
    return *ret_serial >= broker->dropped && *ret_serial <= broker->serial;
}

struct MHD_Response *orl_event_broker_stream(struct orl_event_broker *broker,
                                             struct orl_request *request,
                                             const struct orl_event_filter *filter,
                                             const char *last_id)
{
    struct stream *stream = calloc(1, sizeof *stream);
    if (!stream)
        return NULL;
    stream->broker = broker;
    stream->filter = *filter;
    stream->reset = !find_position(broker, last_id, &stream->serial);
    if (stream->reset)
        stream->serial = broker->serial;
    return orl_event_stream_open(&broker->source, &stream->base, request);
}

size_t orl_event_broker_count(const struct orl_event_broker *broker)
{
    return broker->source.count;
}

/* ---- Start and end -------------------------------------------------------------------------- */

int orl_event_broker_open(struct orl_server *server, struct orl_event_broker **ret_broker,
                          struct orl_error *err)
{
    static const struct orl_event_calls calls = {check_running_jobs, has_news, next_text,
                                                 free_stream};
    unsigned char start[8];
    struct orl_event_broker *broker = calloc(1, sizeof *broker);
    if (!broker)
        return orl_error_no_memory(err);
    const int rc = orl_event_source_init(&broker->source, server, &calls, err);
    if (rc) {
        free(broker);
        return rc;
    }
    randombytes_buf(start, sizeof start);
    sodium_bin2hex(broker->start, sizeof broker->start, start, sizeof start);
    *ret_broker = broker;
    return 0;
}

void orl_event_broker_stop(struct orl_event_broker *broker)
{
    if (broker && !broker->source.stopping)
        orl_event_source_stop(&broker->source);
}

void orl_event_broker_free(struct orl_event_broker *broker)
{
    if (!broker)
        return;
    for (struct event *event = broker->newest; event;) {
        struct event *older = event->older;
        free_event(event);
        event = older;
    }
    orl_event_source_done(&broker->source);
    free(broker);
}

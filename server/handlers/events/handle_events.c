#include "handlers/handlers.h"

#include <stdio.h>
#include <string.h>

#include "handlers/events/events.h"
#include "handlers/jobs/job_status.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "server.h"

/* Returns true if the client has seen the job end. A 204 then keeps its EventSource from
 * reconnecting. */
static bool has_seen_all(const struct orl_request *request, const struct orl_jobs_job *job,
                         const char *last_id)
{
    char id[ORL_JOB_EVENT_ID];
    if (!last_id || job->row.state < ORL_JOB_SUCCEEDED)
        return false;
    orl_job_event_id(request->server->jobs, job, id);
    return strcmp(id, last_id) == 0;
}

/* Returns true if a stream may open. Otherwise returns false after a reply: a HEAD, or too many
 * streams. */
static bool may_stream(struct orl_request *request)
{
    const struct orl_server *server = request->server;
    /* A HEAD gets no stream: libmicrohttpd 0.9.75 would still send the final chunk, "0". */
    if (strcmp(request->method, "HEAD") == 0) {
        orl_reply_text(request, "text/event-stream", "");
        return false;
    }
    if (!orl_client_may_stream(request))
        return false;
    if (orl_events_count(server->events) + orl_event_broker_count(server->broker) <
        ORL_SERVER_STREAMS)
        return true;
    orl_reply_problem(request, 429, "too-many-streams", "Too many event streams are open",
                      "%u streams are open, the maximum; try again later, or poll the job",
                      ORL_SERVER_STREAMS);
    orl_reply_header(request, "Retry-After", "10");
    return false;
}

static void add_stream_headers(struct orl_request *request)
{
    orl_reply_header(request, "Cache-Control", "no-store");
    orl_reply_header(request, "X-Accel-Buffering", "no");
}

void orl_handle_job_events(struct orl_request *request)
{
    struct orl_server *server = request->server;
    const struct orl_jobs_job *job = orl_job_of_path(request);
    const char *last_id = orl_request_header(request, "Last-Event-ID");
    if (!job)
        return;
    if (has_seen_all(request, job, last_id)) {
        orl_reply_no_content(request);
        return;
    }
    if (!may_stream(request))
        return;
    orl_reply_stream(request, orl_events_stream(server->events, request, job, last_id),
                     "text/event-stream");
    add_stream_headers(request);
}

/* ---- Events of all jobs --------------------------------------------------------------------- */

struct event_query {
    struct orl_event_filter filter;
    bool wrong;
};

static bool is_id_prefix(const char *text)
{
    const size_t length = strlen(text);
    return length >= ORL_JOB_PREFIX && length < ORL_JOB_ID &&
           strspn(text, "0123456789abcdef") == length;
}

static enum MHD_Result add_argument(void *ctx, enum MHD_ValueKind kind, const char *key,
                                    const char *value)
{
    struct event_query *event_query = ctx;
    struct orl_event_filter *filter = &event_query->filter;
    const bool is_job = strcmp(key, "job") == 0, is_tag = strcmp(key, "tag") == 0;
    (void)kind;
    if (!is_job && !is_tag)
        return MHD_YES;
    event_query->wrong =
        !value || (is_job ? filter->n_jobs == ORL_EVENT_FILTER_JOBS || !is_id_prefix(value)
                          : filter->n_tags == ORL_EVENT_FILTER_TAGS || !orl_label_is_tag(value));
    if (event_query->wrong)
        return MHD_NO;
    if (is_job)
        snprintf(filter->jobs[filter->n_jobs++], sizeof *filter->jobs, "%s", value);
    else
        snprintf(filter->tags[filter->n_tags++], sizeof *filter->tags, "%s", value);
    return MHD_YES;
}

void orl_handle_all_events(struct orl_request *request)
{
    struct event_query event_query = {.wrong = false};
    MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_argument,
                              &event_query);
    if (event_query.wrong) {
        orl_page_refuse(request, "job must be a job's id or its beginning, at most 16 times; tag "
                                 "must be a job's tag, at most 4 times");
        return;
    }
    if (!may_stream(request))
        return;
    orl_reply_stream(request,
                     orl_event_broker_stream(request->server->broker, request, &event_query.filter,
                                             orl_request_header(request, "Last-Event-ID")),
                     "text/event-stream");
    add_stream_headers(request);
}

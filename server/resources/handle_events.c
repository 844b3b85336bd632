#include "resources/handlers.h"

#include <string.h>

#include "http/reply.h"
#include "process/limits.h"
#include "resources/events.h"
#include "resources/job_event.h"
#include "resources/job_path.h"
#include "server.h"

/* Whoever has seen the job end has nothing to wait for; 204 keeps an EventSource from asking on. */
static bool has_seen_all(const struct orl_request *request, const struct orl_jobs_job *job,
                         const char *last_id)
{
    char id[ORL_JOB_EVENT_ID];
    if (!last_id || job->row.state < ORL_JOB_SUCCEEDED)
        return false;
    orl_job_event_id(request->server->jobs, job, id);
    return strcmp(id, last_id) == 0;
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
    /* A HEAD gets no stream: libmicrohttpd 0.9.75 would end its chunks, "0", all the same. */
    if (strcmp(request->method, "HEAD") == 0) {
        orl_reply_text(request, "text/event-stream", "");
        return;
    }
    if (!orl_client_may_stream(request))
        return;
    if (orl_events_count(server->events) >= ORL_SERVER_STREAMS) {
        orl_reply_problem(request, 429, "too-many-streams", "Too many event streams are open",
                          "%u are; try again later, or poll the job", ORL_SERVER_STREAMS);
        orl_reply_header(request, "Retry-After", "10");
        return;
    }
    orl_reply_stream(request, orl_events_stream(server->events, request, job, last_id),
                     "text/event-stream");
    orl_reply_header(request, "Cache-Control", "no-store");
    orl_reply_header(request, "X-Accel-Buffering", "no");
}

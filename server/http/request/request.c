#include "http/request/request.h"

#include <stdlib.h>

#include "health/crash.h"
#include "http/connection/connections.h"
#include "http/context.h"

void orl_request_step_run(struct orl_request *request, orl_request_step step)
{
    orl_crash_request_begin(request->id, request->method, request->path);
    step(request);
    orl_crash_request_end();
}

const char *orl_request_query(const struct orl_request *request, const char *name)
{
    return MHD_lookup_connection_value(request->connection, MHD_GET_ARGUMENT_KIND, name);
}

const char *orl_request_header(const struct orl_request *request, const char *name)
{
    return MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, name);
}

/* ---- Work on the pool ----------------------------------------------------------------------- */

static void work_run(uv_work_t *work)
{
    struct orl_request *request = work->data;
    orl_request_step_run(request, request->run);
}

static void work_back(uv_work_t *work, int status)
{
    (void)status; /* works are never cancelled */
    orl_request_resume(work->data);
}

void orl_request_resume(struct orl_request *request)
{
    struct orl_http_context *context = request->context;
    request->working = false;
    context->working--;
    if (request->then)
        orl_request_step_run(request, request->then);
    if (request->working)
        return; /* `then` has started the next operation */
    orl_connection_resume(request->connection);
    MHD_resume_connection(request->connection);
    context->calls->work_done(context->server);
}

/* Logs the bug at once, since the first operation may never end. */
static void note_started_twice(struct orl_request *request)
{
    request->started_twice = true;
    orl_log_event(request->context->log, ORL_LOG_ERROR, "second-operation", "iss", "id",
                  (int64_t)request->id, "method", request->method, "path", request->path);
#ifdef ORL_DEBUG
    abort();
#endif
}

bool orl_request_set_pending(struct orl_request *request, orl_request_step run,
                             orl_request_step then)
{
    if (request->working) {
        note_started_twice(request);
        return false;
    }
    request->run = run;
    request->then = then;
    request->working = true;
    request->work.data = request;
    request->context->working++;
    return true;
}

void orl_request_queue(struct orl_request *request)
{
    uv_queue_work(request->context->loop, &request->work, work_run, work_back);
}

void orl_request_work(struct orl_request *request, orl_request_step run, orl_request_step then)
{
    if (orl_request_set_pending(request, run, then))
        orl_request_queue(request);
}

struct orl_folders orl_request_folders(struct orl_request *request)
{
    struct orl_folders folders = *request->context->folders;
    folders.reservation = &request->reservation;
    return folders;
}

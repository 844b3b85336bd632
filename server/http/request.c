#include "http/request.h"

#include "http/connections.h"
#include "http/context.h"

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
    request->run(request);
}

static void work_back(uv_work_t *work, int status)
{
    (void)status; /* works are never cancelled */
    orl_request_go_on(work->data);
}

void orl_request_go_on(struct orl_request *request)
{
    struct orl_http_context *context = request->context;
    request->working = false;
    context->working--;
    if (request->then)
        request->then(request);
    if (request->working)
        return; /* then has it wait again */
    orl_connection_go_on(request->connection);
    MHD_resume_connection(request->connection);
    context->calls->worked(context->server);
}

void orl_request_wait(struct orl_request *request, orl_request_step run, orl_request_step then)
{
    request->run = run;
    request->then = then;
    request->working = true;
    request->work.data = request;
    request->context->working++;
}

void orl_request_queue(struct orl_request *request)
{
    uv_queue_work(request->context->loop, &request->work, work_run, work_back);
}

void orl_request_work(struct orl_request *request, orl_request_step run, orl_request_step then)
{
    orl_request_wait(request, run, then);
    orl_request_queue(request);
}

struct orl_folders orl_request_folders(struct orl_request *request)
{
    struct orl_folders folders = *request->context->folders;
    folders.hold = &request->hold;
    return folders;
}

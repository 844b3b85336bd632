#include "http/http_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/access/access.h"
#include "http/connection/connections.h"
#include "http/context.h"
#include "http/request/parse_request.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"

static void flush_body(struct orl_request *request)
{
    orl_body_flush(&request->body, request->context->folders);
}

/* ---- MHD's callbacks ------------------------------------------------------------------------ */

static void refuse_too_large(struct orl_request *request)
{
    orl_reply_problem(request, 413, "limit", "The request is too large",
                      "the body may have at most %llu bytes",
                      (unsigned long long)request->route->max_body);
}

/* Reserves space for a body that will go to disk, before it arrives. */
static void reserve_request_body(struct orl_request *request, uint64_t bytes)
{
    request->client = orl_client_ref(request);
    request->reservation =
        (struct orl_reservation){.all = request->context->calls->upload_quota(request->server),
                                 .own = request->client ? &request->client->bytes : NULL};
    if (bytes <= ORL_SERVER_BODY_BUFFER / 2)
        return;
    if (!request->context->disk_full &&
        request->context->calls->reserve_body(request->server, &request->reservation, bytes))
        request->body.reserved = bytes;
    else
        orl_reply_quota_exceeded(request, bytes);
}

/* Finds the route, and refuses at once if the headers are enough to refuse. */
static void open_request(struct orl_request *request, const char *url, const char *method,
                         const char *version, const char *target_fault)
{
    char allow[64], types[160];
    const struct orl_route *route = NULL;
    const char *fault = orl_framing_check(request->connection, method, version);
    if (!fault && MHD_VERSION < 0x01000000 && version != request->version_at)
        fault = "its target has a NUL";
    fault = fault ? fault : target_fault;
    if (fault) {
        orl_reply_problem(request, 400, "syntax", "The request is not valid HTTP", "%s", fault);
        request->unframed = true;
        return;
    }
    if (request->too_long) {
        orl_reply_problem(
            request, 414, "limit", "The request is too large",
            "its target may have at most %u bytes, where each argument counts 64 bytes more",
            ORL_SERVER_URI_BYTES);
        return;
    }
    if (!orl_access_check_origin(request))
        return;
    const unsigned status = orl_router_find(request->context->routes, request->method, url, &route,
                                            request->params, allow);
    if (status == 405 && orl_cors_preflight(request, allow))
        return;
    if (status == 405) {
        orl_reply_problem(request, 405, "method-not-allowed", "The method is not allowed here",
                          "%s is not possible here; use %s", request->method, allow);
        orl_reply_header(request, "Allow", allow);
        return;
    }
    if (status) {
        orl_reply_not_found(request, "resource");
        return;
    }
    request->route = route;
    if (strncmp(route->path, "/v1/jobs/{}", 11) == 0)
        snprintf(request->job, sizeof request->job, "%.*s", ORL_JOB_ID - 1, request->params[0]);
    orl_body_init(&request->body, route->max_body, &request->reservation);
    if (!orl_access_check_token(request))
        return;
    if (request->context->stopping) {
        orl_reply_stopping(request);
        return;
    }
    const char *length = orl_request_header(request, MHD_HTTP_HEADER_CONTENT_LENGTH);
    const unsigned long long bytes = length ? strtoull(length, NULL, 10) : 0;
    if (bytes > route->max_body)
        refuse_too_large(request);
    else if (!orl_router_accepts(route, orl_request_header(request, MHD_HTTP_HEADER_CONTENT_TYPE)))
        orl_reply_problem(request, 415, "unsupported-media-type",
                          "The type of the body is not supported", "%s takes %s", url,
                          orl_router_types(route, types));
    else
        reserve_request_body(request, bytes);
}

void *orl_serve_begin(void *ctx, const char *uri, struct MHD_Connection *connection)
{
    struct orl_http_context *context = ctx;
    struct orl_request *request = calloc(1, sizeof *request);
    if (!request)
        return NULL;
    request->context = context;
    request->server = context->server;
    request->connection = connection;
    request->id = ++context->requests;
    request->started_s = orl_time_steady_s();
    snprintf(request->method, sizeof request->method, "-");
    snprintf(request->path, sizeof request->path, "%.*s", (int)strcspn(uri ? uri : "", "?"),
             uri ? uri : "");
    snprintf(request->token, sizeof request->token, "-");
    orl_body_init(&request->body, 0, NULL);
    request->version_at = uri ? uri + strlen(uri) + 1 : NULL;
    request->too_long = uri && orl_framing_cut_query(uri);
    context->being_parsed = request;
    return request;
}

size_t orl_serve_unescape(void *ctx, struct MHD_Connection *connection, char *text)
{
    const struct orl_http_context *context = ctx;
    const struct orl_request *request = context->being_parsed;
    /* orl_framing_cut_query does not see a query after a NUL. If its arguments do not fit,
     * libmicrohttpd would drop the rest of the request and then wait for it. */
    if (MHD_VERSION < 0x01000000 && request && request->connection == connection &&
        request->version_at && text >= request->version_at)
        orl_connection_cut(connection);
    return orl_framing_unescape(text);
}

/* Handles the complete headers of a request. */
static void note_headers(struct orl_request *request, const char *url, const char *method,
                         const char *version)
{
    request->headers_complete = true;
    request->context->being_parsed = NULL;
    request->started_s = orl_time_steady_s();
    snprintf(request->method, sizeof request->method, "%s", method);
    const char *path = url, *fault = orl_target_split(url, &request->target, &path);
    snprintf(request->path, sizeof request->path, "%s", path);
    orl_connection_headers_complete(request->connection);
    open_request(request, path, method, version, fault);
}

/* Frees the handler's state and files before the answer is sent, so that no file of a refused
 * upload is left once the client has the answer. */
static void release_state(struct orl_request *request)
{
    if (request->state && request->free_state)
        request->free_state(request->state);
    request->state = NULL;
    if (request->dispatched) {
        orl_body_done(&request->body);
        orl_reservation_release(&request->reservation);
    }
}

static void reply_started_twice(struct orl_request *request)
{
    struct orl_error err;
    orl_error_set(&err, ORL_ERR_INTERNAL, "a second operation was started for one request");
    orl_reply_error(request, &err);
}

static enum MHD_Result send_response(struct orl_request *request)
{
    char id[24];
    if (request->started_twice)
        reply_started_twice(request);
    snprintf(id, sizeof id, "%llu", (unsigned long long)request->id);
    orl_reply_header(request, "X-Request-Id", id);
    /* Browsers then do not treat other content as a script or page. */
    orl_reply_header(request, "X-Content-Type-Options", "nosniff");
    orl_cors_add(request);
    if (request->unframed)
        orl_reply_header(request, MHD_HTTP_HEADER_CONNECTION, "close");
    release_state(request);
    struct MHD_Response *response = request->response;
    request->response = NULL;
    const enum MHD_Result sent = MHD_queue_response(request->connection, request->status, response);
    MHD_destroy_response(response);
    return sent;
}

/*
 * Returns true if a request refused by its headers is answered before its body is read. This is so
 * if its client waits for a 100 Continue, or if the body is unbounded, huge (without a valid token:
 * large), or of unknown end. The connection is then closed. Any other body is read and dropped
 * first: a client that is still sending would see a broken connection, and no answer.
 */
static bool answer_at_once(const struct orl_request *request)
{
    const bool unknown = request->status == 401 || request->status == 403;
    const char *length = orl_request_header(request, MHD_HTTP_HEADER_CONTENT_LENGTH);
    const unsigned long long bytes = length ? strtoull(length, NULL, 10) : 0;
    return request->unframed || orl_request_header(request, MHD_HTTP_HEADER_TRANSFER_ENCODING) ||
           bytes > (unknown ? ORL_SERVER_BODY_BUFFER : ORL_SERVER_DROPPED_BODY) ||
           (bytes > 0 && orl_request_header(request, MHD_HTTP_HEADER_EXPECT));
}

/* Takes data of the body. A full buffer is written to disk while the connection is suspended. */
static enum MHD_Result take_data(struct orl_request *request, const char *data, size_t *data_size)
{
    /* With chunked bodies MHD offers the next chunk even to a connection just suspended. Data not
     * taken is offered again after it resumes. */
    if (request->working)
        return MHD_YES;
    orl_connection_received(request->connection, *data_size);
    /* Otherwise clients could keep the daemon writing while it stops. */
    if (!request->response && request->context->stopping)
        orl_reply_stopping(request);
    if (request->response) {
        *data_size = 0; /* refused already */
        return MHD_YES;
    }
    const bool full = orl_body_append(&request->body, data, *data_size);
    *data_size = 0;
    /* Cuts off a client that sends far more than the limit. */
    if (request->body.over && request->body.size / 2 > request->body.limit + ORL_SERVER_BODY_BUFFER)
        return MHD_NO;
    if (full) {
        MHD_suspend_connection(request->connection);
        orl_connection_suspend(request->connection);
        orl_request_work(request, flush_body, NULL);
    }
    return MHD_YES;
}

static enum MHD_Result call_handler(struct orl_request *request)
{
    request->dispatched = true;
    request->context->unanswered++;
    orl_connection_body_complete(request->connection);
    if (!request->response && request->context->stopping)
        orl_reply_stopping(request);
    if (request->response)
        return send_response(request);
    if (request->body.over)
        refuse_too_large(request);
    else if (request->body.failed)
        orl_reply_error(request, &request->body.err);
    else
        orl_request_step_run(request, request->route->handler);
    if (request->response && !request->working)
        return send_response(request);
    if (!request->working)
        return MHD_NO; /* the handler neither replied nor started work: a bug */
    MHD_suspend_connection(request->connection);
    return MHD_YES;
}

enum MHD_Result orl_serve_handle(void *ctx, struct MHD_Connection *connection, const char *url,
                                 const char *method, const char *version, const char *data,
                                 size_t *data_size, void **handle)
{
    struct orl_request *request = *handle;
    (void)ctx;
    if (!request) {
        /* There was no memory for the request. Its headers are valid, so no 400 may be sent for
         * them. */
        orl_connection_body_complete(connection);
        return MHD_NO;
    }
    if (!request->headers_complete) {
        note_headers(request, url, method, version);
        /* Without a body the answer can wait for the next call, which keeps the connection open. */
        if (!request->response || !answer_at_once(request))
            return MHD_YES;
        orl_connection_body_complete(connection); /* further data is not read */
        return send_response(request);
    }
    if (*data_size > 0)
        return take_data(request, data, data_size);
    if (!request->dispatched)
        return call_handler(request);
    if (request->response && !request->working)
        return send_response(request);
    return request->working || request->status ? MHD_YES : MHD_NO;
}

void orl_serve_completed(void *ctx, struct MHD_Connection *connection, void **handle,
                         enum MHD_RequestTerminationCode why)
{
    struct orl_http_context *context = ctx;
    struct orl_request *request = *handle;
    orl_connection_end_request(connection);
    if (!request)
        return;
    if (context->being_parsed == request)
        context->being_parsed = NULL;
    const double seconds = orl_time_steady_s() - request->started_s;
    orl_metrics_request(context->metrics, orl_router_index(context->routes, request->route),
                        request->status, seconds);
    orl_log_event(context->log, ORL_LOG_INFO, "request", "issssids", "id", (int64_t)request->id,
                  "job", request->job[0] ? request->job : "-", "token", request->token, "method",
                  request->method, "path", request->path, "status", (int64_t)request->status, "ms",
                  1000 * seconds, "end",
                  why == MHD_REQUEST_TERMINATED_COMPLETED_OK ? "ok" : "broken");
    if (request->dispatched)
        context->unanswered--;
    if (request->response)
        MHD_destroy_response(request->response);
    release_state(request);
    orl_body_done(&request->body);
    orl_reservation_release(&request->reservation);
    orl_client_unref(&context->clients, request->client);
    free(request);
    *handle = NULL;
}

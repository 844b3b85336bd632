#include "http/response/reply.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "http/context.h"
#include "http/request/parse_request.h"
#include "json/encode.h"
#include "json/problem.h"

static void set_response(struct orl_request *request, unsigned status,
                         struct MHD_Response *response, const char *type)
{
    if (!response) {
        static const char text[] =
            "{\"type\":\"urn:oriel:error:no-memory\",\"title\":\"The server is "
            "out of memory\",\"status\":503}";
        response = MHD_create_response_from_buffer(sizeof text - 1, (void *)(uintptr_t)text,
                                                   MHD_RESPMEM_PERSISTENT);
        type = "application/problem+json";
        status = 503;
    }
    if (request->response)
        MHD_destroy_response(request->response);
    request->response = response;
    request->status = status;
    if (type)
        orl_reply_header(request, "Content-Type", type);
}

void orl_reply_header(struct orl_request *request, const char *name, const char *value)
{
    if (request->response)
        MHD_add_response_header(request->response, name, value);
}

/* Ten digits suffice for seconds and percents; results are files, with full precision. */
char *orl_reply_text_of(json_t *json)
{
    char *text = orl_json_text(json, JSON_COMPACT | JSON_REAL_PRECISION(10));
    json_decref(json);
    return text;
}

static void reply_document(struct orl_request *request, unsigned status, json_t *json,
                           const char *type)
{
    char *text = orl_reply_text_of(json);
    struct MHD_Response *response = NULL;
    if (text)
        response = MHD_create_response_from_buffer(strlen(text), text, MHD_RESPMEM_MUST_FREE);
    if (text && !response)
        free(text);
    set_response(request, status, response, type);
}

void orl_reply_json(struct orl_request *request, unsigned status, json_t *json)
{
    reply_document(request, status, json, "application/json");
}

void orl_reply_json_text(struct orl_request *request, unsigned status, const char *text,
                         size_t size)
{
    struct MHD_Response *response = NULL;
    if (text)
        response =
            MHD_create_response_from_buffer(size, (void *)(uintptr_t)text, MHD_RESPMEM_MUST_COPY);
    set_response(request, status, response, "application/json");
}

void orl_reply_error(struct orl_request *request, const struct orl_error *err)
{
    if (err->code == ORL_ERR_FULL && request->reservation.refused != ORL_QUOTA_FITS) {
        orl_reply_quota_exceeded(request, request->reservation.bytes);
        return;
    }
    int status = 500;
    json_t *problem = orl_problem_from_error(err, &status);
    if (status >= 500) {
        char text[3 * ORL_ERROR_TEXT_MAX];
        orl_error_format(err, text, sizeof text);
        orl_log_event(request->context->log, ORL_LOG_ERROR, "request-failed", "is", "id",
                      (int64_t)request->id, "why", text);
    }
    reply_document(request, (unsigned)status, problem, "application/problem+json");
    if (status == 507)
        orl_reply_header(request, "Retry-After", "60");
}

void orl_reply_problem(struct orl_request *request, unsigned status, const char *type,
                       const char *title, const char *detail, ...)
{
    char text[ORL_ERROR_TEXT_MAX];
    va_list args;
    va_start(args, detail);
    vsnprintf(text, sizeof text, detail, args);
    va_end(args);
    reply_document(request, status, orl_problem_new((int)status, type, title, "%s", text),
                   "application/problem+json");
}

void orl_reply_not_found(struct orl_request *request, const char *what)
{
    orl_reply_problem(request, 404, "no-such-resource", "There is no such resource",
                      "there is no %s of that name here", what);
}

void orl_reply_removed(struct orl_request *request, bool removed, const char *what)
{
    if (removed)
        orl_reply_no_content(request);
    else
        orl_reply_not_found(request, what);
}

void orl_reply_in_use(struct orl_request *request, const char *why)
{
    orl_reply_problem(request, 409, "in-use", "It is in use", "%s", why);
}

void orl_reply_stopping(struct orl_request *request)
{
    orl_reply_problem(request, 503, "stopping", "The daemon is stopping",
                      "try again after it has restarted");
    orl_reply_header(request, "Retry-After", "10");
}

void orl_reply_bytes(struct orl_request *request, const char *type, const char *data, size_t size)
{
    set_response(
        request, 200,
        MHD_create_response_from_buffer(size, (void *)(uintptr_t)data, MHD_RESPMEM_PERSISTENT),
        type);
}

void orl_reply_text(struct orl_request *request, const char *type, const char *text)
{
    orl_reply_bytes(request, type, text, strlen(text));
}

void orl_reply_owned_text(struct orl_request *request, unsigned status, const char *type,
                          char *text)
{
    struct MHD_Response *response =
        text ? MHD_create_response_from_buffer(strlen(text), text, MHD_RESPMEM_MUST_FREE) : NULL;
    if (!response)
        free(text);
    set_response(request, status, response, type);
}

void orl_reply_file(struct orl_request *request, int fd, uint64_t size, const char *type)
{
    set_response(request, 200, MHD_create_response_from_fd64(size, fd), type);
}

/* Returns true if there is no If-Range, or it names this tag. A date never matches: files have none
 * here. */
static bool range_holds(struct orl_request *request, const char *tag)
{
    char quoted[2 * ORL_PARAM_MAX + 8];
    const char *condition = orl_request_header(request, "If-Range");
    snprintf(quoted, sizeof quoted, "\"%s\"", tag);
    return !condition || strcmp(condition, quoted) == 0;
}

void orl_reply_file_range(struct orl_request *request, int fd, uint64_t size, const char *type,
                          const char *tag)
{
    struct orl_range range = {.first = 0, .count = size};
    const char *header = orl_request_header(request, "Range");
    enum orl_range_kind kind = ORL_RANGE_ALL;
    char content[80];
    if (header && strcmp(request->method, "GET") == 0 && range_holds(request, tag))
        kind = orl_range_parse(header, size, &range);
    if (kind == ORL_RANGE_NONE) {
        close(fd);
        orl_reply_problem(request, 416, "range", "The range is outside the file",
                          "the file has %llu bytes", (unsigned long long)size);
        snprintf(content, sizeof content, "bytes */%llu", (unsigned long long)size);
        orl_reply_header(request, "Content-Range", content);
        return;
    }
    set_response(request, kind == ORL_RANGE_PART ? 206 : 200,
                 MHD_create_response_from_fd_at_offset64(range.count, fd, range.first), type);
    if (kind == ORL_RANGE_PART) {
        snprintf(content, sizeof content, "bytes %llu-%llu/%llu", (unsigned long long)range.first,
                 (unsigned long long)(range.first + range.count - 1), (unsigned long long)size);
        orl_reply_header(request, "Content-Range", content);
    }
    orl_reply_header(request, "Accept-Ranges", "bytes");
    orl_reply_etag(request, tag);
}

void orl_reply_stream(struct orl_request *request, struct MHD_Response *response, const char *type)
{
    set_response(request, 200, response, type);
}

void orl_reply_no_content(struct orl_request *request)
{
    set_response(request, 204, MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT),
                 NULL);
}

/* Replies 304, without a body. */
static void reply_not_modified(struct orl_request *request)
{
    set_response(request, 304, MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT),
                 NULL);
}

void orl_reply_etag(struct orl_request *request, const char *tag)
{
    char quoted[2 * ORL_PARAM_MAX + 8];
    snprintf(quoted, sizeof quoted, "\"%s\"", tag);
    orl_reply_header(request, "ETag", quoted);
}

bool orl_reply_if_none_match(struct orl_request *request, const char *tag)
{
    char quoted[2 * ORL_PARAM_MAX + 8];
    const char *known = orl_request_header(request, "If-None-Match");
    snprintf(quoted, sizeof quoted, "\"%s\"", tag);
    if (!known || (strcmp(known, "*") != 0 && !strstr(known, quoted)))
        return false;
    reply_not_modified(request);
    orl_reply_etag(request, tag);
    return true;
}

static void refuse_full(struct orl_request *request, uint64_t bytes)
{
    orl_reply_problem(request, 507, "storage-full", "There is not enough storage",
                      "this needs %llu of %llu bytes, and data that must be kept leaves less; "
                      "fetch results, remove jobs, scenes or BSDFs, or raise --storage-budget",
                      (unsigned long long)bytes,
                      (unsigned long long)request->context->calls->budget(request->server));
    orl_reply_header(request, "Retry-After", "60");
}

static void refuse_disk(struct orl_request *request)
{
    orl_reply_problem(request, 507, "disk-full", "There is not enough storage",
                      "the disk of the data folder is full; remove jobs, photon maps, scenes or "
                      "BSDFs, or other files on it");
    orl_reply_header(request, "Retry-After", "60");
}

void orl_reply_quota_exceeded(struct orl_request *request, uint64_t bytes)
{
    if (request->context->disk_full) {
        refuse_disk(request);
        return;
    }
    const uint64_t own =
        request->reservation.own ? atomic_load(&request->reservation.own->most) : 0;
    if (request->reservation.refused == ORL_QUOTA_FULL ||
        bytes > own) { /* waiting would not help */
        refuse_full(request, bytes);
        return;
    }
    orl_reply_problem(request, 429, "too-many-bytes", "This client uploads too much at a time",
                      "its uploads may take %llu bytes together, including unpacked files; try "
                      "again when others have ended",
                      (unsigned long long)own);
    orl_reply_header(request, "Retry-After", "10");
}

/* ---- Replies that wait for the disk --------------------------------------------------------- */

static bool is_read_only(const struct orl_request *request)
{
    return strcmp(request->method, "GET") == 0 || strcmp(request->method, "HEAD") == 0;
}

static void on_synced(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err)
{
    struct orl_request *request =
        (struct orl_request *)((char *)wait - offsetof(struct orl_request, sync_wait));
    if (rc && !is_read_only(request)) {
        struct orl_error why = *err;
        orl_error_hint(
            &why, "The change may be made, but a power cut could undo it; send the request again");
        orl_reply_error(request, &why);
    }
    orl_request_resume(request);
}

void orl_reply_when_durable(struct orl_request *request)
{
    struct orl_wal_sync *wal_sync = request->context->wal_sync;
    if (orl_wal_sync_is_durable(wal_sync, orl_wal_sync_last_commit(wal_sync)))
        return;
    if (!orl_request_set_pending(request, NULL, NULL))
        return;
    request->sync_wait.synced = on_synced;
    orl_wal_sync_request(wal_sync, &request->sync_wait);
}

void orl_reply_when_commit_durable(struct orl_request *request, uint64_t commit)
{
    if (!orl_wal_sync_is_durable(request->context->wal_sync, commit))
        orl_reply_when_durable(request);
}

bool orl_reply_if_full(struct orl_request *request, uint64_t bytes)
{
    if (request->context->disk_full)
        refuse_disk(request);
    else if (request->context->calls->reserve_storage(request->server, &request->reservation,
                                                      bytes))
        return false;
    else
        refuse_full(request, bytes);
    return true;
}

void *orl_request_new_state(struct orl_request *request, size_t size,
                            void (*free_state)(void *state))
{
    request->state = calloc(1, size);
    if (request->state)
        request->free_state = free_state;
    else
        orl_reply_json(request, 503, NULL);
    return request->state;
}

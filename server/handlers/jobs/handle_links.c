/* POST /v1/jobs/{id}/links: signed links to files of its results, for a limited time. */
#include "handlers/handlers.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handlers/jobs/job_status.h"
#include "http/access/access.h"
#include "http/context.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"
#include "schemas.h"
#include "server.h"
#include "json/decode.h"
#include "json/encode.h"

struct link_request {
    char **files; /* owned */
    size_t count;
    uint32_t seconds;
};

static int decode_name(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_text_of(value, path, orl_schema_link_request_files.items, into, err);
}

static int read_link_request(const json_t *doc, struct link_request *link_request,
                             struct orl_error *err)
{
    const struct orl_json_list files = {.items = &link_request->files,
                                        .count = &link_request->count,
                                        .size = sizeof *link_request->files,
                                        .each = decode_name};
    const struct orl_json_member members[] = {
        {"files", .list = &files}, {"seconds", .whole_32 = &link_request->seconds}, {0}};
    return orl_json_members(doc, "", &orl_schema_link_request, members, err);
}

/* Returns {"file", "url"}; NULL when out of memory. */
static json_t *link_to_json(const struct orl_request *request, const char *job, const char *file,
                            int64_t until_s)
{
    char arguments[ORL_LINK_ARGUMENTS], *text = NULL;
    json_t *url = orl_job_file_url(job, file), *link = NULL;
    if (request->context->config->needs_token) {
        orl_link_sign(request, job, file, until_s, arguments);
        if (asprintf(&text, "%s?%s", json_string_value(url), arguments) < 0)
            text = NULL;
        json_decref(url);
        url = text ? json_string(text) : NULL;
        free(text);
    }
    link = json_pack("{s:s, s:o}", "file", file, "url", url);
    return link;
}

static json_t *links_to_json(const struct orl_request *request, const struct orl_jobs_job *job,
                             const struct link_request *link_request)
{
    const int64_t until_s = orl_time_now_ms() / 1000 + link_request->seconds;
    char expires[ORL_TIME_TEXT];
    json_t *links = json_array();
    for (size_t i = 0; i < link_request->count && links; i++)
        links = orl_json_append(
            links, link_to_json(request, job->row.id, link_request->files[i], until_s));
    orl_time_format(1000 * until_s, expires);
    return json_pack("{s:s, s:o}", "expires", expires, "links", links);
}

static void reply_links(struct orl_request *request, const json_t *doc)
{
    struct link_request link_request = {.seconds =
                                            (uint32_t)orl_schema_link_request_seconds.preset};
    struct orl_error err;
    const struct orl_jobs_job *job = orl_job_of_path(request);
    if (!job)
        return;
    if (read_link_request(doc, &link_request, &err))
        orl_reply_error(request, &err);
    else
        orl_reply_json(request, 201, links_to_json(request, job, &link_request));
    orl_reply_header(request, "Cache-Control", "no-store");
    for (size_t i = 0; i < link_request.count; i++)
        free(link_request.files[i]);
    free(link_request.files);
}

void orl_handle_job_links(struct orl_request *request)
{
    struct orl_error err;
    struct orl_file body;
    json_t *doc = NULL;
    /* The body is small enough to stay in memory, so this reads no file on the loop. */
    int rc = orl_body_view(&request->body, &request->server->folders, &body, &err);
    if (rc == 0)
        rc = orl_json_parse(NULL, body.data, body.size, &doc, &err);
    if (rc)
        orl_reply_error(request, &err);
    else
        reply_links(request, doc);
    json_decref(doc);
}

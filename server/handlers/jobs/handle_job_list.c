#include "handlers/handlers.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/base/json_read.h>

#include "handlers/jobs/job_status.h"
#include "http/response/reply.h"
#include "job/job_json.h"
#include "process/limits.h"
#include "process/times.h"
#include "server.h"
#include "json/encode.h"

/* Maximum number of tags in a filter, so that the next link fits a header. */
enum { FILTER_TAGS = 4 };

struct filter {
    const char *state;             /* NULL: any */
    const char *scene;             /* NULL: any */
    const char *tags[FILTER_TAGS]; /* all of them */
    size_t n_tags;
    bool wrong_tag;
    int64_t since_ms; /* created at that time or later */
    unsigned long limit;
    const struct orl_jobs_job *first;
};

/* ---- Arguments ------------------------------------------------------------------------------ */

static enum MHD_Result add_tag(void *ctx, enum MHD_ValueKind kind, const char *key,
                               const char *value)
{
    struct filter *filter = ctx;
    (void)kind;
    if (strcmp(key, "tag") != 0)
        return MHD_YES;
    if (!value || !orl_label_is_tag(value) || filter->n_tags == FILTER_TAGS)
        filter->wrong_tag = true;
    else
        filter->tags[filter->n_tags++] = value;
    return filter->wrong_tag ? MHD_NO : MHD_YES;
}

/* Reads ?before=, the id of an existing job, or ?cursor= of a next link, whose job may be gone. */
static bool read_position(struct orl_request *request, struct filter *filter)
{
    const struct orl_jobs *jobs = request->server->jobs;
    const char *before = orl_request_query(request, "before");
    const char *cursor = orl_request_query(request, "cursor");
    const struct orl_jobs_job *last = before ? orl_jobs_find(jobs, before) : NULL;
    if (before && !last)
        return orl_page_refuse(request, "before must be the id of an existing job");
    filter->first = last ? last->older : orl_jobs_newest(jobs);
    if (!cursor)
        return true;
    const size_t digits = strspn(cursor, "0123456789");
    if (digits == 0 || digits > 18 || cursor[digits])
        return orl_page_refuse(request, "cursor must be copied from the link to the next page");
    const int64_t seq = strtoll(cursor, NULL, 10);
    while (filter->first && filter->first->row.seq >= seq)
        filter->first = filter->first->older;
    return true;
}

/* Reads the filter. Returns false after a 400. */
static bool read_filter(struct orl_request *request, struct filter *filter)
{
    const char *since = orl_request_query(request, "since");
    filter->scene = orl_request_query(request, "scene");
    filter->state = orl_request_query(request, "state");
    if (filter->state && strcmp(filter->state, orl_jobs_cancelling) != 0 &&
        orl_job_state_from_name(filter->state) == ORL_JOB_STATE_COUNT)
        return orl_page_refuse(
            request, "state must be queued, running, cancelling, succeeded, failed or cancelled");
    if (filter->scene && !orl_is_sha256(filter->scene))
        return orl_page_refuse(request, "scene must be the id of a scene, 64 hexadecimal digits");
    if (since && !orl_time_parse(since, &filter->since_ms))
        return orl_page_refuse(request,
                               "since must be a time in UTC, such as 2024-03-22T11:30:00Z");
    MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_tag, filter);
    if (filter->wrong_tag)
        return orl_page_refuse(request, "tag must be a job's tag; at most 4 may be given");
    return orl_page_limit(request, &filter->limit) && read_position(request, filter);
}

static bool is_wanted(const struct filter *filter, const struct orl_jobs_job *job)
{
    const struct orl_job_row *row = &job->row;
    bool wanted = (!filter->state || strcmp(orl_jobs_state_name(job), filter->state) == 0) &&
                  (!filter->scene || strcmp(row->scene, filter->scene) == 0) &&
                  row->created_ms >= filter->since_ms;
    for (size_t i = 0; i < filter->n_tags && wanted; i++)
        wanted = orl_labels_have(row->tags, filter->tags[i]);
    return wanted;
}

/* ---- The list ------------------------------------------------------------------------------- */

struct list {
    FILE *text;
    bool summary;
    const struct orl_jobs_job *last; /* last job in the list */
    unsigned long count;
};

/* Returns the text of a job's document, borrowed or in *ret_made; NULL when out of memory. */
static const char *job_text(struct orl_server *server, const struct orl_jobs_job *job, bool summary,
                            char **ret_made, size_t *ret_size)
{
    if (!summary && job->row.state >= ORL_JOB_SUCCEEDED)
        return orl_status_cache_text(server->statuses, server->jobs, job, ret_size);
    json_t *doc = summary ? orl_job_summary(server->jobs, job) : orl_job_status(server->jobs, job);
    *ret_made = orl_json_text(doc, JSON_COMPACT | JSON_REAL_PRECISION(10));
    *ret_size = *ret_made ? strlen(*ret_made) : 0;
    json_decref(doc);
    return *ret_made;
}

/* Appends a job's document to the list. Returns false if it does not fit or there is no memory. */
static bool add_to_list(struct orl_server *server, const struct orl_jobs_job *job,
                        struct list *list)
{
    size_t size = 0;
    char *made = NULL;
    const char *shown = job_text(server, job, list->summary, &made, &size);
    const long used = ftell(list->text);
    const bool fits = shown && (list->count == 0 || (size_t)used + size < ORL_SERVER_LIST_BYTES);
    if (fits) {
        fprintf(list->text, "%s%.*s", list->count == 0 ? "" : ",", (int)size, shown);
        list->last = job;
        list->count++;
    }
    free(made);
    return fits;
}

/* Writes the jobs that match the filter. Returns true if there are more. */
static bool write_jobs(struct orl_server *server, const struct filter *filter, struct list *list)
{
    bool more = false;
    fputs("{\"jobs\":[", list->text);
    for (const struct orl_jobs_job *job = filter->first; job && !more; job = job->older)
        if (is_wanted(filter, job))
            more = list->count == filter->limit || !add_to_list(server, job, list);
    fprintf(list->text, "],\"more\":%s}", more ? "true" : "false");
    return more;
}

/* Replies with the list. Summaries are polled, so an unchanged list is not sent again. */
static void reply_list(struct orl_request *request, const char *text, size_t size, bool summary)
{
    char tag[ORL_SHA_HEX];
    if (summary && text)
        orl_sha256_hex(text, size, tag);
    if (summary && text && orl_reply_if_none_match(request, tag))
        return;
    orl_reply_json_text(request, 200, text, size);
    if (summary && text)
        orl_reply_etag(request, tag);
}

void orl_handle_job_list(struct orl_request *request)
{
    static const char *const link_arguments[] = {"fields", "limit", "scene", "since",
                                                 "state",  "tag",   NULL};
    struct filter filter = {.limit = 100};
    struct list list = {.text = NULL};
    const char *fields = orl_request_query(request, "fields");
    char *text = NULL, cursor[24];
    size_t size = 0;
    bool more = false;
    if (!read_filter(request, &filter))
        return;
    if (fields && strcmp(fields, "summary") != 0 && strcmp(fields, "all") != 0) {
        orl_page_refuse(request, "fields must be summary or all");
        return;
    }
    list.summary = fields && strcmp(fields, "summary") == 0;
    list.text = open_memstream(&text, &size);
    if (list.text)
        more = write_jobs(request->server, &filter, &list);
    if (list.text && fclose(list.text) != 0) {
        free(text);
        text = NULL;
    }
    reply_list(request, text, size, list.summary);
    free(text);
    if (more && list.last) {
        snprintf(cursor, sizeof cursor, "%lld", (long long)list.last->row.seq);
        orl_page_link(request, "/v1/jobs", link_arguments, cursor);
    }
    orl_reply_header(request, "Cache-Control", list.summary ? "no-cache" : "no-store");
}

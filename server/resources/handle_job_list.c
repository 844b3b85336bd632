#include "resources/handlers.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encode.h"
#include "http/query.h"
#include "http/reply.h"
#include "process/limits.h"
#include "resources/job_status.h"
#include "server.h"

/* ?state=, ?limit= and ?before=; false after a 400. */
static bool read_filter(struct orl_request *request, enum orl_job_state *ret_state,
                        unsigned long *ret_limit, const struct orl_jobs_job **ret_first)
{
    const struct orl_jobs *jobs = request->server->jobs;
    const char *before = orl_request_query(request, "before");
    const char *state = orl_request_query(request, "state");
    const char *limit = orl_request_query(request, "limit");
    if (state) {
        *ret_state = orl_job_state_from_name(state);
        if (*ret_state == ORL_JOB_STATE_COUNT) {
            orl_reply_problem(request, 400, "invalid", "The query is not understood",
                              "state is queued, running, succeeded, failed or cancelled");
            return false;
        }
    }
    if (limit && !orl_query_count(limit, ORL_SERVER_LIST, ret_limit)) {
        orl_reply_problem(request, 400, "invalid", "The query is not understood",
                          "limit is a number from 1 to %u", ORL_SERVER_LIST);
        return false;
    }
    const struct orl_jobs_job *last = before ? orl_jobs_find(jobs, before) : NULL;
    if (before && !last) {
        orl_reply_problem(request, 400, "invalid", "The query is not understood",
                          "before is the id of a job that is here");
        return false;
    }
    *ret_first = last ? last->older : orl_jobs_newest(jobs);
    return true;
}

/* One more job's document behind those in text; false: it does not fit, or there is no memory. */
static bool add_to_list(struct orl_server *server, const struct orl_jobs_job *job, FILE *text)
{
    size_t size = 0;
    char *made = NULL;
    const char *shown;
    if (job->row.state < ORL_JOB_SUCCEEDED) {
        json_t *doc = orl_job_status(server->jobs, job);
        made = doc ? orl_json_text(doc, JSON_COMPACT) : NULL;
        size = made ? strlen(made) : 0;
        json_decref(doc);
        shown = made;
    } else {
        shown = orl_status_cache_text(server->statuses, server->jobs, job, &size);
    }
    const long used = ftell(text);
    const bool fits = shown && (used < 16 || (size_t)used + size < ORL_SERVER_LIST_BYTES);
    if (fits)
        fprintf(text, "%s%.*s", used < 16 ? "" : ",", (int)size, shown);
    free(made);
    return fits;
}

void orl_handle_job_list(struct orl_request *request)
{
    const struct orl_jobs_job *first = NULL;
    enum orl_job_state state = ORL_JOB_STATE_COUNT;
    unsigned long limit = 100;
    if (!read_filter(request, &state, &limit, &first))
        return;
    if (limit > ORL_SERVER_LIST_AT_ONCE)
        limit = ORL_SERVER_LIST_AT_ONCE;
    char *text = NULL;
    size_t size = 0, count = 0;
    bool more = false;
    FILE *list = open_memstream(&text, &size);
    if (list)
        fputs("{\"jobs\":[", list);
    for (const struct orl_jobs_job *job = first; job && list && !more; job = job->older) {
        if (state != ORL_JOB_STATE_COUNT && job->row.state != state)
            continue;
        more = count == limit || !add_to_list(request->server, job, list);
        count++;
    }
    if (list)
        fprintf(list, "],\"more\":%s}", more ? "true" : "false");
    if (list && fclose(list) != 0) {
        free(text);
        text = NULL;
    }
    orl_reply_json_text(request, 200, text, size);
    free(text);
    orl_reply_header(request, "Cache-Control", "no-store");
}

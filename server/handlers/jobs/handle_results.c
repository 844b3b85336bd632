/*
 * GET /v1/jobs/{id}/result and /files/{name}: a job's results; GET /v1/jobs/{id}/document: its
 * document.
 */
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/json_read.h>
#include <sys/stat.h>

#include "handlers/handlers.h"
#include "handlers/jobs/job_status.h"
#include "http/response/reply.h"
#include "process/times.h"
#include "server.h"

static const char *type_of(const char *name)
{
    static const struct {
        const char *ending, *type;
    } types[] = {
        {".json", "application/json"}, {".png", "image/png"},      {".hdr", "image/vnd.radiance"},
        {".exr", "image/x-exr"},       {".res", "text/plain"},     {".dat", "text/plain"},
        {".csv", "text/csv"},          {".svg", "image/svg+xml"},  {".txt", "text/plain"},
        {".da", "text/plain"},         {".cda", "text/plain"},     {".udi", "text/plain"},
        {".ase", "text/plain"},        {".pdf", "application/pdf"}};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof types / sizeof *types; i++)
        if (strcmp(dot, types[i].ending) == 0)
            return types[i].type;
    return "application/octet-stream";
}

enum { TAG_MAX = 2 * ORL_PARAM_MAX };

/* The results that a request may read. */
struct found_results {
    const struct orl_jobs_job *job;
    bool running;              /* they change with every round */
    json_t *summary;           /* job_output.h; owned */
    char folder[ORL_PATH_MAX]; /* folder of the files */
};

/* Returns the summary's entry of that name; NULL: none. Only listed files are ever opened. */
static const json_t *find_listed(const struct found_results *found_results, const char *name)
{
    const json_t *entry;
    size_t i;
    json_array_foreach(json_object_get(found_results->summary, "files"), i, entry)
    {
        const char *listed = json_string_value(json_object_get(entry, "name"));
        if (listed && strcmp(listed, name) == 0)
            return entry;
    }
    return NULL;
}

/* Opens a file. A job that has just ended has moved its files to results/. */
static int open_file(struct orl_request *request, const struct found_results *found_results,
                     const char *name)
{
    char path[ORL_PATH_MAX];
    snprintf(path, sizeof path, "%.*s/%s", ORL_PATH_MAX - 256, found_results->folder, name);
    const int fd = orl_open_regular(path, O_RDONLY | O_NOFOLLOW);
    if (fd >= 0 || !found_results->running)
        return fd;
    orl_folders_path(&request->server->folders, path, "results/%s/%s", found_results->job->row.id,
                     name);
    return orl_open_regular(path, O_RDONLY | O_NOFOLLOW);
}

/* Writes the tag: the digest of the bytes. Results from before digests existed have the job and the
 * name; they never change once the job has succeeded. */
static void make_tag(const struct found_results *found_results, const json_t *entry,
                     char ret_tag[TAG_MAX])
{
    const char *sha = json_string_value(json_object_get(entry, "sha256"));
    if (sha)
        snprintf(ret_tag, TAG_MAX, "%s", sha);
    else
        snprintf(ret_tag, TAG_MAX, "%s/%s", found_results->job->row.id,
                 json_string_value(json_object_get(entry, "name")));
}

/* ---- Final files ---------------------------------------------------------------------------- */

/* A file being sent. The descriptor is closed with it, unless the reply has taken it. */
struct final_file {
    int fd;
    struct stat st;
    char sha[ORL_SHA_HEX], tag[TAG_MAX];
    const char *type;
    uint64_t commit; /* commit of the job's end, waited for before its results are sent */
    int rc;
    struct orl_error err;
};

static void final_file_free(void *state)
{
    struct final_file *file = state;
    if (file->fd >= 0)
        close(file->fd);
    free(file);
}

static void send_final(struct orl_request *request, struct final_file *file)
{
    const int fd = file->fd;
    file->fd = -1;
    orl_reply_file_range(request, fd, (uint64_t)file->st.st_size, file->type, file->tag);
    orl_reply_when_commit_durable(request, file->commit);
}

/* Verifies the file on the pool. */
static void verify_file(struct orl_request *request)
{
    struct final_file *file = request->state;
    file->rc = orl_verify_file(file->fd, file->sha, &file->err);
}

static void send_verified(struct orl_request *request)
{
    struct final_file *file = request->state;
    if (file->rc) {
        orl_error_at(&file->err, request->params[1][0] ? request->params[1] : "result.json", 0,
                     NULL);
        orl_reply_error(request, &file->err);
        return;
    }
    orl_verified_files_add(&request->server->verified, &file->st);
    send_final(request, file);
}

/* Replies with a final file. Takes ownership of the descriptor. A file without a digest, written by
 * an older version, is not verified. */
static void reply_final(struct orl_request *request, const struct orl_jobs_job *job, int fd,
                        const struct stat *st, const json_t *entry, const char *tag)
{
    const char *sha = json_string_value(json_object_get(entry, "sha256"));
    struct final_file *file = orl_request_new_state(request, sizeof *file, final_file_free);
    if (!file) {
        close(fd);
        return;
    }
    *file = (struct final_file){
        .fd = fd,
        .st = *st,
        .commit = job->commit,
        .type = type_of(json_string_value(json_object_get(entry, "name"))),
    };
    snprintf(file->sha, sizeof file->sha, "%s", sha ? sha : "");
    snprintf(file->tag, sizeof file->tag, "%s", tag);
    if (!sha || orl_verified_files_has(&request->server->verified, st))
        send_final(request, file);
    else
        orl_request_work(request, verify_file, send_verified);
}

/* ---- All results ---------------------------------------------------------------------------- */

/* Replies 409: there are no results, or not these yet. */
static void refuse_for_now(struct orl_request *request, const struct orl_jobs_job *job)
{
    const enum orl_job_state state = job->row.state;
    orl_reply_problem(request, 409, "no-result", "The job has no results", "its state is '%s'%s",
                      orl_jobs_state_name(job),
                      state <= ORL_JOB_RUNNING  ? "; ask again later"
                      : state == ORL_JOB_FAILED ? "; see \"error\" in its document"
                                                : "");
    if (state <= ORL_JOB_RUNNING)
        orl_reply_header(request, "Retry-After", "1");
}

static void send_file(struct orl_request *request, const struct found_results *found_results,
                      const json_t *entry)
{
    const char *name = json_string_value(json_object_get(entry, "name"));
    char tag[TAG_MAX];
    struct stat st;
    make_tag(found_results, entry, tag);
    if (!found_results->running && strcmp(request->method, "GET") == 0)
        orl_storage_fetched(&request->server->storage, found_results->job->row.id);
    if (!found_results->running && orl_reply_if_none_match(request, tag))
        return;
    const int fd = open_file(request, found_results, name);
    if (fd < 0 && errno == ENOENT &&
        found_results->running) { /* a cancelled job has removed its files */
        refuse_for_now(request, found_results->job);
        return;
    }
    if (fd < 0 || fstat(fd, &st) != 0) {
        struct orl_error err;
        orl_error_set(&err, ORL_ERR_IO, "a result file cannot be read: %s", strerror(errno));
        if (fd >= 0)
            close(fd);
        orl_reply_error(request, &err);
        return;
    }
    if (found_results->running) {
        orl_reply_file(request, fd, (uint64_t)st.st_size, type_of(name));
        orl_reply_header(request, "Cache-Control", "no-store");
    } else {
        reply_final(request, found_results->job, fd, &st, entry, tag);
    }
}

/* Replies 410: the results have been evicted. */
static void reply_evicted(struct orl_request *request, const struct orl_jobs_job *job)
{
    char when[ORL_TIME_TEXT];
    orl_time_format(job->row.evicted_ms, when);
    orl_reply_problem(request, 410, "results-evicted", "The results are gone",
                      "they were removed at %s to make room; submit the same document again to "
                      "compute them again",
                      when);
}

/* Returns the summary of the job's results as text that the caller owns; NULL: no results. */
static char *find_summary(struct orl_request *request, struct found_results *found_results)
{
    const struct orl_jobs_job *job = found_results->job;
    found_results->running = job->row.state == ORL_JOB_RUNNING;
    if (found_results->running)
        return orl_jobs_worker(job)
                   ? orl_worker_results(orl_jobs_worker(job), found_results->folder)
                   : NULL;
    orl_folders_path(&request->server->folders, found_results->folder, "results/%s", job->row.id);
    return job->row.state != ORL_JOB_FAILED && job->outcome ? strdup(job->outcome) : NULL;
}

/* Finds the job's results. Returns false after a 404, 409 or 503. A job has results after its first
 * round or view, when it has succeeded, and when it was cancelled with some skies finished. */
static bool find_results(struct orl_request *request, struct found_results *ret_shown)
{
    struct found_results found_results = {.job = orl_job_of_path(request)};
    if (!found_results.job)
        return false;
    char *text = find_summary(request, &found_results);
    found_results.summary = orl_json_read_stored(text);
    free(text);
    if (found_results.summary) {
        *ret_shown = found_results;
        return true;
    }
    if (text || (!found_results.running && found_results.job->outcome))
        orl_reply_json(request, 503, NULL);
    else
        refuse_for_now(request, found_results.job);
    return false;
}

static void send_results(struct orl_request *request, const char *name)
{
    struct found_results found_results;
    if (!find_results(request, &found_results))
        return;
    const json_t *entry = find_listed(&found_results, name);
    if (entry && !found_results.running && found_results.job->row.evicted_ms > 0)
        reply_evicted(request, found_results.job);
    else if (entry)
        send_file(request, &found_results, entry);
    else if (found_results.running && strcmp(name, "result.json") == 0)
        refuse_for_now(request, found_results.job);
    else
        orl_reply_not_found(request, "result file");
    json_decref(found_results.summary);
}

void orl_handle_job_result(struct orl_request *request)
{
    send_results(request, "result.json");
}

void orl_handle_job_file(struct orl_request *request)
{
    send_results(request, request->params[1]);
}

/* ---- The document ---------------------------------------------------------------------------- */

/* Sends the submitted document, byte for byte, so that it can be submitted again. */

void orl_handle_job_document(struct orl_request *request)
{
    const struct orl_jobs_job *job = orl_job_of_path(request);
    char path[ORL_PATH_MAX];
    struct stat st;
    if (!job || orl_reply_if_none_match(request, job->row.document))
        return;
    orl_blob_path(&request->server->folders, job->row.document, path);
    const int fd = orl_open_regular(path, O_RDONLY | O_NOFOLLOW);
    if (fd < 0 || fstat(fd, &st) != 0) {
        struct orl_error err;
        orl_error_set(&err, ORL_ERR_IO, "the job's document cannot be read: %s",
                      orl_open_reason(errno));
        if (fd >= 0)
            close(fd);
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_file(request, fd, (uint64_t)st.st_size, "application/json");
    orl_reply_etag(request, job->row.document);
    orl_reply_header(request, "Cache-Control", "no-cache");
}

#include "handlers.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "reply.h"
#include "server.h"

static const char *type_of(const char *name)
{
    static const struct {
        const char *ending, *type;
    } types[] = {{".json", "application/json"},
                 {".png", "image/png"},
                 {".hdr", "image/vnd.radiance"},
                 {".csv", "text/csv"},
                 {".svg", "image/svg+xml"}};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof types / sizeof *types; i++)
        if (strcmp(dot, types[i].ending) == 0)
            return types[i].type;
    return "application/octet-stream";
}

/* What a request for results may be given. */
struct shown {
    const struct orl_jobs_job *job;
    bool running;              /* they change with every round */
    json_t *summary;           /* job_output.h; owned */
    char folder[ORL_PATH_MAX]; /* where they are */
};

/* Is name one of the files the job's summary lists? Nothing else is ever opened. */
static bool is_listed(const struct shown *shown, const char *name)
{
    const json_t *entry;
    size_t i;
    json_array_foreach(json_object_get(shown->summary, "files"), i, entry)
    {
        const char *listed = json_string_value(json_object_get(entry, "name"));
        if (listed && strcmp(listed, name) == 0)
            return true;
    }
    return false;
}

/* A job that ends at this moment has moved its results to where they stay. */
static int open_file(struct orl_request *request, const struct shown *shown, const char *name)
{
    char path[ORL_PATH_MAX];
    snprintf(path, sizeof path, "%.*s/%s", ORL_PATH_MAX - 256, shown->folder, name);
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (fd >= 0 || !shown->running)
        return fd;
    orl_folders_path(&request->server->folders, path, "results/%s/%s", shown->job->row.id, name);
    return open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
}

/* Results never change once the job has succeeded, so it and the name make a strong tag. */
static void send_file(struct orl_request *request, const struct shown *shown, const char *name)
{
    char tag[2 * ORL_PARAM_MAX];
    struct stat st;
    snprintf(tag, sizeof tag, "%s/%s", shown->job->row.id, name);
    if (!shown->running && orl_reply_if_none_match(request, tag))
        return;
    const int fd = open_file(request, shown, name);
    if (fd < 0 || fstat(fd, &st) != 0) {
        struct orl_error err;
        orl_error_set(&err, ORL_ERR_IO, "a result file cannot be read: %s", strerror(errno));
        if (fd >= 0)
            close(fd);
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_file(request, fd, (uint64_t)st.st_size, type_of(name));
    if (shown->running)
        orl_reply_header(request, "Cache-Control", "no-store");
    else
        orl_reply_etag(request, tag);
}

/* The summary of what the job has to show, as text that is the caller's; NULL: nothing. */
static char *find_summary(struct orl_request *request, struct shown *shown)
{
    const struct orl_jobs_job *job = shown->job;
    shown->running = job->row.state == ORL_JOB_RUNNING;
    if (shown->running)
        return orl_jobs_worker(job) ? orl_worker_results(orl_jobs_worker(job), shown->folder)
                                    : NULL;
    orl_folders_path(&request->server->folders, shown->folder, "results/%s", job->row.id);
    return job->row.state == ORL_JOB_SUCCEEDED && job->outcome ? strdup(job->outcome) : NULL;
}

/* 409: nothing, or not that yet. */
static void refuse_for_now(struct orl_request *request, const struct orl_jobs_job *job)
{
    const enum orl_job_state state = job->row.state;
    orl_reply_problem(request, 409, "no-result", "The job has no results", "its state is '%s'%s",
                      orl_job_state_name(state),
                      state <= ORL_JOB_RUNNING ? "; ask again later" : "");
    if (state <= ORL_JOB_RUNNING)
        orl_reply_header(request, "Retry-After", "1");
}

/* False after a 404 or 409. A job has results when it has succeeded, or after its first
 * round or view. */
static bool find_results(struct orl_request *request, struct shown *ret_shown)
{
    struct shown shown = {.job = orl_jobs_find(request->server->jobs, request->params[0])};
    if (!shown.job) {
        orl_reply_not_found(request, "job");
        return false;
    }
    char *text = find_summary(request, &shown);
    shown.summary = text ? json_loads(text, 0, NULL) : NULL;
    free(text);
    if (shown.summary) {
        *ret_shown = shown;
        return true;
    }
    refuse_for_now(request, shown.job);
    return false;
}

static void send_results(struct orl_request *request, const char *name)
{
    struct shown shown;
    if (!find_results(request, &shown))
        return;
    if (is_listed(&shown, name))
        send_file(request, &shown, name);
    else if (shown.running && strcmp(name, "result.json") == 0)
        refuse_for_now(request, shown.job);
    else
        orl_reply_not_found(request, "result file");
    json_decref(shown.summary);
}

void orl_handle_job_result(struct orl_request *request)
{
    send_results(request, "result.json");
}

void orl_handle_job_file(struct orl_request *request)
{
    send_results(request, request->params[1]);
}

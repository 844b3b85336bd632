#include "handlers.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
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

/* Is name one of the files the job's outcome lists? Nothing else is ever opened. */
static bool is_listed(const struct orl_jobs_job *job, const char *name)
{
    json_t *outcome = job->outcome ? json_loads(job->outcome, 0, NULL) : NULL;
    json_t *entry;
    size_t i;
    bool found = false;
    json_array_foreach(json_object_get(outcome, "files"), i, entry)
    {
        const char *listed = json_string_value(json_object_get(entry, "name"));
        found |= listed && strcmp(listed, name) == 0;
    }
    json_decref(outcome);
    return found;
}

/* Results never change once they are there, so the job and the name make a strong tag. */
static void send_file(struct orl_request *request, const struct orl_jobs_job *job, const char *name)
{
    char path[ORL_PATH_MAX], tag[2 * ORL_PARAM_MAX];
    struct stat st;
    snprintf(tag, sizeof tag, "%s/%s", job->row.id, name);
    if (orl_reply_if_none_match(request, tag))
        return;
    orl_folders_path(&request->server->folders, path, "results/%s/%s", job->row.id, name);
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (fd < 0 || fstat(fd, &st) != 0) {
        struct orl_error err;
        orl_error_set(&err, ORL_ERR_IO, "a result file cannot be read: %s", strerror(errno));
        if (fd >= 0)
            close(fd);
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_file(request, fd, (uint64_t)st.st_size, type_of(name));
    orl_reply_etag(request, tag);
}

/* The job, if it has results; NULL after a 404 or 409. */
static const struct orl_jobs_job *find_succeeded(struct orl_request *request)
{
    const struct orl_jobs_job *job = orl_jobs_find(request->server->jobs, request->params[0]);
    if (!job) {
        orl_reply_not_found(request, "job");
        return NULL;
    }
    if (job->row.state == ORL_JOB_SUCCEEDED)
        return job;
    orl_reply_problem(request, 409, "no-result", "The job has no results", "its state is '%s'%s",
                      orl_job_state_name(job->row.state),
                      job->row.state <= ORL_JOB_RUNNING ? "; ask again later" : "");
    if (job->row.state <= ORL_JOB_RUNNING)
        orl_reply_header(request, "Retry-After", "1");
    return NULL;
}

void orl_handle_job_result(struct orl_request *request)
{
    const struct orl_jobs_job *job = find_succeeded(request);
    if (job)
        send_file(request, job, "result.json");
}

void orl_handle_job_file(struct orl_request *request)
{
    const struct orl_jobs_job *job = find_succeeded(request);
    if (!job)
        return;
    if (is_listed(job, request->params[1]))
        send_file(request, job, request->params[1]);
    else
        orl_reply_not_found(request, "result file");
}

#include "jobs/job_results.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sys/stat.h>

#include "jobs/job_runs.h"

void orl_dedup_follow(struct orl_jobs_job *leader, struct orl_jobs_job *job)
{
    struct orl_jobs_job **at = &leader->followers;
    while (*at)
        at = &(*at)->next_follower;
    *at = job;
    job->leader = leader;
    job->next_follower = NULL;
}

void orl_dedup_leave(struct orl_jobs_job *job)
{
    struct orl_jobs_job **at = &job->leader->followers;
    while (*at != job)
        at = &(*at)->next_follower;
    *at = job->next_follower;
    job->leader = NULL;
    job->next_follower = NULL;
}

/* ---- Copies of the results ------------------------------------------------------------------- */

static int link_below(const char *from, const char *to, struct orl_error *err);

/* Links a file, or a folder with all its contents. */
static int link_entry(const struct dirent *entry, const char *from, const char *to,
                      struct orl_error *err)
{
    char source[ORL_PATH_MAX + 256], target[ORL_PATH_MAX + 256];
    snprintf(source, sizeof source, "%s/%s", from, entry->d_name);
    snprintf(target, sizeof target, "%s/%s", to, entry->d_name);
    struct stat st;
    if (lstat(source, &st) == 0 && S_ISDIR(st.st_mode) && mkdir(target, 0777) == 0) {
        const int rc = link_below(source, target, err);
        return rc ? rc : orl_sync_path(target, err);
    }
    if (link(source, target) == 0)
        return 0;
    return orl_error_set(err, orl_err_of_errno(errno), "cannot share the results: %s",
                         strerror(errno));
}

static int link_below(const char *from, const char *to, struct orl_error *err)
{
    DIR *folder = opendir(from);
    int rc = 0;
    if (!folder)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot share the results: %s",
                             strerror(errno));
    for (const struct dirent *entry; rc == 0 && (entry = readdir(folder));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            rc = link_entry(entry, from, to, err);
    closedir(folder);
    return rc;
}

/* Gives a job the results of another: links to the same files, in a folder of its own. */
static int link_job_results(const struct orl_folders *folders, const char *from, const char *to,
                            struct orl_error *err)
{
    char source[ORL_PATH_MAX], target[ORL_PATH_MAX], temporary[ORL_PATH_MAX];
    orl_folders_path(folders, source, "results/%s", from);
    orl_folders_path(folders, target, "results/%s", to);
    orl_folders_temporary(folders, temporary);
    if (mkdir(temporary, 0777) != 0)
        return orl_error_set(err, orl_err_of_errno(errno),
                             "cannot make a folder for the results: %s", strerror(errno));
    int rc = link_below(source, temporary, err);
    if (rc == 0)
        rc = orl_sync_path(temporary, err);
    if (rc == 0)
        rc = orl_remove_tree(target, err); /* left by an earlier attempt */
    if (rc == 0)
        rc = orl_rename_synced(temporary, target, err);
    if (rc)
        orl_remove_tree(temporary, NULL);
    return rc;
}

struct copy {
    char id[ORL_JOB_ID];
    int code;
    struct orl_error err;
};

struct orl_result_fanout {
    uv_work_t work;
    struct orl_jobs_job *leader;
    struct orl_worker_outcome outcome;
    orl_result_fanout_done *done;
    size_t count;
    struct copy copies[];
};

static void link_results(uv_work_t *work)
{
    struct orl_result_fanout *fanout = work->data;
    const struct orl_folders *folders = fanout->leader->jobs->env.folders;
    for (size_t i = 0; i < fanout->count; i++) {
        struct copy *copy = &fanout->copies[i];
        copy->code = link_job_results(folders, fanout->leader->row.id, copy->id, &copy->err);
    }
}

static void end_fanout(uv_work_t *work, int status)
{
    struct orl_result_fanout *fanout = work->data;
    const struct orl_jobs *jobs = fanout->leader->jobs;
    (void)status;
    fanout->leader->finishing = false;
    for (size_t i = 0; i < fanout->count; i++) {
        const struct orl_jobs_job *job = orl_jobs_lookup(jobs, fanout->copies[i].id);
        if (!job || job->leader != fanout->leader) /* it was cancelled meanwhile */
            orl_job_results_remove_files(jobs, fanout->copies[i].id);
    }
    fanout->done(fanout->leader, &fanout->outcome, fanout);
    free(fanout);
}

bool orl_result_fanout_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                             orl_result_fanout_done *done)
{
    size_t count = 0;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        count++;
    struct orl_result_fanout *fanout =
        count > 0 ? calloc(1, sizeof *fanout + count * sizeof *fanout->copies) : NULL;
    if (!fanout)
        return false;
    fanout->work.data = fanout;
    fanout->leader = leader;
    fanout->outcome = *outcome;
    fanout->done = done;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        memcpy(fanout->copies[fanout->count++].id, job->row.id, sizeof job->row.id);
    leader->finishing = true;
    uv_queue_work(leader->jobs->env.loop, &fanout->work, link_results, end_fanout);
    return true;
}

int orl_result_fanout_find(const struct orl_result_fanout *fanout,
                           const struct orl_jobs_job *leader, const struct orl_jobs_job *job,
                           struct orl_error *ret_err)
{
    for (size_t i = 0; fanout && i < fanout->count; i++)
        if (strcmp(fanout->copies[i].id, job->row.id) == 0) {
            *ret_err = fanout->copies[i].err;
            return fanout->copies[i].code;
        }
    return link_job_results(job->jobs->env.folders, leader->row.id, job->row.id, ret_err);
}

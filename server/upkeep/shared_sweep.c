#include "upkeep/shared_sweep.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>

#include "parts/sharing.h"
#include "process/times.h"

enum { ID = 32 };

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static void sweep_work(uv_work_t *work)
{
    struct orl_shared_sweep *sweep = work->data;
    sweep->rc = orl_sharing_abandon(sweep->folder, now_s, &sweep->err);
}

/* One that cannot be swept is tried again when the next job ends. */
static void sweep_back(uv_work_t *work, int status)
{
    struct orl_shared_sweep *sweep = work->data;
    (void)status;
    sweep->busy = false;
    if (sweep->rc == 0) {
        orl_log_event(sweep->log, ORL_LOG_INFO, "parts-swept", "s", "folder", sweep->folder);
        return;
    }
    sweep->wanted = false;
    orl_log_event(sweep->log, ORL_LOG_WARN, "parts-left", "sss", "folder", sweep->folder, "why",
                  sweep->err.message, "hint", sweep->err.hint);
}

/* A job's folder has its id for a name, maybe with an ending, as while it is laid out. */
static bool is_stale(const struct orl_jobs *jobs, const char *name)
{
    char id[ID + 1];
    if (strspn(name, "0123456789abcdef") != ID)
        return false;
    snprintf(id, sizeof id, "%.*s", ID, name);
    const struct orl_jobs_job *job = orl_jobs_find(jobs, id);
    return !job || orl_jobs_ended(job);
}

static bool find_stale(struct orl_shared_sweep *sweep)
{
    DIR *entries = opendir(sweep->place->folder);
    bool found = false;
    for (const struct dirent *entry; entries && !found && (entry = readdir(entries)) != NULL;) {
        found = is_stale(sweep->jobs, entry->d_name);
        if (found)
            snprintf(sweep->folder, sizeof sweep->folder, "%.*s/%.64s", ORL_PATH_MAX - 80,
                     sweep->place->folder, entry->d_name);
    }
    if (entries)
        closedir(entries);
    return found;
}

void orl_shared_sweep_look(struct orl_shared_sweep *sweep, uv_loop_t *loop)
{
    if (!sweep->place || !sweep->wanted || sweep->busy)
        return;
    sweep->wanted = find_stale(sweep);
    if (!sweep->wanted)
        return;
    sweep->work.data = sweep;
    sweep->busy = uv_queue_work(loop, &sweep->work, sweep_work, sweep_back) == 0;
}

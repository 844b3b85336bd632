#include "maintenance/retention.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "distributed/distributed_job.h"
#include "process/times.h"
#include "store/files/removal.h"

int orl_retention_open(struct orl_retention *retention, struct orl_db *db,
                       struct orl_folders *folders, const struct orl_log *log,
                       uint32_t keep_orphans_days, struct orl_error *err)
{
    *retention = (struct orl_retention){
        .folders = folders, .log = log, .keep_orphans_days = keep_orphans_days};
    const int rc = orl_retention_clock_open(&retention->clock, db, err);
    const int64_t now_ms = rc ? 0 : orl_retention_clock_ms(&retention->clock);
    /* Dating orphans by the later of the two clocks makes them never seem older than they are. */
    if (now_ms > folders->start_ms)
        folders->start_ms = now_ms;
    return rc;
}

void orl_retention_log_orphans(const struct orl_retention *retention)
{
    char path[ORL_PATH_MAX];
    const struct orl_orphans_found found = orl_orphans_count(retention->folders);
    if (found.files == 0)
        return;
    orl_orphans_path(retention->folders, path);
    orl_log_event(retention->log, ORL_LOG_WARN, "orphans-set-aside", "siii", "folder", path,
                  "files", (int64_t)found.files, "bytes", (int64_t)found.bytes, "kept_days",
                  (int64_t)retention->keep_orphans_days);
}

void orl_retention_tick(struct orl_retention *retention, uv_loop_t *loop)
{
    enum { HOUR_MS = 3600000 };
    const int64_t now_ms = orl_retention_clock_ms(&retention->clock);
    orl_retention_clock_tick(&retention->clock);
    if (retention->purged_ms != 0 && now_ms - retention->purged_ms < HOUR_MS)
        return;
    retention->purged_ms = now_ms;
    orl_orphans_purge(loop, retention->folders, now_ms, retention->keep_orphans_days);
}

void orl_retention_close(struct orl_retention *retention)
{
    if (retention->clock.db)
        orl_retention_clock_save(&retention->clock);
}

/* ---- Shared folders of jobs in parts --------------------------------------------------------- */

enum { ID = 32 };

static void sweep_work(uv_work_t *work)
{
    struct orl_shared_sweep *sweep = work->data;
    sweep->rc = orl_distributed_job_abandon(sweep->folder, orl_time_steady_for, &sweep->err);
}

/* Ends a sweep. A folder that cannot be swept is tried again when the next job ends. */
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

/* Reads the id from a folder's name, which may have a suffix while the folder is set up. */
static bool read_id(const char *name, char ret_id[ORL_JOB_ID])
{
    snprintf(ret_id, ORL_JOB_ID, "%.*s", ID, name);
    return strspn(name, "0123456789abcdef") == ID;
}

static bool is_stale(const struct orl_shared_sweep *sweep, const char *name)
{
    char id[ORL_JOB_ID];
    if (!read_id(name, id))
        return false;
    for (size_t i = 0; i < sweep->n_unknown; i++)
        if (strcmp(sweep->unknown[i], id) == 0)
            return false;
    const struct orl_jobs_job *job = orl_jobs_find(sweep->jobs, id);
    return !job || orl_jobs_ended(job);
}

/* Lists the folders of unknown jobs. Returns false without memory for the list. */
static bool list_unknown(struct orl_shared_sweep *sweep)
{
    DIR *entries = opendir(sweep->slurm->folder);
    bool fits = true;
    for (const struct dirent *entry; entries && fits && (entry = readdir(entries)) != NULL;) {
        char id[ORL_JOB_ID];
        if (!read_id(entry->d_name, id) || orl_jobs_find(sweep->jobs, id))
            continue;
        char(*grown)[ORL_JOB_ID] =
            realloc(sweep->unknown, (sweep->n_unknown + 1) * sizeof *sweep->unknown);
        fits = grown != NULL;
        if (!fits)
            break;
        sweep->unknown = grown;
        memcpy(sweep->unknown[sweep->n_unknown++], id, sizeof id);
        orl_log_event(sweep->log, ORL_LOG_WARN, "parts-unknown", "ss", "folder", entry->d_name,
                      "hint",
                      "the database has no job for it; remove it if no other daemon uses it");
    }
    if (entries)
        closedir(entries);
    return fits;
}

static bool find_stale(struct orl_shared_sweep *sweep)
{
    DIR *entries = opendir(sweep->slurm->folder);
    bool found = false;
    for (const struct dirent *entry; entries && !found && (entry = readdir(entries)) != NULL;) {
        found = is_stale(sweep, entry->d_name);
        if (found)
            snprintf(sweep->folder, sizeof sweep->folder, "%.*s/%.64s", ORL_PATH_MAX - 80,
                     sweep->slurm->folder, entry->d_name);
    }
    if (entries)
        closedir(entries);
    return found;
}

void orl_shared_sweep_step(struct orl_shared_sweep *sweep, uv_loop_t *loop)
{
    if (!sweep->slurm || !sweep->wanted || sweep->busy)
        return;
    sweep->searched_unknown = sweep->searched_unknown || list_unknown(sweep);
    sweep->wanted = sweep->searched_unknown && find_stale(sweep);
    if (!sweep->wanted)
        return;
    sweep->work.data = sweep;
    sweep->busy = uv_queue_work(loop, &sweep->work, sweep_work, sweep_back) == 0;
}

void orl_shared_sweep_done(struct orl_shared_sweep *sweep)
{
    free(sweep->unknown);
    sweep->unknown = NULL;
    sweep->n_unknown = 0;
}

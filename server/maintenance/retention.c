#include "maintenance/retention.h"

#include "store/files/orphans.h"

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

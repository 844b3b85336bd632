#include "upkeep/aging.h"

#include "store/orphans.h"

int orl_aging_open(struct orl_aging *aging, struct orl_db *db, struct orl_folders *folders,
                   const struct orl_log *log, uint32_t keep_orphans_days, struct orl_error *err)
{
    *aging =
        (struct orl_aging){.folders = folders, .log = log, .keep_orphans_days = keep_orphans_days};
    const int rc = orl_retention_clock_open(&aging->clock, db, err);
    const int64_t now_ms = rc ? 0 : orl_retention_clock_ms(&aging->clock);
    /* Dating orphans by the later of the two clocks makes them never seem older than they are. */
    if (now_ms > folders->start_ms)
        folders->start_ms = now_ms;
    return rc;
}

void orl_aging_log(const struct orl_aging *aging)
{
    char path[ORL_PATH_MAX];
    const struct orl_orphans_found found = orl_orphans_count(aging->folders);
    if (found.files == 0)
        return;
    orl_orphans_path(aging->folders, path);
    orl_log_event(aging->log, ORL_LOG_WARN, "orphans-set-aside", "siii", "folder", path, "files",
                  (int64_t)found.files, "bytes", (int64_t)found.bytes, "kept_days",
                  (int64_t)aging->keep_orphans_days);
}

void orl_aging_look(struct orl_aging *aging, uv_loop_t *loop)
{
    enum { HOUR_MS = 3600000 };
    const int64_t now_ms = orl_retention_clock_ms(&aging->clock);
    orl_retention_clock_tick(&aging->clock);
    if (aging->purged_ms != 0 && now_ms - aging->purged_ms < HOUR_MS)
        return;
    aging->purged_ms = now_ms;
    orl_orphans_purge(loop, aging->folders, now_ms, aging->keep_orphans_days);
}

void orl_aging_close(struct orl_aging *aging)
{
    if (aging->clock.db)
        orl_retention_clock_save(&aging->clock);
}

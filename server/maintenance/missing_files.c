#include "maintenance/missing_files.h"

#include <stdint.h>
#include <unistd.h>

enum { NAMED = 8 };

void orl_missing_files_log(struct orl_db *db, const struct orl_folders *folders,
                           const struct orl_log *log)
{
    char path[ORL_PATH_MAX];
    int64_t count = 0;
    sqlite3_stmt *stmt = orl_db_prepare(
        db, NULL,
        "SELECT 'blobs/' || substr(sha, 1, 2) || '/' || sha FROM (SELECT blob AS sha FROM "
        "scene_files UNION SELECT id FROM bsdfs UNION SELECT document FROM jobs) "
        "UNION ALL SELECT 'results/' || id FROM jobs WHERE outcome IS NOT NULL AND "
        "evicted_ms IS NULL AND state IN ('succeeded', 'cancelled')",
        "");
    while (stmt && sqlite3_step(stmt) == SQLITE_ROW) {
        orl_folders_path(folders, path, "%s", orl_db_text(stmt, 0));
        if (access(path, F_OK) == 0)
            continue;
        if (count++ < NAMED)
            orl_log_event(log, ORL_LOG_ERROR, "file-missing", "s", "file", orl_db_text(stmt, 0));
    }
    sqlite3_finalize(stmt);
    if (count > 0)
        orl_log_event(log, ORL_LOG_ERROR, "files-missing", "is", "count", count, "hint",
                      "put them back from a backup; an upload that is sent again mends its own");
}

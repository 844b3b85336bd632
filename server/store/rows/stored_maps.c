#include "store/rows/stored_maps.h"

#include <stdio.h>

int orl_map_row_put(struct orl_db *db, const struct orl_stored_map *map, struct orl_error *err)
{
    const struct orl_map_info *info = &map->info;
    return orl_db_run(db, err, NULL,
                      "INSERT OR REPLACE INTO maps (kind, key, emitted, stored, bytes, seconds, "
                      "hits, seconds_saved, created_ms, last_used_ms, family, target) "
                      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                      "ssiiididiisi", info->kind, info->key, (int64_t)info->emitted,
                      (int64_t)info->stored, (int64_t)info->bytes, info->seconds,
                      (int64_t)map->hits, map->seconds_saved, map->created_ms, map->last_used_ms,
                      info->family[0] ? info->family : NULL, (int64_t)info->target);
}

int orl_map_row_drop(struct orl_db *db, const char *kind, const char *key, struct orl_error *err)
{
    return orl_db_run(db, err, NULL, "DELETE FROM maps WHERE kind = ? AND key = ?", "ss", kind,
                      key);
}

static struct orl_stored_map read_row(sqlite3_stmt *stmt)
{
    struct orl_stored_map map = {
        .info = {.emitted = (uint64_t)sqlite3_column_int64(stmt, 2),
                 .stored = (uint64_t)sqlite3_column_int64(stmt, 3),
                 .bytes = (uint64_t)sqlite3_column_int64(stmt, 4),
                 .seconds = sqlite3_column_double(stmt, 5),
                 .target = (uint64_t)sqlite3_column_int64(stmt, 11)},
        .hits = (uint64_t)sqlite3_column_int64(stmt, 6),
        .seconds_saved = sqlite3_column_double(stmt, 7),
        .created_ms = sqlite3_column_int64(stmt, 8),
        .last_used_ms = sqlite3_column_int64(stmt, 9),
    };
    snprintf(map.info.kind, sizeof map.info.kind, "%s", orl_db_text(stmt, 0));
    snprintf(map.info.key, sizeof map.info.key, "%s", orl_db_text(stmt, 1));
    snprintf(map.info.family, sizeof map.info.family, "%s", orl_db_text(stmt, 10));
    return map;
}

int orl_map_rows(struct orl_db *db, int (*row)(void *ctx, const struct orl_stored_map *map),
                 void *ctx, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err,
        "SELECT kind, key, emitted, stored, bytes, seconds, hits, seconds_saved, created_ms, "
        "last_used_ms, family, target FROM maps ORDER BY last_used_ms DESC",
        "");
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const struct orl_stored_map map = read_row(stmt);
        rc = row(ctx, &map);
    }
    return orl_db_finish(db, stmt, rc, "cannot read the maps", err);
}

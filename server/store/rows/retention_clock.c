#include "store/rows/retention_clock.h"

#include <stddef.h>

#include "process/times.h"

enum { HOUR_MS = 3600000 };

int orl_retention_clock_open(struct orl_retention_clock *clock, struct orl_db *db,
                             struct orl_error *err)
{
    sqlite3_stmt *stmt =
        orl_db_prepare(db, err, "SELECT retained_ms, wall_ms FROM data_folder", "");
    if (!stmt)
        return ORL_ERR_IO;
    const int step = sqlite3_step(stmt);
    const int64_t retained_ms = sqlite3_column_int64(stmt, 0);
    int64_t pause_ms = orl_time_now_ms() - sqlite3_column_int64(stmt, 1);
    const int rc = step == SQLITE_ROW ? 0 : orl_db_error(db, "its clock cannot be read", err);
    sqlite3_finalize(stmt);
    if (rc)
        return rc;
    pause_ms = pause_ms < 0 ? 0 : pause_ms > HOUR_MS ? HOUR_MS : pause_ms;
    *clock = (struct orl_retention_clock){
        .db = db, .base_ms = retained_ms + pause_ms, .steady_ms = orl_time_steady_ms()};
    return 0;
}

int64_t orl_retention_clock_ms(const struct orl_retention_clock *clock)
{
    return clock->base_ms + orl_time_steady_ms() - clock->steady_ms;
}

void orl_retention_clock_save(struct orl_retention_clock *clock)
{
    const int64_t now_ms = orl_retention_clock_ms(clock);
    if (orl_db_run(clock->db, NULL, NULL, "UPDATE data_folder SET retained_ms = ?, wall_ms = ?",
                   "ii", now_ms, orl_time_now_ms()) == 0)
        clock->saved_ms = now_ms;
}

void orl_retention_clock_tick(struct orl_retention_clock *clock)
{
    if (orl_retention_clock_ms(clock) - clock->saved_ms >= HOUR_MS)
        orl_retention_clock_save(clock);
}

/*
 * The clock for the age of jobs and orphans. It starts with the wall clock and then counts the time
 * that a daemon runs, by the monotonic clock; a pause between two runs counts as an hour at most.
 * So a wall clock that jumps forwards, while the daemon runs or between two runs, makes nothing old
 * enough to be removed. One that jumps back makes nothing younger.
 *
 * The time is saved in the database once an hour and at the end. Time lost in a crash only keeps
 * things longer.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_STORE_ROWS_RETENTION_CLOCK_H
#define ORL_STORE_ROWS_RETENTION_CLOCK_H

#include <stdint.h>

#include "store/database/db.h"

struct orl_retention_clock {
    struct orl_db *db;
    int64_t base_ms; /* its time when the monotonic clock was at steady_ms */
    int64_t steady_ms;
    int64_t saved_ms;
};

/* Reads the time of a migrated database. Borrows db. */
int orl_retention_clock_open(struct orl_retention_clock *clock, struct orl_db *db,
                             struct orl_error *err);
/* Returns milliseconds comparable with those since 1970, but behind by the time lost in pauses. */
int64_t orl_retention_clock_ms(const struct orl_retention_clock *clock);
/* Saves the time if the last save was an hour ago; best effort. */
void orl_retention_clock_tick(struct orl_retention_clock *clock);
void orl_retention_clock_save(struct orl_retention_clock *clock);

#endif

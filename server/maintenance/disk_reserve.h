/*
 * Reserves disk space for the database, so that a daemon can start on a full disk and remove stored
 * files.
 *
 * The file oriel.reserve takes ORL_RESERVE_BYTES while there is space for it. A start with less
 * free space removes it before it opens the database, which needs space for its log and index. The
 * start then allocates most of that space after the end of the log, so rows can be deleted however
 * full the disk is. The disk counts as full if less than ORL_DISK_LEAST is free, or while the
 * reserve could not be made.
 *
 * On a full disk uploads and jobs are refused and no job starts; everything else continues.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_MAINTENANCE_DISK_RESERVE_H
#define ORL_SERVER_MAINTENANCE_DISK_RESERVE_H

#include <stdbool.h>

#include "process/log.h"
#include "store/files/folders.h"

#define ORL_RESERVE_BYTES (6L << 20)
/* More than the pages that are in the log at a checkpoint. */
#define ORL_WAL_RESERVE_BYTES (5L << 20)
#define ORL_DISK_LEAST (1L << 20)

struct orl_disk_reserve {
    const struct orl_folders *folders;
    const struct orl_log *log;
    bool reserved, full;
};

/* Opens the reserve, before the database is opened. Borrows both. */
void orl_disk_reserve_open(struct orl_disk_reserve *reserve, const struct orl_folders *folders,
                           const struct orl_log *log);
/* Allocates the log's space, once there is a log; best effort. */
void orl_disk_reserve_wal(const struct orl_disk_reserve *reserve);
/* Checks the disk; called about every second. Returns true if full has changed. */
bool orl_disk_reserve_check(struct orl_disk_reserve *reserve);
/* Makes the reserve for the next start. Call it after the database is closed, which removes the
 * log. */
void orl_disk_reserve_close(struct orl_disk_reserve *reserve); /* a zeroed struct is allowed */

#endif

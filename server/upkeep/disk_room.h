/*
 * Room on the disk for the database, so that a daemon starts on a full disk and can remove what is
 * kept there.
 *
 * The file oriel.reserve takes ORL_RESERVE_BYTES while there is room for it. A start that finds
 * less free gives them back before it opens the database, which needs some for its log and index,
 * and then has most of them allocated behind the end of the log: rows can be removed however full
 * the disk is. It is full when less than ORL_DISK_LEAST is free, or while the reserve could not be
 * made.
 *
 * On a full disk uploads and jobs are refused, no job starts, and everything else goes on.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_UPKEEP_DISK_ROOM_H
#define ORL_SERVER_UPKEEP_DISK_ROOM_H

#include <stdbool.h>

#include "process/log.h"
#include "store/folders.h"

#define ORL_RESERVE_BYTES (6L << 20)
/* For the pages that are in the log when it is folded, and more. */
#define ORL_LOG_ROOM (5L << 20)
#define ORL_DISK_LEAST (1L << 20)

struct orl_disk_room {
    const struct orl_folders *folders;
    const struct orl_log *log;
    bool reserved, full;
};

/* Before the database is opened. Borrows both. */
void orl_disk_room_open(struct orl_disk_room *room, const struct orl_folders *folders,
                        const struct orl_log *log);
/* Has the log's room allocated, once there is a log; best effort. */
void orl_disk_room_for_log(const struct orl_disk_room *room);
/* To be called every second or so. Returns true when full has changed. */
bool orl_disk_room_look(struct orl_disk_room *room);
/* After the database is closed, whose log has gone: makes the reserve for the next start. */
void orl_disk_room_close(struct orl_disk_room *room); /* a zeroed struct is fine */

#endif

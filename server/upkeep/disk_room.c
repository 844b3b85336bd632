#include "upkeep/disk_room.h"

#include <fcntl.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <oriel/open.h>

/* Returns the free bytes. If the file system does not report them, assumes unlimited space. */
static int64_t free_bytes(const struct orl_disk_room *room)
{
    struct statvfs disk;
    if (statvfs(room->folders->root, &disk) != 0 || disk.f_blocks == 0)
        return INT64_MAX;
    return (int64_t)(disk.f_bavail * disk.f_frsize);
}

static void reserve_path(const struct orl_disk_room *room, char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(room->folders, ret_path, "oriel.reserve");
}

static bool is_reserved(const struct orl_disk_room *room)
{
    char path[ORL_PATH_MAX];
    struct stat st;
    reserve_path(room, path);
    return stat(path, &st) == 0 && st.st_size >= ORL_RESERVE_BYTES;
}

/* Allocates the reserve. Removes the file if there is no space for it. */
static bool allocate_reserve(const struct orl_disk_room *room, int64_t bytes)
{
    char path[ORL_PATH_MAX];
    reserve_path(room, path);
    const int fd = orl_open_regular(path, O_WRONLY | O_CREAT);
    if (fd < 0)
        return false;
    const bool done = posix_fallocate(fd, 0, bytes) == 0;
    close(fd);
    if (!done)
        unlink(path);
    return done;
}

/* Makes the reserve, unless that would fill the disk. */
static void make_reserve(struct orl_disk_room *room)
{
    if (!room->reserved && free_bytes(room) >= ORL_RESERVE_BYTES + 2 * ORL_DISK_LEAST)
        room->reserved = allocate_reserve(room, ORL_RESERVE_BYTES);
}

void orl_disk_room_open(struct orl_disk_room *room, const struct orl_folders *folders,
                        const struct orl_log *log)
{
    char path[ORL_PATH_MAX];
    *room = (struct orl_disk_room){.folders = folders, .log = log};
    room->reserved = is_reserved(room);
    if (free_bytes(room) < ORL_RESERVE_BYTES) {
        reserve_path(room, path);
        unlink(path);
        room->reserved = false;
        room->full = true;
        orl_log_event(log, ORL_LOG_ERROR, "disk-full", "s", "hint",
                      "uploads and jobs are refused until something is removed");
        return;
    }
    make_reserve(room);
}

void orl_disk_room_for_log(const struct orl_disk_room *room)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(room->folders, path, "oriel.db-wal");
    const int fd = orl_open_regular(path, O_WRONLY);
    if (fd < 0)
        return;
    if (fallocate(fd, FALLOC_FL_KEEP_SIZE, 0, ORL_LOG_ROOM) != 0)
        orl_log_event(room->log, ORL_LOG_DEBUG, "log-room-missing", "");
    close(fd);
}

bool orl_disk_room_look(struct orl_disk_room *room)
{
    const bool was_full = room->full;
    make_reserve(room);
    const int64_t least = was_full ? 2 * ORL_DISK_LEAST : ORL_DISK_LEAST;
    room->full = !room->reserved || free_bytes(room) < least;
    if (room->full != was_full)
        orl_log_event(room->log, room->full ? ORL_LOG_ERROR : ORL_LOG_INFO,
                      room->full ? "disk-full" : "disk-has-room", "");
    return room->full != was_full;
}

void orl_disk_room_close(struct orl_disk_room *room)
{
    enum { SMALLEST = 1 << 18 };
    /* Reserve the space that the log had, or as much of it as is left. */
    for (int64_t bytes = ORL_RESERVE_BYTES; room->folders && !room->reserved && bytes >= SMALLEST;
         bytes /= 2)
        room->reserved = allocate_reserve(room, bytes);
}

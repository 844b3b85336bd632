#include "maintenance/storage.h"

#include <fcntl.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <oriel/base/files.h>

/* Returns the free bytes. If the file system does not report them, assumes unlimited space. */
static int64_t free_bytes(const struct orl_disk_reserve *reserve)
{
    struct statvfs disk;
    if (statvfs(reserve->folders->root, &disk) != 0 || disk.f_blocks == 0)
        return INT64_MAX;
    return (int64_t)(disk.f_bavail * disk.f_frsize);
}

static void reserve_path(const struct orl_disk_reserve *reserve, char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(reserve->folders, ret_path, "oriel.reserve");
}

static bool is_reserved(const struct orl_disk_reserve *reserve)
{
    char path[ORL_PATH_MAX];
    struct stat st;
    reserve_path(reserve, path);
    return stat(path, &st) == 0 && st.st_size >= ORL_RESERVE_BYTES;
}

/* Allocates the reserve. Removes the file if there is no space for it. */
static bool allocate_reserve(const struct orl_disk_reserve *reserve, int64_t bytes)
{
    char path[ORL_PATH_MAX];
    reserve_path(reserve, path);
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
static void make_reserve(struct orl_disk_reserve *reserve)
{
    if (!reserve->reserved && free_bytes(reserve) >= ORL_RESERVE_BYTES + 2 * ORL_DISK_LEAST)
        reserve->reserved = allocate_reserve(reserve, ORL_RESERVE_BYTES);
}

void orl_disk_reserve_open(struct orl_disk_reserve *reserve, const struct orl_folders *folders,
                           const struct orl_log *log)
{
    char path[ORL_PATH_MAX];
    *reserve = (struct orl_disk_reserve){.folders = folders, .log = log};
    reserve->reserved = is_reserved(reserve);
    if (free_bytes(reserve) < ORL_RESERVE_BYTES) {
        reserve_path(reserve, path);
        unlink(path);
        reserve->reserved = false;
        reserve->full = true;
        orl_log_event(log, ORL_LOG_ERROR, "disk-full", "s", "hint",
                      "uploads and jobs are refused until something is removed");
        return;
    }
    make_reserve(reserve);
}

void orl_disk_reserve_wal(const struct orl_disk_reserve *reserve)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(reserve->folders, path, "oriel.db-wal");
    const int fd = orl_open_regular(path, O_WRONLY);
    if (fd < 0)
        return;
    if (fallocate(fd, FALLOC_FL_KEEP_SIZE, 0, ORL_WAL_RESERVE_BYTES) != 0)
        orl_log_event(reserve->log, ORL_LOG_DEBUG, "log-room-missing", "");
    close(fd);
}

bool orl_disk_reserve_check(struct orl_disk_reserve *reserve)
{
    const bool was_full = reserve->full;
    make_reserve(reserve);
    const int64_t least = was_full ? 2 * ORL_DISK_LEAST : ORL_DISK_LEAST;
    reserve->full = !reserve->reserved || free_bytes(reserve) < least;
    if (reserve->full != was_full)
        orl_log_event(reserve->log, reserve->full ? ORL_LOG_ERROR : ORL_LOG_INFO,
                      reserve->full ? "disk-full" : "disk-has-room", "");
    return reserve->full != was_full;
}

void orl_disk_reserve_close(struct orl_disk_reserve *reserve)
{
    enum { SMALLEST = 1 << 18 };
    /* Reserve the space that the log had, or as much of it as is left. */
    for (int64_t bytes = ORL_RESERVE_BYTES;
         reserve->folders && !reserve->reserved && bytes >= SMALLEST; bytes /= 2)
        reserve->reserved = allocate_reserve(reserve, bytes);
}

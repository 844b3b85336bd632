#include <dirent.h>
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sys/stat.h>

#include "process/times.h"
#include "store/files/removal.h"

struct removal {
    uv_work_t work;
    char path[];
};

/* A file that is removed once its row's deletion is safe. */
struct deferred_removal {
    struct orl_wal_sync_wait wait; /* first member, whose address is the struct's */
    uv_loop_t *loop;
    const struct orl_folders *folders;
    char path[];
};

static void run_removal(uv_work_t *work)
{
    enum { ATTEMPTS = 3 };
    const struct removal *removal = work->data;
    /* Retry, since a lack of memory may pass; otherwise the next start removes it. */
    for (int i = 0; i < ATTEMPTS && orl_remove_tree(removal->path, NULL) != 0; i++)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}

static void end_removal(uv_work_t *work, int status)
{
    (void)status;
    free(work->data);
}

void orl_remove_async(uv_loop_t *loop, const struct orl_folders *folders, const char *path)
{
    char away[ORL_PATH_MAX];
    orl_folders_temporary(folders, away);
    if (rename(path, away) != 0) {
        orl_remove_tree(path, NULL);
        return;
    }
    const size_t size = strlen(away) + 1;
    struct removal *removal = malloc(sizeof *removal + size);
    if (!removal) {
        orl_remove_tree(away, NULL);
        return;
    }
    memcpy(removal->path, away, size);
    removal->work.data = removal;
    uv_queue_work(loop, &removal->work, run_removal, end_removal);
}

static void remove_deferred(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err)
{
    struct deferred_removal *deferred_removal = (struct deferred_removal *)wait;
    (void)err;
    if (rc == 0)
        orl_remove_async(deferred_removal->loop, deferred_removal->folders, deferred_removal->path);
    free(deferred_removal);
}

void orl_remove_when_durable(struct orl_wal_sync *wal_sync, uv_loop_t *loop,
                             const struct orl_folders *folders, const char *path)
{
    const size_t size = strlen(path) + 1;
    struct deferred_removal *deferred_removal = malloc(sizeof *deferred_removal + size);
    if (!deferred_removal)
        return;
    *deferred_removal =
        (struct deferred_removal){.wait.synced = remove_deferred, .loop = loop, .folders = folders};
    memcpy(deferred_removal->path, path, size);
    orl_wal_sync_request(wal_sync, &deferred_removal->wait);
}

/* ---- Orphans --------------------------------------------------------------------------------- */

void orl_orphans_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX])
{
    char start[ORL_TIME_TEXT];
    orl_time_format(folders->start_ms, start);
    orl_folders_path(folders, ret_path, "orphans/%s", start);
}

/* Makes the missing folders above path, from root on. */
static int make_parents(const char *root, char *path, struct orl_error *err)
{
    for (char *slash = strchr(path + strlen(root) + 1, '/'); slash;
         slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        const int failed = mkdir(path, 0777) != 0 && errno != EEXIST ? errno : 0;
        if (failed)
            orl_error_set(err, orl_err_of_errno(failed), "cannot make the folder %s: %s", path,
                          strerror(failed));
        *slash = '/';
        if (failed)
            return orl_err_of_errno(failed);
    }
    return 0;
}

int orl_orphan_set_aside(const struct orl_folders *folders, const char *below,
                         struct orl_error *err)
{
    char from[ORL_PATH_MAX], to[ORL_PATH_MAX], aside[ORL_PATH_MAX];
    struct stat st;
    orl_orphans_path(folders, aside);
    orl_folders_path(folders, from, "%s", below);
    snprintf(to, sizeof to, "%.*s/%.1000s", ORL_PATH_MAX - 1024, aside, below);
    if (lstat(from, &st) != 0 && errno == ENOENT)
        return 0;
    const int rc = make_parents(folders->root, to, err);
    if (rc)
        return rc;
    if (rename(from, to) != 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot move %s to %s: %s", from, to,
                             strerror(errno));
    return 0;
}

static void count_below(const char *path, struct orl_orphans_found *found)
{
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        char below[ORL_PATH_MAX];
        struct stat st;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(below, sizeof below, "%.*s/%s", ORL_PATH_MAX - 260, path, entry->d_name);
        if (lstat(below, &st) != 0)
            continue;
        if (S_ISDIR(st.st_mode)) {
            count_below(below, found);
        } else {
            found->files++;
            found->bytes += (uint64_t)st.st_size;
        }
    }
    if (folder)
        closedir(folder);
}

struct orl_orphans_found orl_orphans_count(const struct orl_folders *folders)
{
    struct orl_orphans_found found = {0};
    char path[ORL_PATH_MAX];
    orl_orphans_path(folders, path);
    count_below(path, &found);
    return found;
}

void orl_orphans_purge(uv_loop_t *loop, const struct orl_folders *folders, int64_t now_ms,
                       uint32_t keep_days)
{
    char path[ORL_PATH_MAX];
    const int64_t before_ms = now_ms - (int64_t)keep_days * 86400000;
    orl_folders_path(folders, path, "orphans");
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        int64_t start_ms = 0;
        if (!orl_time_parse(entry->d_name, &start_ms) || start_ms > before_ms ||
            start_ms == folders->start_ms)
            continue;
        orl_folders_path(folders, path, "orphans/%s", entry->d_name);
        orl_remove_async(loop, folders, path);
    }
    if (folder)
        closedir(folder);
}

/* ---- The retention clock --------------------------------------------------------------------- */

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

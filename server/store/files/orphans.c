#include "store/files/orphans.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "process/times.h"
#include "store/files/async_remove.h"

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

/* ---- Counting -------------------------------------------------------------------------------- */

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

/* ---- Removal --------------------------------------------------------------------------------- */

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

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sys/stat.h>

#include <oriel/base/array.h>

#include "distributed/atomic_files.h"
#include "input/input_folders.h"

enum { PATH_SIZE = 4096, MOST_NAMES = 100000, DEPTH = 16 };

bool orl_raypath_find(const char *name, char *ret_path, size_t size)
{
    const char *at = getenv("RAYPATH");
    struct stat info;
    while (at && *at) {
        const int length = (int)strcspn(at, ":");
        const int needed = snprintf(ret_path, size, "%.*s/%s", length, at, name);
        if (length > 0 && needed > 0 && (size_t)needed < size && stat(ret_path, &info) == 0 &&
            S_ISREG(info.st_mode))
            return true;
        at += length + (at[length] == ':');
    }
    return false;
}

static int raypath_open(void *ctx, const char *name, struct orl_file *ret_file,
                        struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    char path[PATH_SIZE];
    (void)ctx;
    if (!orl_raypath_find(name, path, sizeof path))
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "'%.200s' is in no folder of RAYPATH", name);
    return here.open(here.ctx, path, ret_file, err);
}

struct orl_files orl_raypath_files(const char *folder)
{
    struct orl_files files = orl_files_from_folder(folder);
    files.library = raypath_open;
    return files;
}

bool orl_is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* ---- Names below a folder -------------------------------------------------------------------- */

void orl_names_done(struct orl_names *names)
{
    for (size_t i = 0; i < names->count; i++)
        free(names->items[i]);
    free(names->items);
}

int orl_names_add(struct orl_names *names, const char *name, struct orl_error *err)
{
    if (names->count == MOST_NAMES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the project has more than %d files", MOST_NAMES);
    if (!orl_array_reserve(&names->items, &names->room, names->count, sizeof *names->items))
        return orl_error_no_memory(err);
    names->items[names->count] = strdup(name);
    return names->items[names->count++] ? 0 : orl_error_no_memory(err);
}

int orl_names_list(const char *folder, const char *prefix, unsigned depth, struct orl_names *names,
                   struct orl_error *err)
{
    DIR *entries = NULL;
    int rc = orl_open_folder(folder, &entries, err);
    if (rc)
        return rc;
    for (const struct dirent *entry; rc == 0 && (entry = readdir(entries)) != NULL;) {
        char path[PATH_SIZE], name[PATH_SIZE];
        if (entry->d_name[0] == '.' ||
            orl_join_path(folder, entry->d_name, path, sizeof path, NULL) ||
            snprintf(name, sizeof name, "%s%s", prefix, entry->d_name) >= PATH_SIZE - 1)
            continue;
        if (!orl_is_folder(path)) {
            rc = orl_names_add(names, name, err);
        } else if (depth < DEPTH) {
            const size_t length = strlen(name);
            name[length] = '/';
            name[length + 1] = '\0';
            rc = orl_names_list(path, name, depth + 1, names, err);
        }
    }
    closedir(entries);
    return rc;
}

/* ---- The temporary folder -------------------------------------------------------------------- */

int orl_temp_folder_make(const char *purpose, char folder[PATH_SIZE], struct orl_error *err)
{
    const char *top = getenv("TMPDIR");
    snprintf(folder, PATH_SIZE, "%s/oriel-%s-XXXXXX", top && *top ? top : "/tmp", purpose);
    if (mkdtemp(folder))
        return 0;
    folder[0] = '\0';
    return orl_error_set(err, orl_err_of_errno(errno), "cannot make a temporary folder: %s",
                         strerror(errno));
}

int orl_temp_folder_link(const char *temp_folder, const char *name, const char *to,
                         struct orl_error *err)
{
    char path[PATH_SIZE];
    int rc = orl_join_path(temp_folder, name, path, sizeof path, err);
    if (rc)
        return rc;
    unlink(path);
    if (symlink(to, path) == 0)
        return 0;
    return orl_error_set(err, orl_err_of_errno(errno), "cannot make the link '%s': %s", path,
                         strerror(errno));
}

int orl_temp_folder_link_entries(const char *temp_folder, const char *folder, struct orl_error *err)
{
    char whole[PATH_MAX], to[PATH_SIZE], path[PATH_SIZE];
    DIR *entries = NULL;
    int rc = orl_open_folder(realpath(folder, whole) ? whole : folder, &entries, err);
    if (rc)
        return rc;
    for (const struct dirent *entry; rc == 0 && (entry = readdir(entries)) != NULL;) {
        struct stat there;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        rc = orl_join_path(whole, entry->d_name, to, sizeof to, err);
        if (rc == 0)
            rc = orl_join_path(temp_folder, entry->d_name, path, sizeof path, err);
        if (rc == 0 && lstat(path, &there) != 0)
            rc = orl_temp_folder_link(temp_folder, entry->d_name, to, err);
    }
    closedir(entries);
    return rc;
}

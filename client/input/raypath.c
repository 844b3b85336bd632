#include "input/raypath.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_SIZE = 4096 };

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
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "no folder of RAYPATH has '%.200s'", name);
    return here.open(here.ctx, path, ret_file, err);
}

struct orl_files orl_raypath_files(const char *folder)
{
    struct orl_files files = orl_files_from_folder(folder);

    files.library = raypath_open;
    return files;
}

/* Zip archives of scenes, unpacked as for an upload. */
#include "fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../server/process/limits.h" /* full path, because this folder also has a limits.h */
#include "uploads/uploads.h"

static struct orl_folders folders;

static void remove_folders(void)
{
    orl_remove_tree(folders.root, NULL);
}

static void need_folders(void)
{
    char path[ORL_PATH_MAX];
    if (folders.root[0])
        return;
    snprintf(folders.root, sizeof folders.root, "/tmp/oriel-fuzz-XXXXXX");
    FUZZ_PROMISE(mkdtemp(folders.root) != NULL);
    orl_folders_path(&folders, path, "tmp");
    FUZZ_PROMISE(mkdir(path, 0700) == 0);
    atexit(remove_folders);
}

static void check_file(const struct orl_bundle_file *file)
{
    struct stat st;
    FUZZ_PROMISE(orl_bundle_check_name(file->name, NULL) == 0);
    FUZZ_PROMISE(orl_is_sha256(file->sha));
    FUZZ_PROMISE(file->temporary && stat(file->path, &st) == 0);
    FUZZ_PROMISE((uint64_t)st.st_size == file->bytes);
    FUZZ_PROMISE(S_ISREG(st.st_mode));
}

bool fuzz_zip(const uint8_t *data, size_t size)
{
    const struct orl_file archive = {(const char *)data, size, NULL};
    struct orl_bundle bundle = {0};
    struct orl_error err = {0};
    need_folders();
    const int code = orl_unzip(&archive, &folders, true, &bundle, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    FUZZ_PROMISE(bundle.count <= ORL_LIMIT_SCENE_FILES);
    FUZZ_PROMISE(orl_bundle_bytes(&bundle) <= ORL_SERVER_ZIP_FREE + ORL_SERVER_ZIP_RATIO * size);
    for (size_t i = 0; i < bundle.count; i++)
        check_file(&bundle.files[i]);
    orl_bundle_done(&bundle);
    return code == 0;
}

/* Multipart bodies of uploads: the first line is the Content-Type, the rest is the body. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../server/process/limits.h" /* full path, because this folder also has a limits.h */
#include "fuzz/fuzz.h"
#include "support/wire.h"
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

struct seen {
    struct orl_file body;
    bool accepted;
};

static void check_files(const struct orl_bundle *files)
{
    struct stat st;
    FUZZ_PROMISE(files->count <= ORL_LIMIT_SCENE_FILES);
    for (size_t i = 0; i < files->count; i++) {
        const struct orl_bundle_file *file = &files->files[i];
        FUZZ_PROMISE(orl_bundle_check_name(file->name, NULL) == 0);
        FUZZ_PROMISE(orl_is_sha256(file->sha));
        FUZZ_PROMISE(file->temporary && stat(file->path, &st) == 0);
        FUZZ_PROMISE((uint64_t)st.st_size == file->bytes);
    }
}

static void see(void *ctx, const struct wire_request *request)
{
    struct seen *seen = ctx;
    struct orl_multipart parts = {0};
    struct orl_error err = {0};
    if (request->ended)
        return;
    const int code = orl_multipart_split(request->connection, &seen->body, &folders, &parts, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(parts.files.count == 0 && !parts.mains && !parts.bsdfs);
        return;
    }
    check_files(&parts.files);
    check_files(&parts.zips);
    FUZZ_PROMISE(!parts.mains || strlen(parts.mains) <= ORL_SERVER_FIELD_BYTES);
    FUZZ_PROMISE(!parts.bsdfs || strlen(parts.bsdfs) <= ORL_SERVER_FIELD_BYTES);
    seen->accepted = true;
    orl_multipart_done(&parts);
}

bool fuzz_multipart(const uint8_t *data, size_t size)
{
    const uint8_t *line = size ? memchr(data, '\n', size) : NULL;
    const size_t length = line ? (size_t)(line - data) : 0;
    char head[512];
    if (!line || length > 256)
        return false;
    need_folders();
    struct seen seen = {{(const char *)line + 1, size - length - 1, NULL}, false};
    const int n = snprintf(head, sizeof head,
                           "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n"
                           "Content-Type: %.*s\r\n\r\n",
                           (int)length, (const char *)data);
    wire_send(head, (size_t)n, see, &seen);
    return seen.accepted;
}

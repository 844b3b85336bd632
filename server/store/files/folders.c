#include "store/files/folders.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <libgen.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/sha256.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "process/times.h"
#include "store/files/scene_bundle.h"

/* ---- Memory maps ----------------------------------------------------------------------------- */

int orl_map_file(const char *path, struct orl_file *ret_file, struct orl_error *err)
{
    struct stat st;
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st) != 0) {
        const int why = errno, code = orl_err_of_errno(why);
        orl_error_set(err, code, "cannot open a stored file: %s", orl_open_reason(why));
        if (fd >= 0)
            close(fd);
        return code;
    }
    int rc = 0;
    if (st.st_size == 0) {
        *ret_file = (struct orl_file){"", 0, NULL};
    } else {
        void *data = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
        if (data == MAP_FAILED)
            rc = orl_error_set(err, orl_err_of_errno(errno), "cannot map a stored file: %s",
                               strerror(errno));
        else
            *ret_file = (struct orl_file){data, (size_t)st.st_size, data};
    }
    close(fd);
    return rc;
}

void orl_unmap_file(struct orl_file *file)
{
    if (file->handle)
        munmap(file->handle, file->size);
    *file = (struct orl_file){0};
}

/* ---- The data folder ------------------------------------------------------------------------- */

static int io_error(struct orl_error *err, const char *what, const char *path)
{
    return orl_error_set(err, orl_err_of_errno(errno), "cannot %s %s: %s", what, path,
                         orl_open_reason(errno));
}

static int make_folder(const char *path, struct orl_error *err)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return io_error(err, "make the folder", path);
    return 0;
}

void orl_folders_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX],
                      const char *format, ...)
{
    const int used = snprintf(ret_path, ORL_PATH_MAX, "%s/", folders->root);
    va_list args;
    va_start(args, format);
    vsnprintf(ret_path + used, (size_t)(ORL_PATH_MAX - used), format, args);
    va_end(args);
}

void orl_folders_temporary(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX])
{
    unsigned char bytes[12];
    char hex[2 * sizeof bytes + 1];
    randombytes_buf(bytes, sizeof bytes);
    sodium_bin2hex(hex, sizeof hex, bytes, sizeof bytes);
    orl_folders_path(folders, ret_path, "tmp/%s", hex);
}

static int take_lock(struct orl_folders *folders, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "oriel.lock");
    folders->lock_fd = orl_open_regular(path, O_RDWR | O_CREAT);
    if (folders->lock_fd < 0)
        return io_error(err, "open", path);
    if (flock(folders->lock_fd, LOCK_EX | LOCK_NB) != 0) {
        orl_error_set(err, ORL_ERR_INVALID, "another daemon uses the data folder %s",
                      folders->root);
        orl_error_hint(err, "Stop it, or give another folder with --data");
        return ORL_ERR_INVALID;
    }
    return 0;
}

int orl_folders_open(struct orl_folders *folders, const char *root, struct orl_error *err)
{
    static const char *const below[] = {"blobs", "maps", "partial", "results", "tmp"};
    char path[ORL_PATH_MAX];
    folders->lock_fd = -1;
    folders->reservation = NULL;
    folders->start_ms = orl_time_now_ms();
    if (strlen(root) >= sizeof folders->root)
        return orl_error_set(err, ORL_ERR_LIMIT, "the data folder's path is too long");
    snprintf(folders->root, sizeof folders->root, "%s", root);
    int rc = make_folder(root, err);
    if (rc == 0)
        rc = take_lock(folders, err);
    orl_folders_path(folders, path, "tmp");
    if (rc == 0)
        rc = orl_remove_tree(path, err); /* files that a killed daemon left half-written */
    for (size_t i = 0; i < sizeof below / sizeof *below && rc == 0; i++) {
        orl_folders_path(folders, path, "%s", below[i]);
        rc = make_folder(path, err);
    }
    if (rc)
        orl_folders_close(folders);
    return rc;
}

void orl_folders_close(struct orl_folders *folders)
{
    if (folders->lock_fd >= 0)
        close(folders->lock_fd);
    folders->lock_fd = -1;
}

static int remove_entry(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
    (void)st, (void)type, (void)ftw;
    return remove(path);
}

int orl_remove_tree(const char *path, struct orl_error *err)
{
    enum { OPEN_FOLDERS = 16 };
    if (nftw(path, remove_entry, OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS) != 0 && errno != ENOENT)
        return io_error(err, "remove", path);
    return 0;
}

int orl_sync_path(const char *path, struct orl_error *err)
{
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* works for files and folders */
    if (fd < 0)
        return io_error(err, "open", path);
    int rc = 0;
    if (fsync(fd) != 0)
        rc = io_error(err, "sync", path);
    close(fd);
    return rc;
}

int orl_rename_synced(const char *from, const char *to, struct orl_error *err)
{
    char folder[ORL_PATH_MAX];
    if (rename(from, to) != 0)
        return io_error(err, "rename to", to);
    snprintf(folder, sizeof folder, "%s", to);
    return orl_sync_path(dirname(folder), err);
}

bool orl_write_all(int fd, const void *data, size_t size)
{
    for (const char *at = data; size > 0;) {
        const ssize_t n = write(fd, at, size);
        if (n < 0 && errno != EINTR)
            return false;
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return true;
}

/* Writes and syncs a file that is renamed once it is complete. */
static int write_part(const char *path, const char *at, size_t size, struct orl_error *err)
{
    const int fd = orl_open_regular(path, O_WRONLY | O_CREAT | O_TRUNC);
    if (fd < 0)
        return io_error(err, "create", path);
    int rc = orl_write_all(fd, at, size) ? 0 : io_error(err, "write", path);
    if (rc == 0 && fsync(fd) != 0)
        rc = io_error(err, "sync", path);
    if (close(fd) != 0 && rc == 0)
        rc = io_error(err, "close", path);
    return rc;
}

int orl_write_file(const char *path, const void *data, size_t size, struct orl_error *err)
{
    char part[ORL_PATH_MAX + 8];
    snprintf(part, sizeof part, "%s.part", path);
    int rc = write_part(part, data, size, err);
    if (rc == 0 && rename(part, path) != 0)
        rc = io_error(err, "rename to", path);
    if (rc)
        unlink(part);
    return rc;
}

/* ---- Blobs ----------------------------------------------------------------------------------- */

void orl_blob_path(const struct orl_folders *folders, const char *sha, char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(folders, ret_path, "blobs/%.2s/%s", sha, sha);
}

bool orl_blob_exists(const struct orl_folders *folders, const char *sha)
{
    char path[ORL_PATH_MAX];
    orl_blob_path(folders, sha, path);
    return access(path, R_OK) == 0;
}

/* Returns true if the blob exists and its digest is its name. */
static bool is_whole(const struct orl_folders *folders, const char *sha)
{
    char path[ORL_PATH_MAX], found[ORL_SHA_HEX];
    struct orl_file file = {0};
    orl_blob_path(folders, sha, path);
    if (!orl_blob_exists(folders, sha) || orl_map_file(path, &file, NULL))
        return false;
    orl_sha256_hex(file.data, file.size, found);
    orl_unmap_file(&file);
    return strcmp(found, sha) == 0;
}

int orl_blob_store(const struct orl_folders *folders, const char *temporary, const char *sha,
                   struct orl_error *err)
{
    char path[ORL_PATH_MAX], folder[ORL_PATH_MAX];
    int rc = 0;
    orl_folders_path(folders, folder, "blobs/%.2s", sha);
    if (is_whole(folders, sha)) {
        unlink(temporary);
        /* Another upload may have just put it there, without having synced its folder yet. */
        rc = orl_sync_path(folder, err);
        orl_folders_path(folders, folder, "blobs");
        return rc ? rc : orl_sync_path(folder, err);
    }
    rc = make_folder(folder, err);
    if (rc == 0)
        rc = orl_sync_path(temporary, err);
    orl_blob_path(folders, sha, path);
    if (rc == 0)
        rc = orl_rename_synced(temporary, path, err);
    orl_folders_path(folders, folder, "blobs");
    return rc ? rc : orl_sync_path(folder, err);
}

void orl_sha256_hex(const void *data, size_t size, char ret_hex[ORL_SHA_HEX])
{
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, data, size);
    orl_sha256_finish_hex(&hash, ret_hex);
}

bool orl_is_sha256(const char *text)
{
    return strlen(text) == ORL_SHA_HEX - 1 && strspn(text, "0123456789abcdef") == ORL_SHA_HEX - 1;
}

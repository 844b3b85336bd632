#include "distributed/atomic_files.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/stat.h>

static int io_error(struct orl_error *err, const char *path, const char *verb)
{
    const int code = errno == ENOENT ? ORL_ERR_NOT_FOUND : orl_err_of_errno(errno);
    orl_error_set(err, code, "cannot %s: %s", verb, orl_open_reason(errno));
    orl_error_at(err, path, 0, NULL);
    return code;
}

int orl_join_path(const char *folder, const char *name, char *ret_path, size_t size,
                  struct orl_error *err)
{
    const int length = name[0] == '/' ? snprintf(ret_path, size, "%s", name)
                                      : snprintf(ret_path, size, "%s/%s", folder, name);
    if (length < 0 || (size_t)length >= size)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of \"%.100s\" is too long", name);
    return 0;
}

/* Returns false for devices and pipes, such as /dev/null and /dev/stdout, which are written to
 * in place. */
static bool is_replaced(const char *target)
{
    struct stat info;
    return stat(target, &info) != 0 || S_ISREG(info.st_mode) || S_ISDIR(info.st_mode);
}

int orl_atomic_file_open(struct orl_atomic_file *ret_file, const char *target,
                         struct orl_error *err)
{
    const int length = snprintf(ret_file->temporary, sizeof ret_file->temporary, "%s.part", target);
    ret_file->stream = NULL;
    if (length < 0 || (size_t)length >= sizeof ret_file->temporary)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path \"%.100s...\" is too long", target);
    memcpy(ret_file->target, target, strlen(target) + 1);
    if (!is_replaced(target))
        ret_file->temporary[0] = '\0';
    ret_file->stream = ret_file->temporary[0] ? orl_fopen_regular(ret_file->temporary, 'w')
                                              : orl_fopen_device(target);
    return ret_file->stream ? 0 : io_error(err, target, "create");
}

int orl_atomic_file_commit(struct orl_atomic_file *file, struct orl_error *err)
{
    const bool replaces = file->temporary[0];
    int rc = 0;
    if (fflush(file->stream) != 0 || ferror(file->stream) ||
        (replaces && fsync(fileno(file->stream)) != 0))
        rc = io_error(err, file->target, "write");
    if (fclose(file->stream) != 0 && rc == 0)
        rc = io_error(err, file->target, "write");
    file->stream = NULL;
    if (rc == 0 && replaces && rename(file->temporary, file->target) != 0)
        rc = io_error(err, file->target, "replace");
    if (rc && replaces)
        unlink(file->temporary);
    return rc;
}

void orl_atomic_file_abandon(struct orl_atomic_file *file)
{
    if (file->stream)
        fclose(file->stream);
    file->stream = NULL;
    if (file->temporary[0])
        unlink(file->temporary);
}

int orl_open_for_reading(const char *path, FILE **ret_stream, long long *ret_size,
                         struct orl_error *err)
{
    struct stat info;
    FILE *stream = orl_fopen_regular(path, 'r');
    if (!stream)
        return io_error(err, path, "read");
    if (fstat(fileno(stream), &info) != 0) {
        fclose(stream);
        orl_error_set(err, ORL_ERR_IO, "cannot be read");
        orl_error_at(err, path, 0, NULL);
        return ORL_ERR_IO;
    }
    *ret_stream = stream;
    *ret_size = info.st_size;
    return 0;
}

int orl_open_folder(const char *path, DIR **ret_entries, struct orl_error *err)
{
    *ret_entries = opendir(path);
    return *ret_entries ? 0 : io_error(err, path, "read the folder");
}

int orl_make_folder(const char *path, struct orl_error *err)
{
    char partial[4096];
    const size_t length = strlen(path);
    struct stat info;
    if (length == 0 || length >= sizeof partial)
        return orl_error_set(err, ORL_ERR_INVALID, "the output folder's name is %s",
                             length ? "too long" : "empty");
    memcpy(partial, path, length + 1);
    for (size_t i = 1; i <= length; i++) {
        if (partial[i] != '/' && partial[i] != '\0')
            continue;
        partial[i] = '\0';
        if (mkdir(partial, 0777) != 0 && errno != EEXIST)
            return io_error(err, path, "make the folder");
        partial[i] = path[i];
    }
    if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)) {
        errno = ENOTDIR;
        return io_error(err, path, "use the path as a folder");
    }
    return 0;
}

void orl_remove_folder(const char *folder)
{
    DIR *entries = opendir(folder);
    for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
        char path[4096];
        struct stat info;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            orl_join_path(folder, entry->d_name, path, sizeof path, NULL) || lstat(path, &info))
            continue;
        if (S_ISDIR(info.st_mode))
            orl_remove_folder(path);
        else
            unlink(path);
    }
    if (entries)
        closedir(entries);
    rmdir(folder);
}

int orl_write_json(const char *path, const json_t *json, struct orl_error *err)
{
    struct orl_atomic_file file = {.stream = NULL};
    if (!json)
        return orl_error_no_memory(err);
    int rc = orl_atomic_file_open(&file, path, err);
    if (rc)
        return rc;
    /* 17 digits reproduce every double exactly; files are compared by their bytes. */
    if (json_dumpf(json, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0 ||
        fputc('\n', file.stream) == EOF) {
        rc = io_error(err, path, "write");
        orl_atomic_file_abandon(&file);
        return rc;
    }
    return orl_atomic_file_commit(&file, err);
}

int orl_write_text(const char *path, const char *text, size_t size, struct orl_error *err)
{
    struct orl_atomic_file file;
    const int rc = orl_atomic_file_open(&file, path, err);
    if (rc)
        return rc;
    if (fwrite(text, 1, size, file.stream) != size) {
        const int rc_write = io_error(err, path, "write");
        orl_atomic_file_abandon(&file);
        return rc_write;
    }
    return orl_atomic_file_commit(&file, err);
}

void orl_digest_end(struct orl_sha256 *hash, char ret_digest[ORL_DIGEST_TEXT])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_digest, ORL_DIGEST_TEXT, digest, sizeof digest);
}

int orl_digest_file(const char *path, char ret_digest[ORL_DIGEST_TEXT], struct orl_error *err)
{
    struct orl_sha256 hash;
    unsigned char buffer[1 << 16];
    long long size = 0;
    FILE *file = NULL;
    size_t n;
    int rc = orl_open_for_reading(path, &file, &size, err);
    if (rc)
        return rc;
    orl_sha256_init(&hash);
    while ((n = fread(buffer, 1, sizeof buffer, file)) > 0)
        orl_sha256_add(&hash, buffer, n);
    if (ferror(file)) {
        rc = orl_error_set(err, ORL_ERR_IO, "cannot be read");
        orl_error_at(err, path, 0, NULL);
    }
    fclose(file);
    if (rc == 0)
        orl_digest_end(&hash, ret_digest);
    return rc;
}

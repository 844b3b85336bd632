/*
 * Records the file operations of a program on a folder: loaded before the C library (LD_PRELOAD),
 * it writes a line of JSON for each operation to the file RECORDER, in the order in which they end.
 * powercuts.py replays them up to any of them, without unsynced data.
 *
 *   {"a": "create" | "mkdir" | "unlink" | "rmdir", "p": path}    {"a": "rename", "p": from, "q":
 * to}
 *   {"a": "folder", "p": path}     a folder was synced: its entries are safe
 *   {"a": "file", "p": path, "at": offset, "n": bytes}
 *                                  a file was synced: its content then is in RECORDER.data,
 *                                  however it was written (mapped, stdio)
 *   {"a": "write", "p": path, "to": place, "at": offset, "n": bytes}   a pwrite of the database
 *
 * Paths are below RECORDER_ROOT, which must be absolute. remove() is recorded as unlink or rmdir.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

static int lines = -1, data = -1;
static long data_size;
static pid_t daemon_pid; /* children that check uploads write only names */
static char root[PATH_BYTES];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

#define REAL(type, name) ((type)(uintptr_t)dlsym(RTLD_NEXT, name))
typedef int (*path_call)(const char *);
typedef ssize_t (*write_call)(int, const void *, size_t);
typedef int (*open_call)(const char *, int, ...);

__attribute__((constructor)) static void open_files(void)
{
    const char *path = getenv("RECORDER"), *folder = getenv("RECORDER_ROOT");
    char name[PATH_BYTES];
    if (!path || !folder)
        return;
    const open_call real = REAL(open_call, "open");
    snprintf(root, sizeof root, "%s/", folder);
    snprintf(name, sizeof name, "%s.data", path);
    lines = real(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    data = real(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    data_size = data < 0 ? 0 : lseek(data, 0, SEEK_END);
    daemon_pid = getpid();
}

static const char *below(const char *path)
{
    const size_t length = strlen(root);
    return lines >= 0 && length > 1 && strncmp(path, root, length) == 0 ? path + length : NULL;
}

/* Called under the lock, which fixes the order. Preserves errno. */
static void record(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void record(const char *format, ...)
{
    char line[2 * PATH_BYTES + 200];
    const int why = errno;
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    if (REAL(write_call, "write")(lines, line, (size_t)n) != n)
        abort();
    errno = why;
}

static const char *path_of(int fd, char path[PATH_BYTES])
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t n = readlink(link, path, PATH_BYTES - 1);
    if (n <= 0)
        return NULL;
    path[n] = '\0';
    return strstr(path, " (deleted)") ? NULL : below(path);
}

static void copy_to_data(const void *bytes, size_t size)
{
    if (REAL(write_call, "write")(data, bytes, size) != (ssize_t)size)
        abort();
    data_size += (long)size;
}

/* ---- Syncs ----------------------------------------------------------------------------------- */

static void tell_synced(int fd)
{
    char path[PATH_BYTES], own[64], bytes[1 << 16];
    struct stat st;
    const char *name = path_of(fd, path);
    if (fstat(fd, &st) != 0 || (!name && !(S_ISDIR(st.st_mode) && below(strcat(path, "/")))))
        return;
    if (S_ISDIR(st.st_mode)) {
        record("{\"a\": \"folder\", \"p\": \"%s\"}\n", name ? name : "");
        return;
    }
    const long at = data_size;
    snprintf(own, sizeof own, "/proc/self/fd/%d", fd); /* fd may be write-only */
    const int reader = REAL(open_call, "open")(own, O_RDONLY | O_CLOEXEC);
    for (ssize_t n; reader >= 0 && (n = read(reader, bytes, sizeof bytes)) > 0;)
        copy_to_data(bytes, (size_t)n);
    close(reader);
    record("{\"a\": \"file\", \"p\": \"%s\", \"at\": %ld, \"n\": %ld}\n", name, at, data_size - at);
}

static int sync_with(const char *call, int fd)
{
    pthread_mutex_lock(&lock);
    const int rc = REAL(int (*)(int), call)(fd);
    if (rc == 0 && lines >= 0 && getpid() == daemon_pid)
        tell_synced(fd);
    pthread_mutex_unlock(&lock);
    return rc;
}

int fsync(int fd)
{
    return sync_with("fsync", fd);
}

int fdatasync(int fd)
{
    return sync_with("fdatasync", fd);
}

/* ---- Writes of the database ------------------------------------------------------------------ */

static ssize_t pwrite_with(const char *call, int fd, const void *bytes, size_t size, off64_t at)
{
    char path[PATH_BYTES];
    pthread_mutex_lock(&lock);
    const ssize_t n =
        REAL(ssize_t(*)(int, const void *, size_t, off64_t), call)(fd, bytes, size, at);
    const char *name = n > 0 && lines >= 0 && getpid() == daemon_pid ? path_of(fd, path) : NULL;
    if (name) {
        const long from = data_size;
        copy_to_data(bytes, (size_t)n);
        record("{\"a\": \"write\", \"p\": \"%s\", \"to\": %lld, \"at\": %ld, \"n\": %ld}\n", name,
               (long long)at, from, (long)n);
    }
    pthread_mutex_unlock(&lock);
    return n;
}

ssize_t pwrite(int fd, const void *bytes, size_t size, off_t at)
{
    return pwrite_with("pwrite", fd, bytes, size, at);
}

ssize_t pwrite64(int fd, const void *bytes, size_t size, off64_t at)
{
    return pwrite_with("pwrite64", fd, bytes, size, at);
}

/* ---- Names ----------------------------------------------------------------------------------- */

static int open_with(const char *call, const char *path, int flags, mode_t mode)
{
    const char *name = flags & O_CREAT ? below(path) : NULL;
    if (!name)
        return REAL(open_call, call)(path, flags, mode);
    pthread_mutex_lock(&lock);
    const bool there = access(path, F_OK) == 0;
    const int fd = REAL(open_call, call)(path, flags, mode);
    if (fd >= 0 && !there)
        record("{\"a\": \"create\", \"p\": \"%s\"}\n", name);
    pthread_mutex_unlock(&lock);
    return fd;
}

static mode_t mode_of(int flags, va_list args)
{
    return flags & O_CREAT ? va_arg(args, mode_t) : 0;
}

int open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const mode_t mode = mode_of(flags, args);
    va_end(args);
    return open_with("open", path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const mode_t mode = mode_of(flags, args);
    va_end(args);
    return open_with("open64", path, flags, mode);
}

static FILE *fopen_with(const char *call, const char *path, const char *mode)
{
    const char *name = *mode == 'r' ? NULL : below(path);
    if (!name)
        return REAL(FILE * (*)(const char *, const char *), call)(path, mode);
    pthread_mutex_lock(&lock);
    const bool there = access(path, F_OK) == 0;
    FILE *file = REAL(FILE * (*)(const char *, const char *), call)(path, mode);
    if (file && !there)
        record("{\"a\": \"create\", \"p\": \"%s\"}\n", name);
    pthread_mutex_unlock(&lock);
    return file;
}

FILE *fopen(const char *path, const char *mode)
{
    return fopen_with("fopen", path, mode);
}

FILE *fopen64(const char *path, const char *mode)
{
    return fopen_with("fopen64", path, mode);
}

int mkdir(const char *path, mode_t mode)
{
    pthread_mutex_lock(&lock);
    const int rc = REAL(int (*)(const char *, mode_t), "mkdir")(path, mode);
    if (rc == 0 && below(path))
        record("{\"a\": \"mkdir\", \"p\": \"%s\"}\n", below(path));
    pthread_mutex_unlock(&lock);
    return rc;
}

static int remove_with(const char *call, const char *path)
{
    struct stat st;
    pthread_mutex_lock(&lock);
    const bool folder = lstat(path, &st) == 0 && S_ISDIR(st.st_mode);
    const int rc = REAL(path_call, call)(path);
    if (rc == 0 && below(path))
        record("{\"a\": \"%s\", \"p\": \"%s\"}\n", folder ? "rmdir" : "unlink", below(path));
    pthread_mutex_unlock(&lock);
    return rc;
}

int unlink(const char *path)
{
    return remove_with("unlink", path);
}

int rmdir(const char *path)
{
    return remove_with("rmdir", path);
}

int remove(const char *path)
{
    return remove_with("remove", path);
}

int rename(const char *from, const char *to)
{
    pthread_mutex_lock(&lock);
    const int rc = REAL(int (*)(const char *, const char *), "rename")(from, to);
    if (rc == 0 && below(from) && below(to))
        record("{\"a\": \"rename\", \"p\": \"%s\", \"q\": \"%s\"}\n", below(from), below(to));
    pthread_mutex_unlock(&lock);
    return rc;
}

/*
 * Makes the disk fail, or memory (scarce.c): loaded before the C library (LD_PRELOAD) into a
 * program under test, it lets calls fail while a file says so.
 *
 * The file's name is in FAULTY, and in it are four numbers, as written by struct.pack("iiii"): an
 * errno, 0 for a sound machine; which calls fail; which of these alone, counted from 1, or 0 for
 * all; and how many there were, counted here. Children of the program count with it. Standard input
 * and outputs are spared, and so is what is no regular file or folder.
 *
 * With FAULTY_SLOW no call fails: a sync by the first thread of the program, which is a daemon's
 * loop, takes as many milliseconds more as the errno says, and is counted.
 *
 * A thread that moves a file to a name with FAULTY_CRASH in it makes a fault that ends the process;
 * one that opens a file with FAULTY_JUMP in its name calls a null pointer, and with FAULTY_OVERFLOW
 * in it overflows its stack.
 *
 * A thread that moves a file to a name with FAULTY_HANG in it is blocked for good, as by a file
 * server that does not answer; it makes the folder FAULTY_HANG_NOTE before.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum {
    FAULTY_WRITES = 1,
    FAULTY_SYNCS = 2,
    FAULTY_NAMES = 4,
    FAULTY_REMOVALS = 16,
    FAULTY_SLOW = 32
};

struct control {
    atomic_int why, which, nth, count;
};
static struct control *control;

__attribute__((constructor)) static void open_control(void)
{
    const char *path = getenv("FAULTY");
    const int fd = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
    void *file = fd < 0 ? MAP_FAILED
                        : mmap(NULL, sizeof *control, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (file != MAP_FAILED)
        control = file;
    if (fd >= 0)
        close(fd);
}

/* Returns true if a call of this kind must fail. scarce.c calls it, too. */
int faulty_is_due(int what);
int faulty_is_due(int what)
{
    if (!control || control->why == 0 || (control->which & what) == 0)
        return 0;
    const int call = 1 + atomic_fetch_add(&control->count, 1), nth = control->nth;
    if (nth != 0 && call != nth)
        return 0;
    errno = control->why;
    return 1;
}

static int is_faulty(int fd, int what)
{
    struct stat st;
    if (!control || control->why == 0 || (control->which & what) == 0 || (fd >= 0 && fd <= 2))
        return 0;
    if (fd > 2 && (fstat(fd, &st) != 0 || !(S_ISREG(st.st_mode) || S_ISDIR(st.st_mode))))
        return 0;
    return faulty_is_due(what);
}

#define REAL(type, name) ((type)(uintptr_t)dlsym(RTLD_NEXT, name))

ssize_t write(int fd, const void *data, size_t size)
{
    return is_faulty(fd, FAULTY_WRITES)
               ? -1
               : REAL(ssize_t(*)(int, const void *, size_t), "write")(fd, data, size);
}

ssize_t pwrite(int fd, const void *data, size_t size, off_t at)
{
    return is_faulty(fd, FAULTY_WRITES)
               ? -1
               : REAL(ssize_t(*)(int, const void *, size_t, off_t), "pwrite")(fd, data, size, at);
}

ssize_t pwrite64(int fd, const void *data, size_t size, off64_t at)
{
    return is_faulty(fd, FAULTY_WRITES) ? -1
                                        : REAL(ssize_t(*)(int, const void *, size_t, off64_t),
                                               "pwrite64")(fd, data, size, at);
}

int ftruncate64(int fd, off64_t size)
{
    return is_faulty(fd, FAULTY_WRITES) ? -1 : REAL(int (*)(int, off64_t), "ftruncate64")(fd, size);
}

int posix_fallocate(int fd, off_t at, off_t size)
{
    return is_faulty(fd, FAULTY_WRITES)
               ? errno
               : REAL(int (*)(int, off_t, off_t), "posix_fallocate")(fd, at, size);
}

int mkdir(const char *path, mode_t mode)
{
    return is_faulty(-1, FAULTY_WRITES) ? -1
                                        : REAL(int (*)(const char *, mode_t), "mkdir")(path, mode);
}

static void be_slow(void)
{
    const int ms = control && (control->which & FAULTY_SLOW) ? (int)control->why : 0;
    if (ms == 0 || gettid() != getpid())
        return;
    atomic_fetch_add(&control->count, 1);
    nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L}, NULL);
}

int fsync(int fd)
{
    be_slow();
    return is_faulty(fd, FAULTY_SYNCS) ? -1 : REAL(int (*)(int), "fsync")(fd);
}

int fdatasync(int fd)
{
    be_slow();
    return is_faulty(fd, FAULTY_SYNCS) ? -1 : REAL(int (*)(int), "fdatasync")(fd);
}

int unlink(const char *path)
{
    return faulty_is_due(FAULTY_REMOVALS) ? -1 : REAL(int (*)(const char *), "unlink")(path);
}

int unlinkat(int folder, const char *path, int flags)
{
    return faulty_is_due(FAULTY_REMOVALS)
               ? -1
               : REAL(int (*)(int, const char *, int), "unlinkat")(folder, path, flags);
}

/* Recurses until the stack ends; the volatile bytes keep it from becoming a loop. */
static int overflow_stack(int depth)
{
    volatile char bytes[4096];
    bytes[0] = (char)depth;
    return depth < 0 ? 0 : bytes[0] + overflow_stack(depth + 1) + bytes[0];
}

static int is_named(const char *path, const char *variable)
{
    const char *name = getenv(variable);
    return name && strstr(path, name) != NULL;
}

int open(const char *path, int flags, ...)
{
    static void (*volatile nowhere)(void);
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    if (is_named(path, "FAULTY_JUMP"))
        nowhere();
    if (is_named(path, "FAULTY_OVERFLOW"))
        overflow_stack(0);
    return REAL(int (*)(const char *, int, ...), "open")(path, flags, mode);
}

static void hang_at(const char *to)
{
    const char *name = getenv("FAULTY_HANG"), *note = getenv("FAULTY_HANG_NOTE");
    if (!name || !strstr(to, name))
        return;
    if (note)
        mkdir(note, 0700);
    for (;;)
        pause();
}

int rename(const char *from, const char *to)
{
    const char *name = getenv("FAULTY_CRASH");
    volatile int *nowhere = NULL;
    hang_at(to);
    if (name && strstr(to, name))
        *nowhere = 1;
    return faulty_is_due(FAULTY_NAMES)
               ? -1
               : REAL(int (*)(const char *, const char *), "rename")(from, to);
}

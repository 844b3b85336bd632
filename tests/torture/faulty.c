/*
 * Makes the disk fail: loaded before the C library (LD_PRELOAD) into a program under test, it lets
 * calls that need the disk fail while a file says so.
 *
 * The file's name is in FAULTY, and in it are two numbers, as written by struct.pack("ii"): an
 * errno, 0 for a good disk, and which calls fail. Standard input and outputs are spared, and so is
 * what is no regular file.
 *
 * A thread that moves a file to a name with FAULTY_CRASH in it makes a fault that ends the process.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FAULTY_WRITES = 1, FAULTY_SYNCS = 2 };

static const volatile int *control; /* errno, which */

__attribute__((constructor)) static void open_control(void)
{
    const char *path = getenv("FAULTY");
    const int fd = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    void *file = fd < 0 ? MAP_FAILED : mmap(NULL, 2 * sizeof(int), PROT_READ, MAP_SHARED, fd, 0);
    if (file != MAP_FAILED)
        control = file;
    if (fd >= 0)
        close(fd);
}

static int is_faulty(int fd, int what)
{
    struct stat st;
    if (!control || control[0] == 0 || (control[1] & what) == 0 || (fd >= 0 && fd <= 2))
        return 0;
    if (fd > 2 && (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)))
        return 0;
    errno = control[0];
    return 1;
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

int fsync(int fd)
{
    return is_faulty(fd, FAULTY_SYNCS) ? -1 : REAL(int (*)(int), "fsync")(fd);
}

int fdatasync(int fd)
{
    return is_faulty(fd, FAULTY_SYNCS) ? -1 : REAL(int (*)(int), "fdatasync")(fd);
}

int rename(const char *from, const char *to)
{
    const char *name = getenv("FAULTY_CRASH");
    volatile int *nowhere = NULL;
    if (name && strstr(to, name))
        *nowhere = 1;
    return REAL(int (*)(const char *, const char *), "rename")(from, to);
}

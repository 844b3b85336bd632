/* This file has the only calls of open() on paths from outside; tests/check_boundaries finds
 * others. */
#include <oriel/base/files.h>

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/error.h>

enum { CREATED_MODE = 0666 }; /* less the process's umask */

static int close_with(int fd, int why)
{
    close(fd);
    errno = why;
    return -1;
}

int orl_open_regular(const char *path, int flags)
{
    struct stat st;
    const int fd = open(path, flags | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, CREATED_MODE);
    if (fd < 0) {
        if (errno == ENXIO) /* a pipe without a reader, or a socket */
            errno = ORL_OPEN_NOT_REGULAR;
        return -1;
    }
    if (fstat(fd, &st) != 0)
        return close_with(fd, errno);
    return S_ISREG(st.st_mode) ? fd : close_with(fd, ORL_OPEN_NOT_REGULAR);
}

const char *orl_open_reason(int why)
{
    return why == ORL_OPEN_NOT_REGULAR ? "not a regular file" : strerror(why);
}

int orl_open_err_of_stored(int why)
{
    return why == ORL_OPEN_NOT_REGULAR ? ORL_ERR_CORRUPT : ORL_ERR_IO;
}

static FILE *stream_of(int fd, const char *mode)
{
    FILE *stream = fd < 0 ? NULL : fdopen(fd, mode);
    if (fd >= 0 && !stream)
        close_with(fd, errno);
    return stream;
}

FILE *orl_fopen_regular(const char *path, char mode)
{
    switch (mode) {
    case 'r':
        return stream_of(orl_open_regular(path, O_RDONLY), "rb");
    case 'a':
        return stream_of(orl_open_regular(path, O_WRONLY | O_CREAT | O_APPEND), "ab");
    default:
        return stream_of(orl_open_regular(path, O_WRONLY | O_CREAT | O_TRUNC), "wb");
    }
}

FILE *orl_fopen_device(const char *path)
{
    const int fd = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd < 0)
        return NULL;
    const int flags = fcntl(fd, F_GETFL);
    if (flags < 0 || fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) != 0) {
        close_with(fd, errno);
        return NULL;
    }
    return stream_of(fd, "wb");
}

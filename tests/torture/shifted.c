/*
 * Shifts the wall clock: loaded before the C library (LD_PRELOAD) into a program under test, it
 * adds as many seconds to CLOCK_REALTIME as the file $SHIFTED says, a decimal number, which may
 * change at any time. The steady clock is left alone.
 */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static long long shift_s(void)
{
    char text[32] = "";
    const char *path = getenv("SHIFTED");
    const int fd = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (fd < 0)
        return 0;
    const ssize_t n = read(fd, text, sizeof text - 1);
    close(fd);
    return n > 0 ? strtoll(text, NULL, 10) : 0;
}

int clock_gettime(clockid_t clock, struct timespec *ret_now)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real)
        real = (int (*)(clockid_t, struct timespec *))(uintptr_t)dlsym(RTLD_NEXT, "clock_gettime");
    const int failed = real(clock, ret_now);
    if (!failed && clock == CLOCK_REALTIME)
        ret_now->tv_sec += shift_s();
    return failed;
}

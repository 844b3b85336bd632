/*
 * Embree builds that run out of memory, in a thread prepared for it: the result is an error, and
 * the process survives. Each allocation fails once alone, and once with all that follow. The task
 * library has its own allocator, or (as in a process that may open no files) has none.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scene/geometry/embree_device.h"
#include "scene/geometry/intersect.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
#define FAILING 0 /* sanitizers replace the allocator; so does clang's static analysis */
#else
#define FAILING 1
#endif

static long calls, failing_from, failing_to;
static bool no_allocator; /* true: only the C library's allocator */

#if FAILING
static bool fails(void)
{
    const long call = __atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED);
    if (call < failing_from || call >= failing_to)
        return false;
    errno = ENOMEM;
    return true;
}

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *before, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *before, size_t size)
{
    return fails() ? NULL : __libc_realloc(before, size);
}

int posix_memalign(void **ret_block, size_t alignment, size_t size)
{
    void *block = fails() ? NULL : __libc_memalign(alignment, size);
    if (block)
        *ret_block = block;
    return block ? 0 : ENOMEM;
}

/* Embree's libraries call these by their exported names. */
void *memalign(size_t alignment, size_t size);
void *memalign(size_t alignment, size_t size)
{
    return fails() ? NULL : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return fails() ? NULL : __libc_memalign(alignment, size);
}

void *dlopen(const char *file, int mode)
{
    void *(*real)(const char *, int);
    void *symbol = dlsym(RTLD_NEXT, "dlopen");
    memcpy(&real, &symbol, sizeof real);
    return no_allocator && file && strstr(file, "tbbmalloc") ? NULL : real(file, mode);
}

void *mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
    void *(*real)(void *, size_t, int, int, int, off_t);
    void *symbol = dlsym(RTLD_NEXT, "mmap");
    memcpy(&real, &symbol, sizeof real);
    return (flags & MAP_ANONYMOUS) && fails() ? MAP_FAILED
                                              : real(at, size, protection, flags, fd, offset);
}
#endif

static int build(long from, long to)
{
    enum { COUNT = 2000 };
    static struct orl_mesh_quad quads[COUNT];
    static struct orl_vec3 corners[3 * COUNT];
    struct orl_geometry geometry = {
        .quads = quads, .n_quads = COUNT, .corners = corners, .n_corners = 3 * (size_t)COUNT};
    for (int i = 0; i < COUNT; i++) {
        corners[3 * i] = orl_v3(i % 50, i / 50, i % 7);
        corners[3 * i + 1] = orl_v3(i % 50 + 1, i / 50, i % 11);
        corners[3 * i + 2] = orl_v3(i % 50, i / 50 + 1, i % 13);
        for (unsigned k = 0; k < 4; k++)
            quads[i].corners[k] = 3 * (unsigned)i + (k < 3 ? k : 2);
    }
    calls = 0;
    failing_from = from;
    failing_to = to;
    const int rc = orl_embree_build(&geometry, NULL, NULL);
    orl_embree_free(&geometry);
    failing_to = 0;
    return rc;
}

/* Runs prepared builds in a child process. Returns the number of allocations, or -1 if it died,
 * for both a successful and a failed build. */
static long count_calls(long from, long to)
{
    enum { SECONDS = 60 };
    int status, ends[2];
    long count = -1;
    assert_int_equal(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        alarm(SECONDS); /* some faults hang forever */
        if (dup2(open("/dev/null", O_WRONLY), STDERR_FILENO) < 0 || !orl_embree_device())
            _exit(1);
        const int rc = build(from, to);
        if (rc == 0 || rc == ORL_ERR_NOMEM)
            _exit(write(ends[1], &calls, sizeof calls) != (ssize_t)sizeof calls);
        _exit(1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    close(ends[1]);
    if (read(ends[0], &count, sizeof count) != (ssize_t)sizeof count)
        count = -1;
    close(ends[0]);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? count : -1;
}

static void fail_each(bool and_all_behind)
{
    const long count = count_calls(0, 0);
    assert_true(count > 15);
    for (long i = 0; i < count; i++)
        if (count_calls(i, and_all_behind ? LONG_MAX : i + 1) < 0)
            fail_msg("a process ends at allocation %ld of %ld", i, count);
}

static void test_failing_allocations(void **state)
{
    (void)state;
    if (!FAILING)
        skip();
    fail_each(false);
    fail_each(true);
}

/* The C library's allocator fails for errors passed from task to task; these end the process if
 * all allocations fail from one on. */
static void test_without_an_allocator(void **state)
{
    (void)state;
    if (!FAILING)
        skip();
    no_allocator = true;
    fail_each(false);
    no_allocator = false;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_failing_allocations),
                                       cmocka_unit_test(test_without_an_allocator)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/*
 * No memory while Embree builds: an error, and the process lives. Each of its allocations fails by
 * itself in turn, and with all that follow.
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

#include "scene/embree.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
#define FAILING 0 /* sanitizers have allocators of their own; clang's check of them has too */
#else
#define FAILING 1
#endif

static long calls, failing_from, failing_to;

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
    static struct orl_triangle triangles[COUNT];
    struct orl_geometry geometry = {.triangles = triangles, .n_triangles = COUNT};
    for (int i = 0; i < COUNT; i++) {
        triangles[i].a = orl_v3(i % 50, i / 50, i % 7);
        triangles[i].b = orl_v3(i % 50 + 1, i / 50, i % 11);
        triangles[i].c = orl_v3(i % 50, i / 50 + 1, i % 13);
    }
    calls = 0;
    failing_from = from;
    failing_to = to;
    const int rc = orl_embree_build(&geometry, NULL, NULL);
    orl_embree_free(&geometry);
    failing_to = 0;
    return rc;
}

/* Whether a process that builds so lives, with an error or without. */
static bool lives(long from, long to)
{
    int status;
    const pid_t pid = fork();
    if (pid == 0) {
        if (dup2(open("/dev/null", O_WRONLY), STDERR_FILENO) < 0)
            _exit(1);
        const int rc = build(from, to);
        _exit(rc == 0 || rc == ORL_ERR_NOMEM ? 0 : 1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/*
 * Room for errors is made by a call of Embree's that cannot itself fail without ending the process:
 * where memory ends for good within its two allocations, just after there were 64 KiB, nothing
 * helps. Without that every place but a few ended it.
 */
static void test_failing_allocations(void **state)
{
    enum { FOR_GOOD = 4 };
    int ends = 0;
    (void)state;
    if (!FAILING)
        skip();
    assert_int_equal(build(0, 0), 0);
    const long count = calls;
    assert_true(count > 20);
    for (long i = 0; i < count; i++) {
        assert_true(lives(i, i + 1));
        ends += !lives(i, LONG_MAX);
    }
    print_message("# %ld allocations: %d ends of the process\n", count, ends);
    assert_true(ends <= FOR_GOOD);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_failing_allocations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

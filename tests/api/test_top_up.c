/* Topping up maps through a real daemon: the resulting maps equal those of a daemon that never had
 * smaller ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/daemon.h"
#include "support/scene_text.h"

enum { FEW = 5000, MORE = 20000, MOST = 60000, MOST_MAPS = 3 };

static const char *const two_at_once[] = {"--threads", "2", "--jobs", "2", NULL};

struct fixture {
    struct daemon daemon, fresh; /* fresh: a daemon that never has a smaller map */
    char scene[65];              /* equal in both, since it is a digest */
};

static int setup(void **state)
{
    static struct fixture fixture;
    daemon_start(&fixture.daemon, two_at_once);
    daemon_upload_room(&fixture.daemon, fixture.scene);
    daemon_start(&fixture.fresh, two_at_once);
    daemon_upload_room(&fixture.fresh, fixture.scene);
    *state = &fixture;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    daemon_remove(&f->daemon);
    daemon_remove(&f->fresh);
    return 0;
}

/* Waits for a job; the caller owns its document. */
static struct reply wait_for_job(struct daemon *daemon, const char *job)
{
    struct reply reply;
    daemon_wait(daemon, job, 120, &reply);
    if (strcmp(reply_text(&reply, "state"), "succeeded") != 0)
        fail_msg("%s: %s", job, reply.body);
    return reply;
}

static struct reply run_job(struct fixture *f, struct daemon *daemon, long photons)
{
    char job[80];
    daemon_submit(daemon, f->scene, photons, 1, NULL, job);
    return wait_for_job(daemon, job);
}

/* Expects that every map of the job is, byte for byte, in the other daemon. */
static void expect_same_maps(const struct fixture *f, const struct reply *job)
{
    const size_t count = json_array_size(reply_at(job, "maps"));
    assert_true(count > 0 && count <= MOST_MAPS);
    for (size_t i = 0; i < count; i++) {
        const char *const roots[2] = {f->daemon.root, f->fresh.root};
        unsigned char *bytes[2];
        size_t size[2];
        for (int k = 0; k < 2; k++) {
            char kind[32], key[32], path[256];
            snprintf(kind, sizeof kind, "maps.%zu.kind", i);
            snprintf(key, sizeof key, "maps.%zu.key", i);
            snprintf(path, sizeof path, "%s/maps/%s-%s.opm", roots[k], reply_text(job, kind),
                     reply_text(job, key));
            bytes[k] = scene_read_bytes(path, &size[k]);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        free(bytes[0]);
        free(bytes[1]);
    }
}

static void test_topped_up(void **state)
{
    struct fixture *f = *state;
    struct reply first = run_job(f, &f->daemon, FEW);
    assert_true(reply_number(&first, "maps.0.reused") == 0);
    /* The database also records which map another continues. */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, two_at_once);
    struct reply second = run_job(f, &f->daemon, MORE);
    assert_true(json_is_false(reply_at(&second, "maps.0.cached")));
    assert_true(reply_number(&second, "maps.0.reused") == reply_number(&first, "maps.0.stored"));
    assert_true(reply_number(&second, "maps.0.seconds") > reply_number(&first, "maps.0.seconds"));
    struct reply whole = run_job(f, &f->fresh, MORE);
    assert_true(reply_number(&whole, "maps.0.reused") == 0);
    expect_same_maps(f, &second);
    struct reply again = run_job(f, &f->daemon, MORE);
    assert_true(json_is_true(reply_at(&again, "maps.0.cached")));
    assert_true(reply_number(&again, "maps.0.reused") == 0);
    reply_done(&first);
    reply_done(&second);
    reply_done(&whole);
    reply_done(&again);
}

/* Jobs of one family at the same time: each ends with the maps that it would have alone. */
static void test_family_at_once(void **state)
{
    static const long photons[] = {MORE, MOST, MOST, FEW, MORE};
    enum { JOBS = sizeof photons / sizeof *photons };
    struct fixture *f = *state;
    char jobs[JOBS][80];
    struct reply first = run_job(f, &f->daemon, FEW);
    reply_done(&first);
    for (int i = 0; i < JOBS; i++)
        daemon_submit(&f->daemon, f->scene, photons[i], 1, NULL, jobs[i]);
    for (int i = 0; i < JOBS; i++) {
        struct reply job = wait_for_job(&f->daemon, jobs[i]);
        reply_done(&job);
    }
    for (int i = 0; i < 3; i++) { /* the largest first, so that none is topped up */
        struct reply whole = run_job(f, &f->fresh, i == 0 ? MOST : i == 1 ? MORE : FEW);
        assert_true(reply_number(&whole, "maps.0.reused") == 0);
        reply_done(&whole);
    }
    for (int i = 0; i < JOBS; i++) {
        struct reply job = wait_for_job(&f->daemon, jobs[i]);
        expect_same_maps(f, &job);
        reply_done(&job);
    }
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {EACH(test_topped_up), EACH(test_family_at_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

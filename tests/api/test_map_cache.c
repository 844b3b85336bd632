/*
 * The map cache alone, without HTTP: one build for many jobs, taking over, cancelling, restarting.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "cache/map_cache.h"
#include "support/data_folder.h"
#include "support/patience.h"

#define KEY "00000000000000000000000000000000000000000000000000000000000000aa"

struct fixture {
    struct data_folder data;
    struct orl_map_cache *cache;
    struct orl_map_store store;
    atomic_int woken, ended, faults;
    struct orl_error err;
};

/* Replaces the C library's function: the wall clock may be ahead. */
static atomic_int wall_ahead_s;
static _Thread_local atomic_int
    *looks_at_clock; /* counter of this thread's clock reads; NULL: not counted */
int clock_gettime(clockid_t clock, struct timespec *ret_time)
{
    if (looks_at_clock)
        atomic_fetch_add(looks_at_clock, 1);
    const int rc = (int)syscall(SYS_clock_gettime, clock, ret_time);
    if (rc == 0 && clock == CLOCK_REALTIME)
        ret_time->tv_sec += atomic_load(&wall_ahead_s);
    return rc;
}

static void wake(void *ctx)
{
    atomic_fetch_add(&((struct fixture *)ctx)->woken, 1);
}

static int open_cache(struct fixture *f)
{
    const int rc = orl_map_cache_open(uv_default_loop(), &f->data.folders, &f->data.db, wake, f,
                                      &f->cache, &f->err);
    if (rc == 0)
        f->store = orl_map_cache_store(f->cache);
    return rc;
}

static int open_all(struct fixture *f)
{
    const int rc = data_folder_open(&f->data, &f->err);
    return rc ? rc : open_cache(f);
}

static void close_all(struct fixture *f)
{
    orl_map_cache_close(f->cache);
    f->cache = NULL;
    data_folder_close(&f->data);
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    *state = f;
    return data_folder_make(&f->data, &f->err) || open_cache(f) ? -1 : 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    close_all(f);
    data_folder_remove(&f->data);
    free(f);
    return 0;
}

static struct orl_map_info info_of(double seconds)
{
    return (struct orl_map_info){
        .kind = "global", .key = KEY, .emitted = 20, .stored = 10, .bytes = 3, .seconds = seconds};
}

static void build(struct fixture *f, const char *path)
{
    const struct orl_map_info info = info_of(2.5);
    assert_int_equal(orl_write_file(path, "map", 3, &f->err), 0);
    assert_int_equal(f->store.commit(f->store.ctx, &info, &f->err), 0);
}

static bool acquire(struct fixture *f, char path[4096], struct orl_map_info *info)
{
    bool hit = false;
    assert_int_equal(f->store.acquire(f->store.ctx, "global", KEY, NULL, path, &hit, info, &f->err),
                     0);
    return hit;
}

static void test_miss_then_hit(void **state)
{
    struct fixture *f = *state;
    char path[4096];
    struct orl_map_info info;
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_true(access(path, F_OK) != 0); /* renamed to its final path */
    f->store.release(f->store.ctx, "global", KEY);
    assert_true(acquire(f, path, &info));
    assert_int_equal(access(path, R_OK), 0);
    assert_true(info.cached);
    assert_true(info.seconds == 2.5);
    assert_int_equal(info.stored, 10);
    f->store.release(f->store.ctx, "global", KEY);

    struct orl_stored_map *maps = NULL;
    size_t count = 0;
    assert_int_equal(orl_map_cache_list(f->cache, &maps, &count, &f->err), 0);
    assert_int_equal(count, 1);
    assert_int_equal(maps[0].hits, 1);
    assert_true(maps[0].seconds_saved == 2.5);
    free(maps);
    assert_int_equal(atomic_load(&f->woken), 4); /* the commit, the hit, each released */
}

struct racer {
    struct fixture *f;
    pthread_t thread;
    atomic_int *builds;
    bool fails; /* fails the first build */
    bool hit;
};

static void *race(void *arg)
{
    struct racer *racer = arg;
    struct fixture *f = racer->f;
    char path[4096];
    struct orl_map_info info;
    struct orl_error err;
    if (f->store.acquire(f->store.ctx, "global", KEY, NULL, path, &racer->hit, &info, &err))
        return NULL;
    if (!racer->hit) {
        const int nth = atomic_fetch_add(racer->builds, 1);
        usleep(30000);
        if (racer->fails && nth == 0) {
            f->store.abandon(f->store.ctx, "global", KEY);
            return NULL;
        }
        info = info_of(1);
        orl_write_file(path, "map", 3, &err);
        f->store.commit(f->store.ctx, &info, &err);
    }
    f->store.release(f->store.ctx, "global", KEY);
    return racer;
}

static void run_race(struct fixture *f, bool fails, int expected_builds, int expected_done)
{
    enum { RACERS = 8 };
    struct racer racers[RACERS];
    atomic_int builds = 0;
    int hits = 0, done = 0;
    for (int i = 0; i < RACERS; i++) {
        racers[i] = (struct racer){.f = f, .builds = &builds, .fails = fails};
        assert_int_equal(pthread_create(&racers[i].thread, NULL, race, &racers[i]), 0);
    }
    for (int i = 0; i < RACERS; i++) {
        void *ok = NULL;
        pthread_join(racers[i].thread, &ok);
        done += ok != NULL;
        hits += racers[i].hit;
    }
    assert_int_equal(atomic_load(&builds), expected_builds);
    assert_int_equal(done, expected_done);
    assert_int_equal(hits, RACERS - expected_builds);
}

static void test_eight_jobs_one_build(void **state)
{
    run_race(*state, false, 1, 8);
}

/* The builder fails: exactly one of the waiting jobs takes over. */
static void test_another_takes_over(void **state)
{
    run_race(*state, true, 2, 7);
}

static void test_waiting_can_be_cancelled(void **state)
{
    struct fixture *f = *state;
    char path[4096];
    struct orl_map_info info;
    atomic_bool cancel = true;
    bool hit = true;
    assert_false(acquire(f, path, &info));
    assert_int_equal(
        f->store.acquire(f->store.ctx, "global", KEY, &cancel, path, &hit, &info, &f->err),
        ORL_ERR_CANCELLED);
    f->store.abandon(f->store.ctx, "global", KEY);
}

struct waiter {
    struct fixture *f;
    atomic_bool cancel, ended;
    atomic_int looks; /* number of clock reads */
};

static void *wait_for_build(void *arg)
{
    struct waiter *waiter = arg;
    struct fixture *f = waiter->f;
    char path[4096];
    struct orl_map_info info;
    struct orl_error err;
    bool hit = true;
    looks_at_clock = &waiter->looks;
    f->store.acquire(f->store.ctx, "global", KEY, &waiter->cancel, path, &hit, &info, &err);
    atomic_store(&waiter->ended, true);
    return NULL;
}

/* The wall clock is set back by an hour while a job waits: it polls its cancel flag as often as
 * before. */
static void test_clock_put_back(void **state)
{
    static struct waiter waiter; /* static, so that it outlives a failed test */
    char path[4096];
    struct orl_map_info info;
    pthread_t thread;
    waiter.f = *state;
    assert_false(acquire(waiter.f, path, &info));
    atomic_store(&wall_ahead_s, 3600);
    assert_int_equal(pthread_create(&thread, NULL, wait_for_build, &waiter), 0);
    /* The end of its sleep has been computed. */
    for (double until = patience_until(); !atomic_load(&waiter.looks) && patience_nap(until);)
        continue;
    assert_true(atomic_load(&waiter.looks) > 0);
    atomic_store(&wall_ahead_s, 0);
    atomic_store(&waiter.cancel, true);
    for (double until = patience_until(); !atomic_load(&waiter.ended) && patience_nap(until);)
        continue;
    assert_true(atomic_load(&waiter.ended));
    pthread_join(thread, NULL);
    waiter.f->store.abandon(waiter.f->store.ctx, "global", KEY);
}

static void test_survives_restart(void **state)
{
    struct fixture *f = *state;
    char path[4096];
    struct orl_map_info info;
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_int_equal(orl_map_cache_flush(f->cache, &f->err), 0);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    assert_true(acquire(f, path, &info));
    assert_true(info.seconds == 2.5);
}

/* A file without a row (a crash just after the rename) is removed, and a row without a file. */
static void test_orphans_go_at_start(void **state)
{
    struct fixture *f = *state;
    char path[4096], final[ORL_PATH_MAX];
    struct orl_map_info info;
    orl_folders_path(&f->data.folders, final, "maps/global-%s.opm", KEY);
    assert_false(acquire(f, path, &info));
    build(f, path);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    assert_true(access(final, F_OK) != 0);
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_int_equal(orl_map_cache_flush(f->cache, &f->err), 0);
    assert_int_equal(unlink(final), 0);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    struct orl_stored_map *maps = NULL;
    size_t count = 7;
    assert_int_equal(orl_map_cache_list(f->cache, &maps, &count, &f->err), 0);
    assert_int_equal(count, 0);
    free(maps);
    assert_false(acquire(f, path, &info));
}

/* A damaged map is dropped on a hit, file and row, and built again. */
static void test_damaged_map_is_rebuilt(void **state)
{
    struct fixture *f = *state;
    char path[4096], final[4096];
    struct orl_map_info info;
    assert_false(acquire(f, path, &info));
    build(f, path);
    f->store.release(f->store.ctx, "global", KEY);
    assert_true(acquire(f, final, &info));
    f->store.abandon(f->store.ctx, "global", KEY);
    assert_true(access(final, F_OK) != 0);
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_true(acquire(f, final, &info));
    assert_int_equal(access(final, R_OK), 0);
}

/* A map whose file was deleted by hand is a miss, not a failure of every job that needs it. */
static void test_removed_map_is_rebuilt(void **state)
{
    struct fixture *f = *state;
    char path[4096], final[4096];
    struct orl_map_info info;
    assert_false(acquire(f, path, &info));
    build(f, path);
    f->store.release(f->store.ctx, "global", KEY);
    assert_true(acquire(f, final, &info));
    f->store.release(f->store.ctx, "global", KEY);
    assert_int_equal(unlink(final), 0);
    assert_false(acquire(f, path, &info));
    build(f, path);
    f->store.release(f->store.ctx, "global", KEY);
    assert_true(acquire(f, final, &info));
    assert_int_equal(access(final, R_OK), 0);
    f->store.release(f->store.ctx, "global", KEY);
}

/* ---- Families ------------------------------------------------------------------------------- */

#define FAMILY "00000000000000000000000000000000000000000000000000000000000000fa"

/* Returns a key for each target. */
static void key_of(uint64_t target, char ret_key[ORL_DIGEST_HEX + 1])
{
    snprintf(ret_key, ORL_DIGEST_HEX + 1, "%064llx", (unsigned long long)target);
}

static void begin_build(struct fixture *f, uint64_t target, char ret_path[4096])
{
    char key[ORL_DIGEST_HEX + 1];
    struct orl_map_info info;
    bool hit = true;
    key_of(target, key);
    assert_int_equal(
        f->store.acquire(f->store.ctx, "global", key, NULL, ret_path, &hit, &info, &f->err), 0);
    assert_false(hit);
}

static void finish_build(struct fixture *f, uint64_t target, const char *path)
{
    struct orl_map_info info = {.kind = "global", .family = FAMILY, .target = target, .seconds = 2};
    key_of(target, info.key);
    assert_int_equal(orl_write_file(path, "map", 3, &f->err), 0);
    assert_int_equal(f->store.commit(f->store.ctx, &info, &f->err), 0);
    f->store.release(f->store.ctx, "global", info.key);
}

/* Returns the target of the map to top up, 0 for none; releases the map. */
static uint64_t smaller_than(struct fixture *f, const char *kind, const char *family,
                             uint64_t target)
{
    char path[4096];
    struct orl_map_info info = {.target = 0};
    bool found = false;
    assert_int_equal(
        f->store.find_smaller(f->store.ctx, kind, family, target, path, &found, &info, &f->err), 0);
    if (!found)
        return 0;
    assert_int_equal(access(path, R_OK), 0);
    f->store.release(f->store.ctx, kind, info.key);
    return info.target;
}

/*
 * Finds the family's largest complete map below the target whose file exists; also after a restart.
 */
static void test_finds_the_largest_smaller(void **state)
{
    struct fixture *f = *state;
    static const uint64_t targets[] = {500, 2000, 1000};
    char path[4096], key[ORL_DIGEST_HEX + 1];
    for (size_t i = 0; i < 3; i++) {
        begin_build(f, targets[i], path);
        assert_int_equal(smaller_than(f, "global", FAMILY, 501), i > 0 ? 500 : 0);
        finish_build(f, targets[i], path);
    }
    begin_build(f, 1500, path); /* still being built, so not available */
    for (int opened = 0; opened < 2; opened++) {
        assert_int_equal(smaller_than(f, "global", FAMILY, 2000), 1000);
        assert_int_equal(smaller_than(f, "global", FAMILY, 2001), 2000);
        assert_int_equal(smaller_than(f, "global", FAMILY, 500), 0);
        assert_int_equal(smaller_than(f, "caustic", FAMILY, 2001), 0);
        assert_int_equal(smaller_than(f, "global", KEY, 2001), 0);
        assert_int_equal(orl_map_cache_flush(f->cache, &f->err), 0);
        close_all(f);
        assert_int_equal(open_all(f), 0);
    }
    key_of(1000, key);
    orl_folders_path(&f->data.folders, path, "maps/global-%s.opm", key);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(smaller_than(f, "global", FAMILY, 2000), 500);
}

/* A map built as a whole has no family, and is never found. */
static void test_no_family(void **state)
{
    struct fixture *f = *state;
    char path[4096];
    struct orl_map_info info;
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_int_equal(smaller_than(f, "global", FAMILY, UINT64_MAX), 0);
}

static enum orl_map_removal remove_map(struct fixture *f)
{
    enum orl_map_removal removal = ORL_MAP_IN_USE;
    assert_int_equal(orl_map_cache_remove(f->cache, "global", KEY, &removal, &f->err), 0);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    return removal;
}

static size_t count_rows(struct fixture *f)
{
    struct orl_stored_map *maps = NULL;
    size_t count = 0;
    assert_int_equal(orl_map_cache_list(f->cache, &maps, &count, &f->err), 0);
    free(maps);
    return count;
}

/* Only a map that no job builds or holds is removed; the removal lasts over a restart. */
static void test_removal(void **state)
{
    struct fixture *f = *state;
    char path[4096], kept[4096];
    struct orl_map_info info;
    assert_int_equal(remove_map(f), ORL_MAP_ABSENT);
    assert_false(acquire(f, path, &info));
    assert_int_equal(remove_map(f), ORL_MAP_IN_USE);
    build(f, path);
    assert_int_equal(remove_map(f), ORL_MAP_IN_USE);
    f->store.release(f->store.ctx, "global", KEY);
    assert_true(acquire(f, kept, &info));
    assert_true(acquire(f, kept, &info));
    f->store.release(f->store.ctx, "global", KEY);
    assert_int_equal(remove_map(f), ORL_MAP_IN_USE);
    assert_int_equal(access(kept, R_OK), 0);
    f->store.release(f->store.ctx, "global", KEY);
    assert_int_equal(orl_map_cache_flush(f->cache, &f->err), 0);
    assert_int_equal(remove_map(f), ORL_MAP_REMOVED);
    assert_int_not_equal(access(kept, F_OK), 0);
    assert_int_equal(remove_map(f), ORL_MAP_ABSENT);
    assert_int_equal(count_rows(f), 0);
    close_all(f);
    assert_int_equal(open_all(f), 0);
    assert_int_equal(count_rows(f), 0);
    assert_false(acquire(f, path, &info));
    build(f, path);
    assert_int_equal(count_rows(f), 1);
}

enum { USERS = 3, USES = 200 };

/* Acquires and releases the map many times, and builds it after a removal. A file removed while it
 * is held is a failure. */
static void *use_many_times(void *arg)
{
    struct fixture *f = arg;
    for (int i = 0; i < USES; i++) {
        char path[4096];
        struct orl_map_info info = info_of(1);
        bool hit = false;
        int rc = f->store.acquire(f->store.ctx, "global", KEY, NULL, path, &hit, &info, NULL);
        if (rc == 0 && !hit) {
            rc = orl_write_file(path, "map", 3, NULL);
            rc = rc ? rc : f->store.commit(f->store.ctx, &info, NULL);
            orl_folders_path(&f->data.folders, path, "maps/global-%s.opm", KEY);
        }
        if (rc || access(path, R_OK) != 0)
            atomic_fetch_add(&f->faults, 1);
        f->store.release(f->store.ctx, "global", KEY);
    }
    atomic_fetch_add(&f->ended, 1);
    return NULL;
}

static void test_removal_under_use(void **state)
{
    struct fixture *f = *state;
    pthread_t threads[USERS];
    size_t removed = 0;
    for (int i = 0; i < USERS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, use_many_times, f), 0);
    while (atomic_load(&f->ended) < USERS) {
        removed += remove_map(f) == ORL_MAP_REMOVED;
        assert_int_equal(orl_map_cache_flush(f->cache, &f->err), 0);
    }
    for (int i = 0; i < USERS; i++)
        pthread_join(threads[i], NULL);
    assert_int_equal(atomic_load(&f->faults), 0);
    assert_true(removed > 0 || remove_map(f) == ORL_MAP_REMOVED);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_miss_then_hit),
        EACH(test_eight_jobs_one_build),
        EACH(test_another_takes_over),
        EACH(test_waiting_can_be_cancelled),
        EACH(test_clock_put_back),
        EACH(test_survives_restart),
        EACH(test_orphans_go_at_start),
        EACH(test_damaged_map_is_rebuilt),
        EACH(test_removed_map_is_rebuilt),
        EACH(test_finds_the_largest_smaller),
        EACH(test_no_family),
        EACH(test_removal),
        EACH(test_removal_under_use),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The memory cache between jobs: returned entries, and evictions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>
#include <pthread.h>

#include <oriel/base/memory_cache.h>

/* Entries are numbers that count how often they were freed. */
static void count_release(void *thing)
{
    ++*(int *)thing;
}

static void test_given_back(void **state)
{
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(100);
    int gone[2] = {0};
    (void)state;
    assert_non_null(memory_cache);
    assert_null(orl_memory_cache_take(memory_cache, "a"));
    orl_memory_cache_put(memory_cache, "a", &gone[0], 40, count_release);
    orl_memory_cache_put(memory_cache, "b", &gone[1], 40, count_release);
    assert_int_equal(orl_memory_cache_totals(memory_cache).bytes, 80);
    assert_ptr_equal(orl_memory_cache_take(memory_cache, "a"), &gone[0]);
    assert_null(orl_memory_cache_take(memory_cache, "a"));
    assert_int_equal(orl_memory_cache_totals(memory_cache).bytes, 40);
    assert_int_equal(orl_memory_cache_totals(memory_cache).things, 1);
    assert_int_equal(orl_memory_cache_totals(memory_cache).hits, 1);
    orl_memory_cache_free(memory_cache);
    assert_int_equal(gone[0], 0);
    assert_int_equal(gone[1], 1);
}

static void test_room(void **state)
{
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(100);
    int gone[5] = {0};
    (void)state;
    orl_memory_cache_put(memory_cache, "a", &gone[0], 60, count_release);
    orl_memory_cache_put(memory_cache, "b", &gone[1], 40, count_release);
    orl_memory_cache_put(memory_cache, "c", &gone[2], 10,
                         count_release); /* replaces the oldest entry */
    assert_int_equal(gone[0], 1);
    assert_int_equal(gone[1], 0);
    orl_memory_cache_put(memory_cache, "b", &gone[3], 20,
                         count_release); /* replaces the entry of this key */
    assert_int_equal(gone[1], 1);
    orl_memory_cache_put(memory_cache, "d", &gone[4], 101,
                         count_release); /* exceeds the whole capacity */
    assert_int_equal(gone[4], 1);
    assert_int_equal(orl_memory_cache_totals(memory_cache).bytes, 30);
    assert_int_equal(orl_memory_cache_totals(memory_cache).things, 2);
    assert_null(orl_memory_cache_take(memory_cache, "d"));
    orl_memory_cache_free(memory_cache);
    assert_int_equal(gone[2], 1);
    assert_int_equal(gone[3], 1);
}

static void test_none(void **state)
{
    struct orl_memory_cache *shelves[] = {NULL, orl_memory_cache_new(0)};
    (void)state;
    assert_non_null(shelves[1]);
    for (size_t i = 0; i < 2; i++) {
        int gone = 0;
        assert_null(orl_memory_cache_take(shelves[i], "a"));
        orl_memory_cache_put(shelves[i], "a", &gone, 1, count_release);
        assert_int_equal(gone, 1);
        assert_int_equal(orl_memory_cache_totals(shelves[i]).bytes, 0);
        assert_int_equal(orl_memory_cache_totals(shelves[i]).things, 0);
        orl_memory_cache_free(shelves[i]);
    }
}

enum { THREADS = 3, ROUNDS = 2000, KEYS = 4 };

/* Takes entries and increments them; each has one user at a time. */
static void *work(void *arg)
{
    struct orl_memory_cache *memory_cache = arg;
    for (int i = 0; i < ROUNDS; i++) {
        char key[2] = {(char)('a' + i % KEYS), 0};
        int *thing = orl_memory_cache_take(memory_cache, key);
        if (thing) {
            ++*thing;
            orl_memory_cache_put(memory_cache, key, thing, sizeof *thing, count_release);
        } else {
            i--;
        }
    }
    return NULL;
}

static void test_threads(void **state)
{
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(1000);
    pthread_t threads[THREADS];
    int things[KEYS] = {0}, sum = 0;
    (void)state;
    for (int i = 0; i < KEYS; i++) {
        const char key[2] = {(char)('a' + i), 0};
        orl_memory_cache_put(memory_cache, key, &things[i], sizeof *things, count_release);
    }
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, work, memory_cache), 0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    for (int i = 0; i < KEYS; i++)
        sum += things[i];
    assert_int_equal(sum, THREADS * ROUNDS);
    orl_memory_cache_free(memory_cache);
}

/* A shared entry counts its holders; if two are put under one key, the first stays. */
static void *hold_one(void *thing)
{
    ++*(int *)thing;
    return thing;
}

static void let_one_go(void *thing)
{
    --*(int *)thing;
}

static void test_job_dedup(void **state)
{
    static const struct orl_reference_calls sharing = {hold_one, let_one_go};
    struct orl_memory_cache *memory_cache = orl_memory_cache_new(100);
    int holders[3] = {1, 1, 1}, gone = 0; /* each is held by its maker */
    (void)state;
    assert_null(orl_memory_cache_get_shared(memory_cache, "a", &sharing));
    assert_ptr_equal(orl_memory_cache_put_shared(memory_cache, "a", &holders[0], 60, &sharing),
                     &holders[0]);
    assert_int_equal(holders[0], 2);
    assert_ptr_equal(orl_memory_cache_get_shared(memory_cache, "a", &sharing), &holders[0]);
    assert_ptr_equal(orl_memory_cache_put_shared(memory_cache, "a", &holders[1], 60, &sharing),
                     &holders[0]);
    assert_int_equal(holders[0], 4);
    assert_int_equal(holders[1], 0);
    assert_int_equal(orl_memory_cache_totals(memory_cache).shared, 1);
    assert_int_equal(orl_memory_cache_totals(memory_cache).shared_hits, 1);
    assert_int_equal(orl_memory_cache_totals(memory_cache).bytes, 60);
    orl_memory_cache_put(memory_cache, "b", &gone, 50,
                         count_release); /* evicts one: no room for both */
    assert_int_equal(holders[0], 3);
    assert_int_equal(orl_memory_cache_totals(memory_cache).shared, 0);
    assert_int_equal(orl_memory_cache_totals(memory_cache).things, 1);
    /* An entry too large for the cache stays with its maker only. */
    assert_ptr_equal(orl_memory_cache_put_shared(memory_cache, "c", &holders[2], 101, &sharing),
                     &holders[2]);
    assert_int_equal(holders[2], 1);
    orl_memory_cache_free(memory_cache);
    assert_int_equal(gone, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_given_back), cmocka_unit_test(test_room),
        cmocka_unit_test(test_none),       cmocka_unit_test(test_job_dedup),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The byte budget: removal to free space, refusals, sizes in options, and messages. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "maintenance/storage.h"
#include "process/config.h"
#include "support/daemon_metric.h"
#include "support/storage.h"

static void restart_with_budget(struct daemon *daemon, double budget)
{
    char size[32];
    const char *const extra[] = {"--storage-budget", size, NULL};
    snprintf(size, sizeof size, "%.0f", budget);
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    daemon_restart(daemon, extra);
}

/* The budget keeps only the last used one of three fetched jobs, and its map. */
static void test_longest_unused_goes_first(void **state)
{
    struct daemon_room *f = *state;
    char jobs[3][80], file[300];
    struct reply reply;
    for (int i = 0; i < 3; i++)
        storage_run_job(&f->daemon, f->scene, i + 1, "v", jobs[i]);
    storage_fetch(&f->daemon, jobs[1], 200);
    storage_fetch(&f->daemon, jobs[2], 200);
    storage_fetch(&f->daemon, jobs[0], 200);
    const double uploads = storage_bytes_of(&f->daemon, "uploads"),
                 kept = storage_bytes(&f->daemon);
    const size_t maps = storage_count_maps(&f->daemon);
    assert_true(maps >= 3);
    /* Space for a third of maps and results. */
    restart_with_budget(&f->daemon, uploads + (kept - uploads) / 3);
    assert_true(storage_bytes(&f->daemon) <= uploads + (kept - uploads) / 3);
    assert_true(storage_bytes_of(&f->daemon, "uploads") == uploads);
    storage_fetch(&f->daemon, jobs[0], 200);
    assert_int_equal(storage_count_maps(&f->daemon) < maps, true);
    daemon_get(&f->daemon, jobs[1], &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    const bool gone = *reply_text(&reply, "evicted");
    assert_true(gone == !*reply_text(&reply, "links.result"));
    reply_done(&reply);
    storage_fetch(&f->daemon, jobs[1], gone ? 410 : 200);
    /* All removable data goes: the next start has space only for uploads. */
    restart_with_budget(&f->daemon, uploads);
    for (int i = 0; i < 3; i++) {
        storage_fetch(&f->daemon, jobs[i], 410);
        snprintf(file, sizeof file, "%s/files/v.hdr", jobs[i]);
        storage_expect(&f->daemon, "GET", file, 410, "results-evicted");
        snprintf(file, sizeof file, "%s/files/w.hdr", jobs[i]);
        storage_expect(&f->daemon, "GET", file, 404, "no-such-resource");
    }
    assert_int_equal(storage_count_maps(&f->daemon), 0);
    daemon_expect_no_files(&f->daemon, "maps");
    daemon_expect_no_files(&f->daemon, "results");
}

/* Results that have not been fetched stay, and new jobs are refused. */
static void test_full(void **state)
{
    static const char bsdf[] = "<WindowElement/>";
    static const char ball[] = "void plastic x 0 0 5 .5 .5 .5 0 0\nx sphere s 0 0 4 0 0 0 1\n";
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], text[512];
    storage_run_job(&f->daemon, f->scene, 1, "v", job);
    restart_with_budget(&f->daemon, storage_bytes_of(&f->daemon, "uploads") +
                                        storage_bytes_of(&f->daemon, "results"));
    assert_int_equal(storage_count_maps(&f->daemon), 0);
    snprintf(text, sizeof text,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"technique\":\"backward\","
             "\"gather_samples\":16,\"sensors\":[[2,1,0.8,0,0,1]]}",
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 507);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:storage-full");
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
    daemon_request(&f->daemon, "POST", "/v1/bsdfs", "application/xml", bsdf, strlen(bsdf), NULL,
                   &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    const struct upload_file other = {"ball.rad", ball, strlen(ball), false};
    daemon_upload(&f->daemon, &other, 1, NULL, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "tmp");
    /* An accepted job's result exists, and is removable once fetched. */
    storage_fetch(&f->daemon, job, 200);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    storage_fetch(&f->daemon, job, 410);
}

/* Jobs are accepted as long as there is space for the results of all waiting jobs. */
static void test_queue_of_results(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char text[640], blocker[80];
    size_t accepted = 0;
    restart_with_budget(&f->daemon, storage_bytes_of(&f->daemon, "uploads") + 300000);
    daemon_submit(&f->daemon, f->scene, 50000000, 1, NULL, blocker);
    for (long status = 202; status == 202 && accepted < 20; accepted += status == 202) {
        /* Each expects a view of 80x60 pixels: some 67 kB. */
        snprintf(text, sizeof text,
                 "{\"scene\":\"%s\",\"technique\":\"backward\",\"pixel_samples\":1,\"seed\":%zu,"
                 "\"views\":[{\"name\":\"v\",\"view\":\"-vp 2 2 1\",\"width\":80,\"height\":60}]}",
                 f->scene, accepted);
        daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
        status = reply.status;
        assert_true(status == 202 || status == 507);
        reply_done(&reply);
    }
    assert_int_equal(accepted, 3);
    /* They still count after a restart; cancelled jobs do not. */
    restart_with_budget(&f->daemon, storage_bytes_of(&f->daemon, "uploads") + 300000);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    char last[80];
    daemon_get(&f->daemon, "/v1/jobs?state=queued", &reply);
    snprintf(last, sizeof last, "%s", reply_text(&reply, "jobs.0.links.self"));
    reply_done(&reply);
    daemon_cancel(&f->daemon, last, &reply);
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    daemon_cancel(&f->daemon, blocker, &reply);
    reply_done(&reply);
}

/* A request too large for the budget removes nothing else. */
static void test_too_large(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    enum { LARGE = 1 << 22 };
    storage_run_job(&f->daemon, f->scene, 1, NULL, job);
    storage_fetch(&f->daemon, job, 200);
    restart_with_budget(&f->daemon, storage_bytes(&f->daemon) + 100);
    const size_t maps = storage_count_maps(&f->daemon);
    char *text = malloc(LARGE);
    assert_non_null(text);
    memset(text, '\n', LARGE);
    memcpy(text, room_scene, strlen(room_scene));
    const struct upload_file file = {"large.rad", text, LARGE, false};
    daemon_upload(&f->daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    free(text);
    assert_true(maps > 0 && storage_count_maps(&f->daemon) == maps);
    /* Reading a job's status does not count as fetching its results. */
    char other[80], path[96];
    storage_run_job(&f->daemon, f->scene, 2, NULL, other);
    snprintf(path, sizeof path, "%.80s/result", other);
    storage_expect(&f->daemon, "HEAD", path, 200, NULL);
    storage_fetch(&f->daemon, other, 200);
}

static void test_sizes(void **state)
{
    static const struct {
        char text[32];
        uint64_t bytes; /* 0: refused */
    } cases[] = {{"1", 1},
                 {"500000", 500000},
                 {"64K", 64 << 10},
                 {"500M", 500 << 20},
                 {"20G", 20ULL << 30},
                 {"3T", 3ULL << 40},
                 {"0", 0},
                 {"-1", 0},
                 {"", 0},
                 {"G", 0},
                 {"5X", 0},
                 {"5GB", 0},
                 {"9000000T", 0},
                 {"99999999999999999999", 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char program[] = "orield", name[] = "--storage-budget", text[32];
        char *argv[] = {program, name, text, NULL};
        struct orl_config config;
        struct orl_error err;
        enum orl_config_action action;
        memcpy(text, cases[i].text, sizeof text);
        const int rc = orl_config_parse(3, argv, &config, &action, &err);
        assert_int_equal(rc, cases[i].bytes ? 0 : ORL_ERR_INVALID);
        if (rc == 0)
            assert_true(config.storage_bytes == cases[i].bytes);
    }
}

/* Half of the free bytes and of those already used; other programs may write meanwhile. */
static void test_default_is_half_of_the_disk(void **state)
{
    struct statvfs disk;
    (void)state;
    assert_int_equal(statvfs("/tmp", &disk), 0);
    const double free_bytes = (double)disk.f_bavail * (double)disk.f_frsize, used = 1e15;
    const double found = (double)orl_storage_default("/tmp", (uint64_t)used);
    assert_true(fabs(found - free_bytes / 2 - used / 2) <= 0.25 * free_bytes);
    assert_true((double)orl_storage_default("/nowhere", 2000) == 1000);
}

static void test_memory_cache_sizes(void **state)
{
    static const struct {
        char text[32];
        int rc;
        uint64_t bytes;
    } cases[] = {
        {"0", 0, 0}, {"64M", 0, 64 << 20}, {"", ORL_ERR_INVALID, 0}, {"-1", ORL_ERR_INVALID, 0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char program[] = "orield", name[] = "--shelf", text[32];
        char *argv[] = {program, name, text, NULL};
        struct orl_config config = {.memory_cache_bytes = 0};
        struct orl_error err;
        enum orl_config_action action;
        memcpy(text, cases[i].text, sizeof text);
        assert_int_equal(orl_config_parse(3, argv, &config, &action, &err), cases[i].rc);
        assert_true(config.memory_cache_bytes == cases[i].bytes);
    }
}

static void test_budget_is_told(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    restart_with_budget(&f->daemon, 123456789);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "storage_bytes") == 123456789);
    reply_done(&reply);
    assert_true(daemon_metric(&f->daemon, "oriel_storage_budget_bytes") == 123456789);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    static const struct CMUnitTest tests[] = {
        EACH(test_longest_unused_goes_first),
        EACH(test_full),
        EACH(test_queue_of_results),
        EACH(test_too_large),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_default_is_half_of_the_disk),
        cmocka_unit_test(test_memory_cache_sizes),
        EACH(test_budget_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/*
 * Annual jobs in progress: progress, cancelling, restarts that continue, and data shared by jobs.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/daemon_metric.h"
#include "support/patience.h"
#include "support/year_room.h"

/* ---- Long jobs ------------------------------------------------------------------------------- */

#define PATHS "1024"
enum { MANY = 640, BLOCK = 64 };

/* Returns a document of ten blocks of sensors. */
static char *make_long(const char *more)
{
    char *text = malloc(MANY * 40 + 400);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text,
                                "\"weather\":\"place.epw\",\"samples\":" PATHS ",%s"
                                "\"sensors\":[",
                                more);
    for (int i = 0; i < MANY; i++)
        at += (size_t)sprintf(text + at, "%s[%.3f,%.3f,0.8,0,0,1]", i ? "," : "",
                              0.2 + 0.1 * (i % 32), 0.3 + 0.2 * (i / 32));
    sprintf(text + at, "]");
    return text;
}

/* Waits until that many blocks are stored. */
static void wait_for_blocks(struct year_room *f, size_t blocks)
{
    /* The files: the key; for each block its rows and a note that they are complete; rows of the
     * next. */
    for (double until = patience_until();
         daemon_count_files(&f->daemon, "partial") < 2 * blocks + 2;)
        if (!patience_nap(until))
            fail_msg("no %zu blocks in time", blocks);
}

static void test_progress_and_cancelling(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80], *text = make_long("");
    year_room_submit(f, text, job);
    wait_for_blocks(f, 2);
    daemon_get(&f->daemon, job, &reply);
    assert_string_equal(reply_text(&reply, "state"), "running");
    assert_string_equal(reply_text(&reply, "stage"), "render");
    assert_true(reply_number(&reply, "stage_percent") >= 10);
    assert_true(reply_number(&reply, "percent") > 5 && reply_number(&reply, "percent") < 96);
    assert_true(reply_number(&reply, "eta_s") > 0);
    assert_true(json_is_null(reply_at(&reply, "annual.accuracy")));
    assert_true(json_is_array(reply_at(&reply, "warnings")));
    reply_done(&reply);
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    year_room_expect(f, job, "cancelled", 1, &reply);
    assert_true(!reply_at(&reply, "links.result"));
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "partial");
    free(text);
}

/* Returns the digests of a job's files except result.json, in a new array. */
static json_t *digests(struct year_room *f, const char *job)
{
    struct reply reply;
    json_t *list = json_array();
    const json_t *entry;
    size_t i;
    daemon_get(&f->daemon, job, &reply);
    json_array_foreach(reply_at(&reply, "files"), i, entry)
    {
        if (i > 0)
            json_array_append(list, json_object_get(entry, "sha256"));
    }
    reply_done(&reply);
    assert_true(json_array_size(list) > 20);
    return list;
}

/*
 * Returns the first progress of the rows that a poll reports: stored rows are not computed again.
 */
static double first_percent(struct year_room *f, const char *job)
{
    struct reply reply;
    double until = patience_until();
    do {
        daemon_get(&f->daemon, job, &reply);
        const bool runs = strcmp(reply_text(&reply, "stage"), "render") == 0;
        const bool ended = strcmp(reply_text(&reply, "state"), "succeeded") == 0;
        const double percent = ended ? 100 : reply_number(&reply, "stage_percent");
        reply_done(&reply);
        if ((runs && percent > 0) || ended)
            return percent;
    } while (patience_nap(until));
    fail_msg("no row in time");
    return 0;
}

static void test_goes_on_after_a_kill(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80], again[80], *text = make_long("");
    year_room_submit(f, text, job);
    wait_for_blocks(f, 3);
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);
    daemon_restart(&f->daemon, NULL);
    assert_true(first_percent(f, job) >= 100.0 * 3 * BLOCK / MANY);
    wait_for_blocks(f, 5);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0); /* orderly: no attempt */
    daemon_restart(&f->daemon, NULL);
    assert_true(first_percent(f, job) >= 100.0 * 5 * BLOCK / MANY);
    year_room_expect(f, job, "succeeded", 2, &reply);
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "partial");
    /* Runs the job again without interruption. */
    year_room_submit(f, text, again);
    year_room_expect(f, again, "succeeded", 1, &reply);
    reply_done(&reply);
    json_t *torn = digests(f, job), *whole = digests(f, again);
    assert_true(json_equal(torn, whole));
    json_decref(torn);
    json_decref(whole);
    free(text);
}

/* ---- Data shared by jobs --------------------------------------------------------------------- */

static void test_jobs_share_the_scene(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char job[80];
    for (int i = 0; i < 2; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "\"weather\":\"place.epw\",\"samples\":16,\"seed\":%d,"
                 "\"sensors\":[[2,2,1,0,0,1]]",
                 i);
        year_room_submit(f, text, job);
        year_room_expect(f, job, "succeeded", 1, &reply);
        reply_done(&reply);
        assert_true(daemon_metric(&f->daemon, "oriel_shelf_scenes") == 1);
        /* One more hit per job, for its plan. */
        assert_true(daemon_metric(&f->daemon, "oriel_shelf_scene_hits_total") == 1 + 2 * i);
    }
}

/* Two equal jobs are computed once, and both have all files, also in folders. */
static void test_equal_jobs_are_one(void **state)
{
    static const char same[] =
        "\"samples\":16,\"formats\":[\"honeybee\"]," YEAR_ROOM_SEEDED "\"sensors\":[[2,2,1,0,0,1]]";
    struct year_room *f = *state;
    struct reply reply;
    char blocker[80], jobs[2][80], path[200], *text = make_long("");
    year_room_submit(f, text, blocker);
    for (int i = 0; i < 2; i++)
        year_room_submit(f, same, jobs[i]);
    daemon_cancel(&f->daemon, blocker, &reply);
    reply_done(&reply);
    for (int i = 0; i < 2; i++) {
        year_room_expect(f, jobs[i], "succeeded", 1, &reply);
        reply_done(&reply);
        snprintf(path, sizeof path, "%s/files/results%%2Fmetrics%%2Fda%%2Fgrid1.da", jobs[i]);
        daemon_get(&f->daemon, path, &reply);
        assert_int_equal(reply.status, 200);
        reply_done(&reply);
        daemon_request(&f->daemon, "DELETE", jobs[i], NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 204);
        reply_done(&reply);
    }
    free(text);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, year_room_set_up, year_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_progress_and_cancelling), EACH(test_goes_on_after_a_kill),
        EACH(test_jobs_share_the_scene), EACH(test_equal_jobs_are_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The client commands, run against canned answers: their output and the files they write. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/canned.h"

static void test_wait_shows_progress_and_the_cache(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7", 200, "{\"id\": \"7\", \"state\": \"queued\", \"percent\": 0}"},
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"running\", \"stage\": \"render\", \"percent\": 40.2,"
         " \"eta_s\": 124.2, \"maps\": [{\"kind\": \"global\", \"cached\": true,"
         " \"stored\": 2000123, \"bytes\": 48000000, \"seconds\": 12.34}]}"},
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"succeeded\", \"percent\": 100, \"maps\": ["
         " {\"kind\": \"global\", \"cached\": true, \"stored\": 2000123, \"bytes\": 48000000,"
         "  \"seconds\": 12.34}, {\"kind\": \"caustic\", \"cached\": false, \"stored\": 950,"
         "  \"bytes\": 22800, \"seconds\": 3}, {\"kind\": \"precomputed\", \"cached\": false,"
         "  \"stored\": 2000123, \"reused\": 500456, \"bytes\": 48000000, \"seconds\": 9}]}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "wait", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.err, "queued   ETA ?");
    canned_says(f->result.err, " 40 %  render   ETA 2:05");
    canned_says(f->result.err,
                "global map: found in the cache (2.0 M photons, 48.0 MB), 12.3 s saved");
    canned_says(f->result.err, "caustic map: built in 3.0 s (950 photons, 22.8 kB)");
    canned_says(f->result.err,
                "precomputed map: topped up from 500.5 k photons (2.0 M photons, 48.0 MB)");
    canned_says(f->result.err, "job 7: succeeded");
    assert_string_equal(f->result.out, "");
}

static void test_wait_fails_with_the_job(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7", 200,
         "{\"id\": \"7\", \"state\": \"failed\", \"percent\": 10, \"error\": {\"type\":"
         " \"urn:oriel:error:range\", \"title\": \"Out of range\", \"detail\": \"not a number\","
         " \"file\": \"room.rad\", \"line\": 12, \"primitive\": \"polygon floor\","
         " \"hint\": \"mend the vertex\"}}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "wait", "7", NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "room.rad:12: polygon floor: not a number (mend the vertex)\n");
    canned_says(f->result.err, "job 7: failed");
}

static void test_problems_read_like_compilers(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/9", 404, "{\"title\": \"Not found\", \"detail\": \"there is no job 9\"}"},
        {"GET /v1/jobs", 500, "<html>oops</html>"},
        {"GET /v1/maps", 200, "this is no JSON"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "status", "9", NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_string_equal(f->result.err, "oriel: there is no job 9\n");
    canned_run(f, canned, "status", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "the daemon answered 500 and gave no reason");
    canned_run(f, canned, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "not JSON");
    /* Ids are escaped: they cannot reach another resource. */
    canned_run(f, canned, "status", "../maps", NULL);
    assert_int_equal(f->result.exit_code, 1);
    assert_int_equal(canned_asked(f, "GET /v1/maps"), 1);
}

static void test_status_is_a_table(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs", 200,
         "{\"jobs\": ["
         "{\"id\": \"0123456789abcdef0123456789abcdef\", \"name\": \"B\u00fcro mit sehr langem "
         "Namen, "
         "2. Stock\", \"tags\": [\"x\"], \"kind\": \"render\", \"state\": \"running\", "
         "\"percent\": 42.04,"
         " \"eta_s\": 124.2, \"error\": 0.031, \"created\": \"2024-03-22T11:30:00.123Z\"},"
         "{\"id\": \"fedcba9876543210fedcba9876543210\", \"name\": null, \"tags\": [\"x\", \"y\"],"
         " \"kind\": \"study\", \"state\": \"queued\", \"percent\": null, \"eta_s\": null, "
         "\"error\": null,"
         " \"queue_position\": 2, \"created\": \"2024-03-22T11:31:00.123Z\"}], \"more\": false}"},
        {"GET /v1/jobs/fedcba98", 200, "{\"id\": \"fedcba9876543210fedcba9876543210\"}"},
        {"DELETE /v1/jobs/fedcba9876543210fedcba9876543210", 204, ""},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run_args(f, canned,
                    (const char *const[]){"status", "--tag", "x y", "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.out, "01234567  B\xc3\xbcro mit sehr langem Nam  render  running       "
                               "42.0 %         2:05    3.1 %  2024-03-22T11:30:00\n");
    canned_says(f->result.out, "fedcba98  x,y                       study   queued          "
                               "       2. in line           2024-03-22T11:31:00\n");
    /* The printed id is long enough to remove the item. */
    canned_run_args(f, canned,
                    (const char *const[]){"remove", "job", "fedcba98", "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(canned_asked(f, "DELETE /v1/jobs/fedcba9876543210fedcba9876543210"), 1);
}

#define JOB(id, state, percent, error)                                                             \
    "{\"id\": \"" id "\", \"name\": \"n\", \"kind\": \"render\", \"state\": \"" state              \
    "\", \"percent\": " percent ", \"eta_s\": null, \"error\": " error                             \
    ", \"created\": \"2024-03-22T11:30:00Z\"}"
#define EVENT(kind, id, data) "event: " kind "\nid: " id "\ndata: " data "\n\n"

/* watch prints all existing jobs, then news of them; it resumes a broken stream. */
static void test_watch_tells_what_is_news(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs", 200,
         "{\"jobs\": [" JOB("bbbbbbbbbb", "running", "1",
                            "null") ", " JOB("aaaaaaaaaa", "succeeded", "100", "null") "]}"},
        {"GET /v1/events", 200,
         EVENT("reset", "1",
               "{}") ": still here\n\n" EVENT("job", "2", JOB("bbbbbbbbbb", "running", "2", "null"))
             EVENT("job", "3", JOB("bbbbbbbbbb", "running", "12.5", "null"))
                 EVENT("job", "4", JOB("bbbbbbbbbb", "running", "12.6", "0.25"))},
        {"GET /v1/events", 200,
         EVENT("removed", "5", "{\"id\": \"aaaaaaaaaa\"}")
             EVENT("job", "6", JOB("cccccccccc", "queued", "null", "null"))},
        {"GET /v1/events", 401, "{\"title\": \"No\", \"detail\": \"the token was removed\"}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    const char *at;

    canned_run_args(f, canned,
                    (const char *const[]){"watch", "--tag", "x y", "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "the token was removed");
    assert_int_equal(canned_asked(f, "GET /v1/events"), 3);
    at = strstr(f->result.out, "aaaaaaaa");
    at = at ? strstr(at, "bbbbbbbb") : NULL;
    assert_non_null(at);
    canned_says(at, "   1.0 %");
    canned_says(at, "  12.5 %");
    canned_says(at, "  25.0 %");
    canned_says(at, "aaaaaaaa  removed\ncccccccc  n ");
    assert_null(strstr(at, "   2.0 %"));
}

static void test_lists_of_uploads(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/scenes", 200,
         "{\"scenes\": [{\"id\": \"5ce0e\", \"bytes\": 48000000, \"jobs\": 3,"
         " \"jobs_under_way\": 1, \"last_used\": \"2024-03-22T11:30:00.123Z\"}]}"},
        {"GET /v1/bsdfs", 200,
         "{\"bsdfs\": [{\"id\": \"b5df\", \"bytes\": 950, \"name\": \"pane.xml\","
         " \"scenes\": [\"5ce0e\"]}]}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "list", "scenes", NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.out, "5ce0e ");
    canned_says(f->result.out, "   48.0 MB      3          1  2024-03-22T11:30:00\n");
    canned_run(f, canned, "list", "bsdfs", NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.out, "     950 B       1  pane.xml\n");
    canned_run(f, canned, "list", "jobs", NULL);
    assert_int_equal(f->result.exit_code, 2);
}

static void test_links_of_results(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/jobs/7/links", 200,
         "{\"links\": [{\"file\": \"a.hdr\", \"url\": \"/v1/jobs/7/files/a.hdr?s=1\"},"
         " {\"file\": \"b.png\", \"url\": \"/v1/jobs/7/files/b.png?s=2\"}]}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char wanted[200];

    canned_run_args(f, canned,
                    (const char *const[]){"link", "7", "a.hdr", "b.png", "--seconds", "60",
                                          "--server", f->url, NULL});
    assert_int_equal(f->result.exit_code, 0);
    snprintf(wanted, sizeof wanted, "%s/v1/jobs/7/files/a.hdr?s=1\n%s/v1/jobs/7/files/b.png?s=2\n",
             f->url, f->url);
    assert_string_equal(f->result.out, wanted);
    assert_string_equal(canned_find(f, "POST /v1/jobs/7/links")->body,
                        "{\"files\":[\"a.hdr\",\"b.png\"],\"seconds\":60}");
    canned_run_args(f, canned, (const char *const[]){"link", "7", "a", "--seconds", "1h", NULL});
    assert_int_equal(f->result.exit_code, 2);
}

static void test_no_daemon_is_said_so(void **state)
{
    struct canned_daemon *f = *state;

    MHD_stop_daemon(f->daemon);
    f->daemon = NULL;
    canned_run(f, NULL, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "no answer from http://127.0.0.1:");
    canned_says(f->result.err, "`orield`");
}

static void test_maps_table_adds_up(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/maps", 200,
         "{\"maps\": [{\"kind\": \"global\", \"key\": \"0123456789abcdef\", \"emitted\": 31000000,"
         " \"stored\": 2000000, \"bytes\": 48000000, \"seconds\": 10.5, \"hits\": 4, \"created\":"
         " \"2020-01-02T03:04:05Z\", \"in_use\": true}]}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "maps", NULL, NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.out, "0123456789ab ");
    canned_says(f->result.out, "31.0 M");
    canned_says(f->result.out, " d  in use\n");
    canned_says(f->result.out, "1 map, 48.0 MB; reusing it saved 42 s");
}

static void test_fetch_keeps_images_and_result(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7/result", 200, "{\"state\": \"succeeded\"}"},
        {"GET /v1/jobs/7", 200,
         "{\"state\": \"succeeded\", \"files\": [{\"name\": \"result.json\", \"bytes\": 22},"
         " {\"name\": \"desk.hdr\", \"bytes\": 11}, {\"name\": \"desk.png\", \"bytes\": 3}]}"},
        {"GET /v1/jobs/7/files/desk.hdr", 200, "#?RADIANCE\n"},
        {"GET /v1/jobs/7/files/desk.png", 200, "PNG"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char *hdr, *result;

    canned_run(f, canned, "fetch", "7", f->folder);
    assert_int_equal(f->result.exit_code, 0);
    hdr = cli_read_file(f->folder, "desk.hdr");
    result = cli_read_file(f->folder, "result.json");
    assert_string_equal(hdr, "#?RADIANCE\n");
    assert_string_equal(result, canned[0].body);
    free(hdr);
    free(result);
}

static void test_fetch_keeps_nothing_that_failed(void **state)
{
    static const struct canned unfinished[] = {
        {"GET /v1/jobs/7", 200, "{\"state\": \"running\"}"},
        {"GET /v1/jobs/7/result", 409, "{\"detail\": \"the job still runs\"}"},
        {NULL, 0, NULL}};
    static const struct canned missing[] = {
        {"GET /v1/jobs/8", 200, "{\"files\": [{\"name\": \"gone.hdr\"}]}"},
        {"GET /v1/jobs/8/result", 200, "{}"},
        {"GET /v1/jobs/8/files/gone.hdr", 404, "{\"detail\": \"there is no gone.hdr\"}"},
        {NULL, 0, NULL}};
    static const struct canned hostile[] = {
        {"GET /v1/jobs/9", 200, "{\"files\": [{\"name\": \"../evil.hdr\"}]}"},
        {"GET /v1/jobs/9/result", 200, "{}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char inside[96];

    snprintf(inside, sizeof inside, "%s/in", f->folder);
    canned_run(f, unfinished, "fetch", "7", inside);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "the job still runs");
    canned_run(f, missing, "fetch", "8", inside);
    assert_int_equal(f->result.exit_code, 1);
    canned_run(f, hostile, "fetch", "9", inside);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "outside the output folder");
    assert_null(cli_read_file(inside, "result.json"));
    assert_null(cli_read_file(inside, "gone.hdr"));
    assert_null(cli_read_file(inside, "gone.hdr.part"));
    assert_null(cli_read_file(f->folder, "evil.hdr"));
}

/* The reason is the job's, as printed by status and wait; the message also says where to look. */
static void test_fetch_says_why_there_is_nothing(void **state)
{
    static const struct canned canned[] = {
        {"GET /v1/jobs/7", 200,
         "{\"state\": \"failed\", \"error\": {\"type\": \"urn:oriel:error:range\","
         " \"detail\": \"not a number\", \"file\": \"room.rad\", \"line\": 12,"
         " \"hint\": \"mend the vertex\"}}"},
        {"GET /v1/jobs/7/result", 409, "{\"detail\": \"its state is 'failed'\"}"},
        {"GET /v1/jobs/8", 200, "{\"state\": \"cancelled\"}"},
        {"GET /v1/jobs/8/result", 409, "{\"detail\": \"its state is 'cancelled'\"}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "fetch", "7", f->folder);
    assert_int_equal(f->result.exit_code, 1);
    assert_string_equal(f->result.err, "room.rad:12: the job failed: not a number (mend the vertex;"
                                       " see `oriel status 7`)\n");
    canned_run(f, canned, "fetch", "8", f->folder);
    assert_int_equal(f->result.exit_code, 1);
    assert_string_equal(f->result.err, "oriel: the job was cancelled (see `oriel status 8`)\n");
}

#define VERDICTS                                                                                   \
    "{\"id\": \"7\", \"kind\": \"annual\", \"state\": \"succeeded\", \"annual\": {\"verdicts\": [" \
    "{\"rule\": \"LEED\", \"target\": null, \"grid\": \"desks\", \"verdict\": \"pass\", "          \
    "\"note\": null,"                                                                              \
    " \"unit\": null, \"value\": null, \"interval_95\": null},"                                    \
    "{\"rule\": null, \"target\": \"ASE <= 10 %\", \"grid\": null, \"verdict\": \"undecided\","    \
    " \"unit\": \"%\", \"value\": 9.5, \"interval_95\": [8.25, 11], \"note\": \"no blinds\"},"     \
    "{\"rule\": \"LEED\", \"target\": \"sDA300/50 >= 55 %\", \"grid\": \"desks\", \"verdict\":"    \
    " \"pass\", \"unit\": \"%\", \"value\": 61, \"interval_95\": [60, 62.5], \"note\": null}]}}"

/* Verdicts of a daemon's annual job are printed like those of `oriel annual`. */
static void test_verdicts_with_their_intervals(void **state)
{
    static const struct canned canned[] = {{"GET /v1/jobs/7", 200, VERDICTS}, {NULL, 0, NULL}};
    static const char wanted[] = "pass       LEED (desks)\n"
                                 "undecided  ASE <= 10 % (all grids): 9.5 [8.25, 11]: no blinds\n"
                                 "pass       LEED: sDA300/50 >= 55 % (desks): 61 [60, 62.5]\n";
    struct canned_daemon *f = *state;

    canned_run(f, canned, "status", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.out, wanted);
    canned_run(f, canned, "wait", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.err, wanted);
}

static void test_cancel(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/jobs/7/cancel", 202, "{\"state\": \"running\", \"cancelling\": true}"},
        {"GET /v1/jobs/7", 200, "{\"state\": \"running\", \"cancelling\": true}"},
        {"GET /v1/jobs/7", 200, "{\"state\": \"cancelled\"}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;

    canned_run(f, canned, "cancel", "7", NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(canned_asked(f, "GET /v1/jobs/7"), 2);
    canned_says(f->result.err, "job 7: cancelling");
    canned_says(f->result.err, "job 7: cancelled");
    assert_int_equal(canned_asked(f, "POST /v1/jobs/7/cancel"), 1);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, canned_set_up, canned_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_wait_shows_progress_and_the_cache),
        TEST(test_wait_fails_with_the_job),
        TEST(test_problems_read_like_compilers),
        TEST(test_status_is_a_table),
        TEST(test_watch_tells_what_is_news),
        TEST(test_lists_of_uploads),
        TEST(test_links_of_results),
        TEST(test_no_daemon_is_said_so),
        TEST(test_maps_table_adds_up),
        TEST(test_fetch_keeps_images_and_result),
        TEST(test_fetch_keeps_nothing_that_failed),
        TEST(test_fetch_says_why_there_is_nothing),
        TEST(test_verdicts_with_their_intervals),
        TEST(test_cancel),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Studies through a real daemon: states and files, refusals, cancelling, restarts. */
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

#include "process/limits.h"
#include "support/cli.h"
#include "support/daemon.h"
#include "support/patience.h"

/* Two points of two seeds, and a reference of two runs: fractions of a second each. Under
 * ThreadSanitizer everything takes ten to thirty times as long. */
#ifdef __SANITIZE_THREAD__
#define SMALL "\"photons\":[500,2000],\"gather_samples\":[16],\"repeats\":2,"
#define REFERENCE "\"reference\":{\"samples\":512,\"runs\":2}"
enum { PATIENCE = 8 };
#else
#define SMALL "\"photons\":[2000,8000],\"gather_samples\":[64],\"repeats\":2,"
#define REFERENCE "\"reference\":{\"samples\":2048,\"runs\":2}"
enum { PATIENCE = 1 };
#endif
/* Takes minutes; the test cancels it. */
#define LONG "\"photons\":[50000000],\"gather_samples\":[64],\"repeats\":9,"
#define SENSORS "\"sensors\":[[2,1,0.8,0,0,1],[2,4,0.8,0,0,1]],"

static void post(struct daemon_room *f, const char *rest, struct reply *ret_reply)
{
    char text[2048];
    snprintf(text, sizeof text, "{\"kind\":\"study\",\"scene\":\"%s\",%s}", f->scene, rest);
    daemon_post_json(&f->daemon, "/v1/jobs", text, ret_reply);
}

static void submit(struct daemon_room *f, const char *rest, char ret_path[80])
{
    struct reply reply;
    post(f, rest, &reply);
    if (reply.status != 202)
        fail_msg("the study was refused: %s", reply.body);
    assert_string_equal(reply_text(&reply, "kind"), "study");
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void expect_state(struct daemon_room *f, const char *job, const char *state, int attempts)
{
    struct reply reply;
    daemon_wait(&f->daemon, job, 120 * PATIENCE, &reply);
    if (strcmp(reply_text(&reply, "state"), state) != 0 ||
        reply_number(&reply, "attempts") != attempts)
        fail_msg("%s: %s", job, reply.body);
    assert_string_equal(reply_text(&reply, "kind"), "study");
    reply_done(&reply);
}

static const char small[] =
    "\"title\":\"A room\"," SENSORS "\"techniques\":[\"gather\"]," SMALL REFERENCE;

/* A slow backward technique, so that polls see it run. */
static const char seen[] = SENSORS "\"techniques\":[\"direct\",\"backward\"],\"photons\":[2000],"
                                   "\"gather_samples\":[4000000],\"repeats\":9," REFERENCE;

static const char endless[] = SENSORS "\"techniques\":[\"gather\"]," LONG REFERENCE;

/* ---- Results of a study --------------------------------------------------------------------- */

static void check_file(struct daemon_room *f, const char *job, const char *name, const char *type,
                       const char *begins)
{
    struct reply reply;
    char path[160];
    snprintf(path, sizeof path, "%s/files/%s", job, name);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_header(&reply, "Content-Type"), type);
    assert_true(reply.size > strlen(begins));
    assert_memory_equal(reply.body, begins, strlen(begins));
    reply_done(&reply);
}

static void check_numbers(const struct reply *reply, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(reply_number(reply, names[i])))
            fail_msg("%s is not there", names[i]);
}

static void check_result(struct daemon_room *f, const char *job)
{
    static const char *const names[] = {
        "threads",
        "rays_per_s",
        "reference.samples",
        "reference.runs",
        "reference.seconds",
        "reference.values",
        "reference.standard_error",
        "reference.worst",
        "points.1.photons",
        "points.1.samples",
        "points.1.seeds",
        "points.1.seconds.photons",
        "points.1.seconds.maps",
        "points.1.seconds.render",
        "points.1.seconds.total",
        "points.1.seconds.total_error",
        "points.1.rms",
        "points.1.rms_error",
        "points.1.bias",
        "points.1.bias_error",
        "points.1.noise",
        "points.1.p95",
        "points.1.map_bytes",
        "fits.0.terms.spread.value",
        "fits.0.residual",
    };
    struct reply reply;
    char path[160];
    size_t on_front = 0;
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "kind"), "study");
    assert_string_equal(reply_text(&reply, "title"), "A room");
    assert_string_equal(reply_text(&reply, "measured"), "sensors");
    assert_int_equal(json_array_size(reply_at(&reply, "points")), 2);
    check_numbers(&reply, names, sizeof names / sizeof *names);
    for (size_t i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "points.%zu.on_front", i);
        on_front += json_is_true(reply_at(&reply, path));
    }
    assert_true(on_front >= 1);
    reply_done(&reply);
}

static void test_life_of_a_study(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    submit(f, small, job);
    expect_state(f, job, "succeeded", 1);
    daemon_get(&f->daemon, job, &reply);
    assert_true(reply_number(&reply, "percent") == 100);
    assert_int_equal(json_array_size(reply_at(&reply, "links.files")), 4);
    assert_int_equal(json_array_size(reply_at(&reply, "files")), 4);
    reply_done(&reply);
    check_result(f, job);
    check_file(f, job, "result.json", "application/json", "{");
    check_file(f, job, "study.csv", "text/csv", "technique,photons,samples,");
    check_file(f, job, "study.svg", "image/svg+xml", "<svg ");
    check_file(f, job, "study.png", "image/png", "\x89PNG");
    /* A study measures the cost of building maps: it stores none, and reuses none. */
    daemon_get(&f->daemon, "/v1/maps", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "maps")), 0);
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "maps");
    daemon_expect_no_files(&f->daemon, "tmp");
}

static void test_views_have_a_peak(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], path[128];
    submit(f,
           "\"views\":[{\"name\":\"v\",\"view\":\"-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 70 "
           "-vv 55\",\"width\":12,\"height\":8}],\"techniques\":[\"backward\"],"
           "\"pixel_samples\":[4],\"repeats\":2,\"reference\":{\"samples\":64,\"runs\":2}",
           job);
    expect_state(f, job, "succeeded", 1);
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    assert_string_equal(reply_text(&reply, "measured"), "views");
    assert_true(reply_number(&reply, "points.0.peak") > 0);
    reply_done(&reply);
}

/* Waits until the running study has that many points, and runs that technique; NULL: any. A point
 * is there before the next technique starts. */
static void wait_for_points(struct daemon_room *f, const char *job, size_t points,
                            const char *technique, struct reply *ret_reply)
{
    for (double until = patience_now_s() + 120 * PATIENCE; patience_nap(until);) {
        daemon_get(&f->daemon, job, ret_reply);
        const json_t *running = reply_at(ret_reply, "study.running");
        if (json_array_size(reply_at(ret_reply, "study.points")) >= points &&
            reply_at(ret_reply, "study") &&
            (!technique ||
             (json_is_string(running) && strcmp(json_string_value(running), technique) == 0)))
            return;
        assert_true(strcmp(reply_text(ret_reply, "state"), "queued") == 0 ||
                    strcmp(reply_text(ret_reply, "state"), "running") == 0);
        reply_done(ret_reply);
    }
    fail_msg("no points in %d minutes", 2 * PATIENCE);
}

static void cancel(struct daemon_room *f, const char *job, long status)
{
    struct reply reply;
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, status);
    reply_done(&reply);
}

/* Checks `oriel status` for a running study. */
static void check_status(const struct daemon_room *f, const char *job)
{
    static struct cli_result result;
    const char *const args[] = {"status", strrchr(job, '/') + 1, "--server", f->daemon.url, NULL};
    cli_run(args, &result);
    assert_int_equal(result.exit_code, 0);
    if (!strstr(result.out, "running  backward, run ") ||
        !strstr(result.out, "points   1 of 2\ndirect, 2.0 k photons, - samples: "))
        fail_msg("%s", result.out);
}

static void test_progress_and_cancelling(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], waiting[80], path[128];
    submit(f, seen, job);
    submit(f, small, waiting);
    wait_for_points(f, job, 1, "backward", &reply);
    assert_string_equal(reply_text(&reply, "study.running"), "backward");
    assert_string_equal(reply_text(&reply, "study.technique"), "backward");
    assert_true(json_is_null(reply_at(&reply, "study.photons")));
    assert_true(reply_number(&reply, "study.samples") == 4000000);
    assert_true(reply_number(&reply, "study.run") >= 1);
    assert_true(reply_number(&reply, "study.runs") == 9);
    assert_true(reply_number(&reply, "study.settings") == 2);
    assert_string_equal(reply_text(&reply, "study.points.0.technique"), "direct");
    assert_true(reply_number(&reply, "study.points.0.photons") == 2000);
    assert_true(reply_number(&reply, "study.points.0.total_s") > 0);
    assert_true(reply_number(&reply, "study.points.0.rms") > 0);
    assert_true(reply_number(&reply, "percent") > 0 && reply_number(&reply, "percent") < 100);
    assert_true(json_is_null(reply_at(&reply, "stage")));
    reply_done(&reply);
    check_status(f, job);

    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 409);
    reply_done(&reply);
    cancel(f, waiting, 200);
    cancel(f, job, 202);
    expect_state(f, job, "cancelled", 1);
    daemon_expect_no_files(&f->daemon, "tmp");
}

/* ---- Restarts ------------------------------------------------------------------------------- */

static void wait_until_under_way(struct daemon_room *f, const char *job)
{
    struct reply reply;
    wait_for_points(f, job, 0, NULL, &reply);
    reply_done(&reply);
}

static void test_killed_in_the_middle(void **state)
{
    struct daemon_room *f = *state;
    char kept[80], torn[80], waiting[80];
    submit(f, small, kept);
    expect_state(f, kept, "succeeded", 1);
    submit(f, endless, torn);
    submit(f, small, waiting);
    wait_until_under_way(f, torn);
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);
    daemon_restart(&f->daemon, NULL);
    check_file(f, kept, "study.png", "image/png", "\x89PNG");
    wait_until_under_way(f, torn);
    /* An orderly stop does not count as an attempt. */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
    wait_until_under_way(f, torn);
    cancel(f, torn, 202);
    expect_state(f, torn, "cancelled", 2);
    expect_state(f, waiting, "succeeded", 1);
    check_file(f, waiting, "study.csv", "text/csv", "technique,");
    daemon_expect_no_files(&f->daemon, "tmp");
}

/* ---- Refusals ------------------------------------------------------------------------------- */

#define TECHNIQUES "\"techniques\":[\"gather\"],"

static const struct {
    const char *rest, *member;
    long status;
} refusals[] = {
    {SENSORS TECHNIQUES SMALL REFERENCE ",\"repeat\":1", "repeat", 422},
    {SENSORS TECHNIQUES SMALL REFERENCE ",\"technique\":\"gather\"", "technique", 422},
    {SENSORS TECHNIQUES SMALL "\"reference\":{\"samples\":0}", "reference.samples", 422},
    {SENSORS TECHNIQUES SMALL "\"reference\":{}", "reference.samples", 422},
    {SENSORS TECHNIQUES "\"gather_samples\":[64]," REFERENCE, "photons", 422},
    {SENSORS TECHNIQUES "\"photons\":[2000]," REFERENCE, "gather_samples", 422},
    {SENSORS TECHNIQUES "\"photons\":[2000,0],\"gather_samples\":[64]," REFERENCE, "photons[1]",
     422},
    {SENSORS TECHNIQUES "\"photons\":[1e9],\"gather_samples\":[64]," REFERENCE, "photons[0]", 422},
    {SENSORS "\"techniques\":[\"auto\"]," SMALL REFERENCE, "techniques[0]", 422},
    {SENSORS "\"techniques\":[\"gather\",\"gather\"]," SMALL REFERENCE, "techniques[1]", 422},
    {SENSORS "\"techniques\":[]," SMALL REFERENCE, "techniques", 422},
    {SENSORS SMALL REFERENCE, "techniques", 422},
    {TECHNIQUES SMALL REFERENCE, "document", 422},
    {SENSORS TECHNIQUES
     "\"photons\":[2000,4000],\"gather_samples\":[64],\"repeats\":250," REFERENCE,
     "repeats", 413},
    {SENSORS TECHNIQUES "\"photons\":[2000],\"gather_samples\":[64],\"repeats\":0," REFERENCE,
     "repeats", 422},
    {"\"sensors\":[[0,0,0,0,0]]," TECHNIQUES SMALL REFERENCE, "sensors[0]", 422},
    {"\"sensors\":{\"file\":\"none.txt\"}," TECHNIQUES SMALL REFERENCE, "sensors.file", 422},
    {SENSORS TECHNIQUES SMALL REFERENCE
     ",\"points\":[{\"name\":\"a\",\"seconds\":1e13,\"rms\":0.1}]",
     "points[0].seconds", 422},
};

static void test_mistakes_are_named(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        post(f, refusals[i].rest, &reply);
        if (reply.status != refusals[i].status ||
            strcmp(reply_text(&reply, "primitive"), refusals[i].member) != 0)
            fail_msg("%s: %ld, %s", refusals[i].rest, reply.status, reply.body);
        reply_done(&reply);
    }
}

static void test_other_kinds_and_scenes_are_refused(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char text[1024];
    daemon_post_json(&f->daemon, "/v1/jobs", "{\"kind\":\"monthly\"}", &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "kind");
    assert_non_null(strstr(reply_text(&reply, "detail"), "\"study\""));
    reply_done(&reply);
    snprintf(text, sizeof text, "{\"kind\":\"study\",\"scene\":\"%064d\",%s}", 1, small);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    reply_done(&reply);
    snprintf(text, sizeof text, "{\"kind\":\"study\",\"scene\":{\"files\":[\"a.rad\"]},%s}", small);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "study_runs") == ORL_SERVER_STUDY_RUNS);
    assert_true(reply_number(&reply, "study_list") == ORL_LIMIT_STUDY_LIST);
    reply_done(&reply);
}

/* ---- The command ---------------------------------------------------------------------------- */

/* `oriel submit --wait` and `oriel fetch`: scene and sensors are uploaded automatically. */
static void test_the_command_submits_studies(void **state)
{
    struct daemon_room *f = *state;
    static struct cli_result result;
    char folder[64], study[96], output[96], id[80];
    static const char *const files[] = {"result.json", "study.csv", "study.svg", "study.png"};
    cli_make_folder(folder);
    snprintf(study, sizeof study, "%s/study.json", folder);
    snprintf(output, sizeof output, "%s/out", folder);
    cli_write_file(folder, "room.rad", room_scene);
    cli_write_file(folder, "sky.rad", room_sky);
    cli_write_file(folder, "sensors.txt", "2 1 0.8 0 0 1\n2 4 0.8 0 0 1\n");
    cli_write_file(folder, "study.json",
                   "{\"kind\":\"study\",\"scene\":{\"files\":[\"room.rad\",\"sky.rad\"]},"
                   "\"sensors\":{\"file\":\"sensors.txt\"}," TECHNIQUES SMALL REFERENCE "}");
    const char *const submit_args[] = {"submit", study, "--server", f->daemon.url, "--wait", NULL};
    cli_run(submit_args, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    snprintf(id, sizeof id, "%.*s", (int)strcspn(result.out, "\n"), result.out);
    const char *const fetch_args[] = {"fetch", id, "-o", output, "--server", f->daemon.url, NULL};
    cli_run(fetch_args, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char *text = cli_read_file(output, files[i]);
        assert_non_null(text);
        assert_non_null(strstr(result.out, files[i]));
        free(text);
    }
    cli_write_file(folder, "study.json",
                   "{\"kind\":\"study\",\"scene\":{\"files\":[\"room.rad\"]},"
                   "\"sensors\":{\"file\":\"sensors.txt\"}}");
    cli_run(submit_args, &result);
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "study.json: techniques: "));
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_life_of_a_study),
        cmocka_unit_test(test_views_have_a_peak),
        cmocka_unit_test(test_progress_and_cancelling),
        cmocka_unit_test(test_killed_in_the_middle),
        cmocka_unit_test(test_mistakes_are_named),
        cmocka_unit_test(test_other_kinds_and_scenes_are_refused),
        cmocka_unit_test(test_the_command_submits_studies),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}

/*
 * Jobs of several skies: each result is available as soon as it is done, and is not computed again.
 */
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
#include <sys/stat.h>
#include <unistd.h>

#include "support/cli.h"
#include "support/daemon.h"
#include "support/patience.h"
#include "support/scene_text.h"

#define VIEW(side)                                                                                 \
    ",\"views\":[{\"name\":\"v\",\"view\":\"-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv "   \
    "55\",\"width\":" side ",\"height\":" side "}]"
/* From before sunrise until after sunset. */
#define DAY                                                                                        \
    "\"skies\":{\"weather\":{\"file\":\"place.wea\"},\"from\":{\"month\":3,\"day\":22,\"hour\":"   \
    "5.5},\"to\":{\"month\":3,\"day\":22,\"hour\":19.5},\"step_h\":2}"
#define HOUR(hour) "{\"weather\":{\"file\":\"place.wea\",\"month\":3,\"day\":22,\"hour\":" hour "}}"

static void post(struct daemon_room *f, const char *more, struct reply *ret_reply)
{
    char text[2048];
    snprintf(
        text, sizeof text,
        "{\"scene\":\"%s\",\"technique\":\"gather\",\"photons\":{\"global\":5000,\"caustic\":0},"
        "\"gather_samples\":256,\"sensors\":[[0,0,50,0,0,1],[2,2,0.8,0,0,1]],%s}",
        f->scene, more);
    daemon_post_json(&f->daemon, "/v1/jobs", text, ret_reply);
}

static void submit(struct daemon_room *f, const char *more, char ret_path[80])
{
    struct reply reply;
    post(f, more, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void wait_for(struct daemon_room *f, const char *job, const char *state,
                     struct reply *ret_reply)
{
    daemon_wait(&f->daemon, job, 120, ret_reply);
    if (strcmp(reply_text(ret_reply, "state"), state) != 0)
        fail_msg("%s", ret_reply->body);
}

static void run_job(struct daemon_room *f, const char *more, char ret_path[80])
{
    struct reply reply;
    submit(f, more, ret_path);
    wait_for(f, ret_path, "succeeded", &reply);
    reply_done(&reply);
}

static void get_below(struct daemon_room *f, const char *job, const char *what,
                      struct reply *ret_reply)
{
    char path[192];
    snprintf(path, sizeof path, "%s/%s", job, what);
    daemon_get(&f->daemon, path, ret_reply);
    if (ret_reply->status != 200)
        fail_msg("%s: %ld %s", path, ret_reply->status, ret_reply->body);
}

static void expect_same(struct daemon_room *f, const char *one, const char *file, const char *other,
                        const char *other_file)
{
    struct reply a, b;
    get_below(f, one, file, &a);
    get_below(f, other, other_file, &b);
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.body, b.body, a.size);
    reply_done(&a);
    reply_done(&b);
}

/* Waits until that many skies are done. Returns true if the job still runs. */
static bool wait_for_skies(struct daemon_room *f, const char *job, double count)
{
    for (double until = patience_now_s() + 300; patience_nap(until);) {
        struct reply reply;
        daemon_get(&f->daemon, job, &reply);
        const bool there = reply_number(&reply, "skies.done") >= count;
        const bool runs = strcmp(reply_text(&reply, "state"), "running") == 0;
        assert_true(!runs || !reply_at(&reply, "links.result"));
        reply_done(&reply);
        if (there)
            return runs;
    }
    fail_msg("no sky in five minutes");
    return false;
}

/* Returns the time at which a job's file was written, in nanoseconds; 0 if it is missing. */
static int64_t written(const struct daemon_room *f, const char *folder, const char *job,
                       const char *file)
{
    char path[256];
    struct stat st;
    snprintf(path, sizeof path, "%s/%s/%s/%s", f->daemon.root, folder, strrchr(job, '/') + 1, file);
    if (stat(path, &st) != 0)
        return 0;
    return (int64_t)st.st_mtim.tv_sec * 1000000000 + st.st_mtim.tv_nsec;
}

static void cancel(struct daemon_room *f, const char *job)
{
    struct reply reply;
    char path[96];
    snprintf(path, sizeof path, "%s/cancel", job);
    daemon_request(&f->daemon, "POST", path, NULL, "", 0, NULL, &reply);
    assert_int_equal(reply.status / 100, 2);
    reply_done(&reply);
    wait_for(f, job, "cancelled", &reply);
    reply_done(&reply);
}

static void test_a_day(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char day[80], noon[80];
    run_job(f, DAY VIEW("16"), day);
    daemon_get(&f->daemon, day, &reply);
    assert_true(reply_number(&reply, "skies.count") == 8 &&
                reply_number(&reply, "skies.done") == 8);
    assert_int_equal(json_array_size(reply_at(&reply, "files")), 8 * 5 + 1);
    reply_done(&reply);
    get_below(f, day, "result", &reply);
    assert_string_equal(reply_text(&reply, "skies.0.name"), "0322-0530");
    assert_string_equal(reply_text(&reply, "skies.3.file"), "0322-1130.json");
    for (int i = 0; i < 8; i++) {
        char path[48];
        const bool dark = i == 0 || i == 7;
        snprintf(path, sizeof path, "skies.%d.dark", i);
        assert_true(json_is_true(reply_at(&reply, path)) == dark);
        snprintf(path, sizeof path, "skies.%d.illuminance_lx.0", i);
        assert_true(dark ? reply_number(&reply, path) == 0 : reply_number(&reply, path) > 5000);
    }
    const double lx = reply_number(&reply, "skies.3.illuminance_lx.1");
    reply_done(&reply);
    run_job(f, "\"sky\":" HOUR("11.5") VIEW("16"), noon);
    expect_same(f, day, "files/0322-1130.v.hdr", noon, "files/v.hdr");
    get_below(f, noon, "result", &reply);
    assert_true(reply_number(&reply, "sensors.1.illuminance_lx") == lx);
    assert_true(json_is_true(reply_at(&reply, "maps.0.cached")));
    assert_true(json_is_false(reply_at(&reply, "dark")));
    reply_done(&reply);
}

/* A job interrupted between skies gives equal results and keeps its finished skies, unless they
 * were damaged. */
static void test_torn_between_skies(void **state)
{
    static const char skies[] = "\"skies\":[" HOUR("9.5") "," HOUR("11.5") "," HOUR("15.5") "]";
    struct daemon_room *f = *state;
    struct reply reply;
    char torn[80], whole[80], more[1024], path[256];
    snprintf(more, sizeof more, "%s%s", skies, VIEW("100"));
    submit(f, more, torn);
    assert_true(wait_for_skies(f, torn, 1));
    get_below(f, torn, "files/0322-0930.json", &reply);
    assert_true(reply_number(&reply, "sensors.0.illuminance_lx") > 10000);
    reply_done(&reply);
    const int64_t first = written(f, "partial", torn, "0322-0930.json");
    daemon_end(&f->daemon, SIGKILL);
    daemon_restart(&f->daemon, NULL);
    assert_true(wait_for_skies(f, torn, 1));
    assert_true(written(f, "partial", torn, "0322-0930.json") == first);
    /* A file of a finished sky has one more byte: it is computed again. */
    daemon_end(&f->daemon, SIGKILL);
    snprintf(path, sizeof path, "%s/partial/%s/0322-0930.v.hdr", f->daemon.root,
             strrchr(torn, '/') + 1);
    FILE *file = fopen(path, "ab");
    assert_non_null(file);
    fputc(0, file);
    fclose(file);
    /* Also a map whose round was killed. */
    snprintf(path, sizeof path, "%s/partial/%s/global-0.opm.part", f->daemon.root,
             strrchr(torn, '/') + 1);
    file = fopen(path, "wb");
    assert_non_null(file);
    fclose(file);
    daemon_restart(&f->daemon, NULL);
    wait_for(f, torn, "succeeded", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "files")), 3 * 5 + 1);
    reply_done(&reply);
    assert_true(written(f, "results", torn, "0322-0930.json") > first);
    assert_true(written(f, "results", torn, "+key") == 0);
    assert_true(written(f, "results", torn, "global-0.opm.part") == 0);
    daemon_expect_no_files(&f->daemon, "partial");
    run_job(f, more, whole);
    expect_same(f, torn, "files/0322-0930.v.hdr", whole, "files/0322-0930.v.hdr");
    expect_same(f, torn, "files/0322-1530.v.error.hdr", whole, "files/0322-1530.v.error.hdr");
}

/* Changes the first byte of a file, as if another program version had written the folder. */
static void overwrite(const char *path)
{
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fputc('x', file);
    fclose(file);
}

/* Waits until that file is in the job's partial folder. */
static void wait_for_file(const struct daemon_room *f, const char *job, const char *file)
{
    const double until = patience_now_s() + 300;
    while (written(f, "partial", job, file) == 0)
        if (!patience_nap(until))
            fail_msg("no %s in five minutes", file);
}

/* Results of another program version are not reused. */
static void test_other_programs_leave_nothing(void **state)
{
    struct daemon_room *f = *state;
    char job[80], path[256];
    submit(f, "\"skies\":[" HOUR("9.5") "," HOUR("11.5") "]" VIEW("400"), job);
    wait_for_file(f, job, "+0322-0930.+sensors.done");
    const int64_t sensors = written(f, "partial", job, "0322-0930.+sensors");
    assert_true(sensors > 0);
    for (int i = 0; i < 2; i++) {
        daemon_end(&f->daemon, SIGKILL);
        snprintf(path, sizeof path, "%s/partial/%s/+key", f->daemon.root, strrchr(job, '/') + 1);
        if (i == 1)
            overwrite(path);
        daemon_restart(&f->daemon, NULL);
        daemon_wait_running(&f->daemon, job, 1);
        wait_for_file(f, job, "0322-0930.+sensors");
        assert_true((written(f, "partial", job, "0322-0930.+sensors") == sensors) == (i == 0));
    }
    cancel(f, job);
    daemon_expect_no_files(&f->daemon, "partial");
}

/*
 * Finished skies of a cancelled job stay, as those of one that has succeeded; also over a restart.
 */
static void test_cancelled_between_skies(void **state)
{
    static const char skies[] =
        "\"skies\":[" HOUR("9.5") "," HOUR("11.5") "," HOUR("13.5") "," HOUR("15.5") "]";
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], more[1024];
    snprintf(more, sizeof more, "%s%s", skies, VIEW("200"));
    submit(f, more, job);
    assert_true(wait_for_skies(f, job, 1));
    cancel(f, job);
    for (int restarted = 0; restarted < 2; restarted++) {
        daemon_get(&f->daemon, job, &reply);
        assert_string_equal(reply_text(&reply, "state"), "cancelled");
        assert_true(reply_number(&reply, "skies.count") == 4);
        const int done = (int)reply_number(&reply, "skies.done");
        assert_in_range(done, 1, 3);
        assert_int_equal(json_array_size(reply_at(&reply, "files")), done * 5 + 1);
        assert_int_equal(json_array_size(reply_at(&reply, "links.files")), done * 5 + 1);
        reply_done(&reply);
        get_below(f, job, "result", &reply);
        assert_string_equal(reply_text(&reply, "state"), "cancelled");
        assert_int_equal(json_array_size(reply_at(&reply, "skies")), done);
        reply_done(&reply);
        get_below(f, job, "files/0322-0930.json", &reply);
        assert_true(reply_number(&reply, "sensors.0.illuminance_lx") > 10000);
        reply_done(&reply);
        char below[64];
        snprintf(below, sizeof below, "results/%s", strrchr(job, '/') + 1);
        assert_int_equal(daemon_count_files(&f->daemon, below), done * 5 + 1);
        daemon_expect_no_files(&f->daemon, "partial");
        daemon_end(&f->daemon, restarted ? SIGTERM : SIGKILL);
        daemon_restart(&f->daemon, NULL);
    }
    daemon_request(&f->daemon, "DELETE", job, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 204);
    reply_done(&reply);
}

/* Returns the number of skies seen done before the job ended. */
static double skies_until_end(struct daemon_room *f, const char *job)
{
    double done = 0;
    for (double until = patience_now_s() + 300; patience_nap(until);) {
        struct reply reply;
        daemon_get(&f->daemon, job, &reply);
        const bool runs = strcmp(reply_text(&reply, "state"), "running") == 0 ||
                          strcmp(reply_text(&reply, "state"), "cancelling") == 0 ||
                          strcmp(reply_text(&reply, "state"), "queued") == 0;
        if (runs && reply_number(&reply, "skies.done") > done)
            done = reply_number(&reply, "skies.done");
        reply_done(&reply);
        if (!runs)
            return done;
    }
    fail_msg("no end in five minutes");
    return 0;
}

/* A job that exceeds the time limit fails, and none of its results stay. The limit is long enough
 * for some skies on a busy machine. */
static void test_timed_out_between_skies(void **state)
{
    static const char *const limits[] = {"2", "8", "40", "240"};
    struct daemon_room *f = *state;
    struct reply reply;
    double done = 0;
    char job[80], more[1800], path[256];
    int used = sprintf(more, "\"skies\":[");
    for (int i = 0; i < 18; i++)
        used += sprintf(more + used,
                        "%s{\"name\":\"s%d\",\"cie\":{\"type\":\"overcast\","
                        "\"diffuse_horizontal_lx\":9000}}",
                        i > 0 ? "," : "", i);
    for (int i = 0; i < 4 && done == 0; i++) {
        const char *const extra[] = {"--job-timeout", limits[i], NULL};
        daemon_end(&f->daemon, SIGTERM);
        daemon_restart(&f->daemon, extra);
        snprintf(more + used, sizeof more - (size_t)used, "],\"seed\":%d%s", 80 + i, VIEW("400"));
        submit(f, more, job);
        done = skies_until_end(f, job);
    }
    assert_true(done > 0);
    wait_for(f, job, "failed", &reply);
    assert_string_equal(reply_text(&reply, "error.type"), "urn:oriel:error:limit");
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/results/%s", f->daemon.root, strrchr(job, '/') + 1);
    assert_true(access(path, F_OK) != 0);
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, NULL);
}

/* The finished skies of two sharing jobs belong to the one cancelled last, in either order. */
static void test_last_of_two_is_cancelled(void **state)
{
    static const char skies[] =
        "\"skies\":[" HOUR("9.5") "," HOUR("11.5") "," HOUR("13.5") "," HOUR("15.5") "]";
    struct daemon_room *f = *state;
    struct reply reply;
    for (int last = 0; last < 2; last++) {
        char jobs[2][80], more[1024], below[64];
        snprintf(more, sizeof more, "%s,\"seed\":%d%s", skies, 70 + last, VIEW("200"));
        for (int i = 0; i < 2; i++)
            submit(f, more, jobs[i]);
        assert_true(wait_for_skies(f, jobs[0], 1));
        cancel(f, jobs[1 - last]);
        cancel(f, jobs[last]);
        daemon_get(&f->daemon, jobs[last], &reply);
        const int done = (int)reply_number(&reply, "skies.done");
        assert_in_range(done, 1, 3);
        assert_int_equal(json_array_size(reply_at(&reply, "files")), done * 5 + 1);
        reply_done(&reply);
        get_below(f, jobs[last], "files/0322-0930.json", &reply);
        assert_true(reply_number(&reply, "sensors.0.illuminance_lx") > 10000);
        reply_done(&reply);
        snprintf(below, sizeof below, "results/%s", strrchr(jobs[1 - last], '/') + 1);
        daemon_expect_no_files(&f->daemon, below);
        daemon_expect_no_files(&f->daemon, "partial");
    }
}

static void test_mistakes_are_told_at_once(void **state)
{
    static const struct {
        const char *more, *primitive;
        long status;
    } cases[] = {
        {"\"skies\":[" HOUR("9.5") ",{\"weather\":{\"file\":\"no.epw\",\"month\":3,\"day\":22,"
                                   "\"hour\":11.5}}]",
         "skies[1].weather.file", 422},
        {"\"skies\":[]", "skies", 422},
        {"\"skies\":[" HOUR("9.5") "," HOUR("9.5") "]", "skies[1]", 422},
        {"\"sky\":" HOUR("9.5") ",\"skies\":[" HOUR("9.5") "]", "skies", 422},
        {"\"skies\":{\"weather\":{\"file\":\"place.wea\"},\"from\":{\"month\":1,\"day\":1,\"hour\":"
         "0},\"to\":{\"month\":12,\"day\":31,\"hour\":23}}",
         "skies", 413},
    };
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        post(f, cases[i].more, &reply);
        if (reply.status != cases[i].status ||
            strcmp(reply_text(&reply, "primitive"), cases[i].primitive) != 0)
            fail_msg("%s: %ld %s", cases[i].more, reply.status, reply.body);
        reply_done(&reply);
    }
    /* An hour missing in the file is found before anything is rendered. */
    submit(f,
           "\"skies\":[" HOUR("9.5") ",{\"weather\":{\"file\":\"place.wea\",\"month\":7,"
                                     "\"day\":22,\"hour\":11.5}}]",
           job);
    wait_for(f, job, "failed", &reply);
    assert_string_equal(reply_text(&reply, "error.primitive"), "skies[1]");
    assert_string_equal(reply_text(&reply, "error.file"), "place.wea");
    reply_done(&reply);
}

/* The command gives the same results locally and by the daemon. */
static void test_same_by_the_command(void **state)
{
    struct daemon_room *f = *state;
    static struct cli_result result;
    char folder[64], job[96], here[96], there[96], id[65], path[160];
    const char *const local[] = {"run", job, "-o", here, NULL};
    const char *const remote[] = {"submit", "--server", f->daemon.url, job, "--wait", NULL};
    static const char *const files[] = {"0322-0930.v.hdr",      "sequence.v.frame-0322-0930.png",
                                        "sequence.v.sheet.png", "sequence.v.animation.png",
                                        "sequence.v.dgp.png",   "sequence.v.dgp.svg"};
    const char *const fetch[] = {"fetch", "--server", f->daemon.url, id, "-o", there, NULL};
    size_t size, sizes[2];
    cli_make_folder(folder);
    snprintf(job, sizeof job, "%s/job.json", folder);
    snprintf(here, sizeof here, "%s/here", folder);
    snprintf(there, sizeof there, "%s/there", folder);
    char *wea = (char *)scene_read_bytes("tests/fixtures/weather.wea", &size);
    wea[size] = '\0';
    cli_write_file(folder, "place.wea", wea);
    free(wea);
    cli_write_file(folder, "room.rad", room_scene);
    cli_write_file(
        folder, "job.json",
        "{\"scene\":{\"files\":[\"room.rad\"]},\"technique\":\"gather\",\"gather_samples\":"
        "64,\"photons\":{\"global\":2000,\"caustic\":0},\"sensors\":[[2,2,1,0,0,1]],"
        "\"skies\":[" HOUR("9.5") "," HOUR("21.5") "],\"sequence\":{},\"views\":[{\"name\":\"v\","
                                                   "\"view\":\"-vta -vp 2 4.5 1.6 -vd 0 -1 0 -vh "
                                                   "180 -vv 180\",\"width\":16,\"height\":16,"
                                                   "\"metrics\":[\"dgp\"]}]}");
    cli_run(local, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    cli_run(remote, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    snprintf(id, sizeof id, "%.*s", (int)strcspn(result.out, "\n"), result.out);
    cli_run(fetch, &result);
    assert_int_equal(result.exit_code, 0);
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        unsigned char *bytes[2];
        for (int i = 0; i < 2; i++) {
            snprintf(path, sizeof path, "%s/%s", i ? there : here, files[k]);
            bytes[i] = scene_read_bytes(path, &sizes[i]);
        }
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        free(bytes[0]);
        free(bytes[1]);
    }
    snprintf(path, sizeof path, "%s/0322-2130.json", here);
    json_t *night = json_load_file(path, 0, NULL);
    assert_true(json_is_true(json_object_get(night, "dark")));
    json_decref(night);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_day),
        cmocka_unit_test(test_torn_between_skies),
        cmocka_unit_test(test_other_programs_leave_nothing),
        cmocka_unit_test(test_cancelled_between_skies),
        cmocka_unit_test(test_timed_out_between_skies),
        cmocka_unit_test(test_last_of_two_is_cancelled),
        cmocka_unit_test(test_mistakes_are_told_at_once),
        cmocka_unit_test(test_same_by_the_command),
    };
    return cmocka_run_group_tests(tests, daemon_weather_set_up, daemon_room_tear_down);
}

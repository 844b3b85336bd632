/* Skies in jobs, through the daemon: one scene, several hours, an uploaded weather file. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/daemon.h"
#include "support/scene_text.h"

/* On the roof, and in the room. */
#define SENSORS "\"sensors\":[[0,0,50,0,0,1],[2,2,0.8,0,0,1]]"

static void post(struct daemon_room *f, const char *sky, struct reply *reply)
{
    char text[1024];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"gather\",\"photons\":{"
             "\"global\":2000,\"caustic\":0},"
             "\"gather_samples\":4096," SENSORS ",\"sky\":%s}",
             f->scene, sky);
    daemon_post_json(&f->daemon, "/v1/jobs", text, reply);
}

/* Runs a job to its end; returns true if its map was cached. ret_lx: the sensor on the roof. */
static bool run_sky(struct daemon_room *f, const char *sky, double *ret_lx)
{
    struct reply reply;
    char path[80], result[96];
    post(f, sky, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(path, sizeof path, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    daemon_wait(&f->daemon, path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    const bool cached = json_is_true(reply_at(&reply, "maps.0.cached"));
    reply_done(&reply);
    snprintf(result, sizeof result, "%s/result", path);
    daemon_get(&f->daemon, result, &reply);
    *ret_lx = reply_number(&reply, "sensors.0.illuminance_lx");
    assert_true(reply_number(&reply, "sensors.1.illuminance_lx") > 0);
    reply_done(&reply);
    return cached;
}

static void test_one_scene_many_hours(void **state)
{
    static const char overcast[] =
        "{\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":9000}}";
    static const char noon[] =
        "{\"weather\":{\"file\":\"place.wea\",\"month\":3,\"day\":22,\"hour\":11.5}}";
    static const char later[] =
        "{\"weather\":{\"file\":\"place.wea\",\"month\":3,\"day\":22,\"hour\":15.5}}";
    double lx[4];
    assert_false(run_sky(*state, overcast, &lx[0]));
    assert_false(run_sky(*state, noon, &lx[1]));
    assert_false(run_sky(*state, later, &lx[2]));
    assert_true(run_sky(*state, noon, &lx[3]));
    assert_true(fabs(lx[0] - 9000) < 18);
    assert_true(lx[1] > 50000 && lx[2] > 20000 && lx[2] < 0.8 * lx[1]);
    assert_true(lx[3] == lx[1]);
}

static void test_mistakes_are_told_at_once(void **state)
{
    static const struct {
        const char *sky, *primitive;
    } cases[] = {
        {"{\"weather\":{\"file\":\"none.epw\",\"month\":3,\"day\":22,\"hour\":11.5}}",
         "sky.weather.file"},
        {"{\"cie\":{\"type\":\"clear\"}}", "sky"},
        {"{\"perez\":{\"sun_altitude\":40,\"sun_azimuth\":0,\"direct_normal_w_m2\":5000,"
         "\"diffuse_horizontal_w_m2\":100}}",
         "sky.perez.direct_normal_w_m2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct reply reply;
        post(*state, cases[i].sky, &reply);
        assert_int_equal(reply.status, 422);
        assert_string_equal(reply_text(&reply, "primitive"), cases[i].primitive);
        reply_done(&reply);
    }
}

/* The command uploads the weather file, and reports a missing one. */
static void test_submit_carries_the_weather_file(void **state)
{
    struct daemon_room *f = *state;
    static struct cli_result result;
    char folder[64], path[96];
    const char *const args[] = {"submit", "--server", f->daemon.url, path, "--wait", NULL};
    size_t size;
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/job.json", folder);
    cli_write_file(folder, "room.rad", room_scene);
    cli_write_file(folder, "job.json",
                   "{\"scene\":{\"files\":[\"room.rad\"]},\"gather_samples\":64," SENSORS
                   ",\"technique\":\"gather\",\"photons\":{\"global\":2000,\"caustic\":0},\"sky\":{"
                   "\"weather\":{\"file\":"
                   "\"a.epw\",\"month\":3,\"day\":22,\"hour\":11.5}}}");
    cli_run(args, &result);
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "a.epw"));
    char *epw = (char *)scene_read_bytes("tests/fixtures/weather.epw", &size);
    epw[size] = '\0';
    cli_write_file(folder, "a.epw", epw);
    free(epw);
    cli_run(args, &result);
    if (result.exit_code != 0)
        fail_msg("%s", result.err);
    assert_non_null(strstr(result.err, "succeeded"));
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_scene_many_hours),
        cmocka_unit_test(test_mistakes_are_told_at_once),
        cmocka_unit_test(test_submit_carries_the_weather_file),
    };
    return cmocka_run_group_tests(tests, daemon_weather_set_up, daemon_room_tear_down);
}

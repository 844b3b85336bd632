/* Files that a job's document names, and their cost for the daemon: bombs are refused before a job
 * is accepted, and the files' memory is counted. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process/limits.h"
#include "support/room.h"
#include "support/year_room.h"

#define SHADES(states)                                                                             \
    "\"shades\":[{\"name\":\"south\",\"states\":[{\"name\":\"open\"}," states "]}]"
#define WEATHER "\"weather\":\"place.epw\",\"sensors\":[[2,2,1,0,0,1]],"

/* A few lines that make many surfaces. */
#define COPIES(n) "!xform -a 100000 -t .003 " #n " 0 slats.rad\n"
#define FOURFOLD COPIES(1) COPIES(2) COPIES(3) COPIES(4)
#define SPHERE "w sphere s 0 0 4 .1 .1 .1 .001\n"
static const char bomb[] = FOURFOLD,
                  many[] = "!xform -n a -a 500 -t .003 0 0 -i 1 -a 200 -t 0 .003 0 slat.rad\n",
                  slat[] = SPHERE,
                  slats[] = SPHERE SPHERE SPHERE SPHERE SPHERE SPHERE SPHERE SPHERE,
                  bad[] = "w ring r\n0\n0\n1 0\n";

static int set_up(void **state)
{
    static struct year_room room;
    struct reply reply;
    size_t size;
    char *epw = year_room_read("tests/fixtures/weather.epw", &size);
    const char *matrix = "#?RADIANCE\nNROWS=1\nNCOLS=70000000\nFORMAT=ascii\n\n1\n";
    const struct upload_file files[] = {
        {"room.rad", year_room_scene, strlen(year_room_scene), false},
        {"place.epw", epw, size, true},
        {"bomb.rad", bomb, sizeof bomb - 1, true},
        {"many.rad", many, sizeof many - 1, true},
        {"slats.rad", slats, sizeof slats - 1, true},
        {"slat.rad", slat, sizeof slat - 1, true},
        {"bad.rad", bad, sizeof bad - 1, true},
        {"bad.csv", "0\nshut\n", 7, true},
        {"bad.mtx", matrix, strlen(matrix), true},
        {"bad.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9 +X 9\n", 45, true},
    };
    assert_non_null(epw);
    daemon_start(&room.daemon, (const char *const[]){"--memory", "600M", NULL});
    daemon_upload(&room.daemon, files, sizeof files / sizeof *files, NULL, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    snprintf(room.scene, sizeof room.scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(epw);
    *state = &room;
    return 0;
}

/* Expects the status and a text in the detail; "": any. */
static void expect(struct year_room *f, const char *members, long status, const char *says)
{
    struct reply reply;
    year_room_post(f, members, &reply);
    if (reply.status != status || !strstr(reply.body, says))
        fail_msg("%s: %ld %s", members, reply.status, reply.body);
    reply_done(&reply);
}

/* Three million spheres by 400 bytes: more memory than a check may use; the daemon's memory does
 * not grow. */
static void test_bombs(void **state)
{
    struct year_room *f = *state;
    if (ORL_SANITIZED)
        skip();
    const double before_mb = daemon_memory_mb(&f->daemon, "VmHWM");
    for (int i = 0; i < 2; i++)
        expect(f, WEATHER SHADES("{\"name\":\"shut\",\"files\":[\"bomb.rad\"]}"), 413, "memory");
    assert_true(daemon_memory_mb(&f->daemon, "VmHWM") < before_mb + 50);
}

/* Surfaces of states are counted: 100 000 of them, with memory for some 40 000. */
static void test_states_are_counted(void **state)
{
    static const char *const little[] = {"--memory", "64M", "--check-memory", "512M", NULL};
    struct year_room *f = *state;
    if (ORL_SANITIZED)
        skip();
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, little);
    expect(f, WEATHER SHADES("{\"name\":\"shut\",\"files\":[\"many.rad\"]}"), 413, "surfaces");
}

/* The job's request is refused with each mistake; no job is created. */
static void test_mistakes(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    expect(f, WEATHER SHADES("{\"name\":\"shut\",\"files\":[\"bad.rad\"]}"), 400, "bad.rad");
    expect(f, WEATHER SHADES("{\"name\":\"shut\",\"files\":[\"none.rad\"]}"), 422, "none.rad");
    expect(f,
           WEATHER "\"shades\":[{\"name\":\"south\",\"windows\":[\"none\"],\"states\":"
                   "[{\"name\":\"open\"},{\"name\":\"shut\",\"dark\":true}]}]",
           422, "none");
    expect(f,
           WEATHER "\"shades\":[{\"name\":\"south\",\"schedule\":{\"file\":\"bad.csv\"},"
                   "\"states\":[{\"name\":\"open\"},{\"name\":\"up\",\"files\":[\"slat.rad\"]}]}]",
           422, "bad.csv");
    expect(f, WEATHER "\"matrices\":[{\"coefficients\":\"bad.mtx\",\"sky\":\"bad.mtx\"}]", 400,
           "bad.mtx");
    daemon_get(&f->daemon, "/v1/jobs", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 0);
    reply_done(&reply);
}

/* A mask is read with its view: one of another size, and a truncated one. */
static void test_masks(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    char text[512];
    for (int width = 8; width < 10; width++) {
        snprintf(text, sizeof text,
                 "{\"scene\":\"%s\",\"sky\":{\"cie\":{\"type\":\"overcast\","
                 "\"diffuse_horizontal_lx\":10000}},\"views\":[{\"name\":\"v\",\"view\":"
                 "\"-vta -vp 2 2 1 -vd 0 1 0 -vh 180 -vv 180\",\"width\":%d,\"height\":%d,"
                 "\"metrics\":[\"dgp\"],\"glare\":{\"mask\":\"bad.hdr\"}}]}",
                 f->scene, width, width);
        daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
        if (reply.status / 100 != 4 || !strstr(reply.body, "bad.hdr"))
            fail_msg("%ld %s", reply.status, reply.body);
        reply_done(&reply);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_masks),
        cmocka_unit_test(test_bombs),
        cmocka_unit_test(test_states_are_counted),
    };
    return cmocka_run_group_tests(tests, set_up, year_room_tear_down);
}

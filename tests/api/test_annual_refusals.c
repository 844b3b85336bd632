/*
 * Annual jobs that a daemon refuses: mistakes by file and line, bounds, memory, unsupported scenes.
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

#include "process/limits.h"
#include "support/room.h"
#include "support/year_room.h"

static const struct {
    const char *rest, *member, *file;
    int line;
    long status;
} refusals[] = {
    {YEAR_ROOM_GRIDS "\"seed\":3", "weather", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"samples\":64", "grids", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"sensors\":[[0,0,0,0,0,1]]", "grids", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"sample\":64", "sample", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"grids\":[{\"sensors\":[]}]", "grids[0].sensors", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"sensors\":[]", "sensors", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"sensors\":[[0,0,1e300,0,0,1]]", "sensors[0]", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS
     "\"glare\":{\"seats\":[{\"at\":[1,1,1],\"towards\":[1e300,0,0]}]}",
     "glare.seats[0].towards", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"exposure\":{\"points\":[{\"at\":[1e300,0,0]}]}",
     "exposure.points[0].at", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"grids\":[{\"sensors\":{\"file\":\"none.pts\"}}]", "grids[0].sensors.file",
     "", 0, 422},
    {YEAR_ROOM_SEEDED "\"sensors\":{\"file\":\"none.pts\"}", "sensors.file", "", 0, 422},
    {YEAR_ROOM_SEEDED "\"grids\":[{\"sensors\":{\"file\":\"bad.pts\"}}]", "", "bad.pts", 2, 400},
    {YEAR_ROOM_GRIDS "\"weather\":\"none.epw\"", "weather", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"year\":1999", "", "place.epw", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"year\":0", "year", "", 0, 422},
    {YEAR_ROOM_GRIDS "\"weather\":\"bad.wea\"", "", "bad.wea", 7, 400},
    {YEAR_ROOM_GRIDS "\"weather\":\"desks.pts\"", "", "desks.pts", 1, 400},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"occupancy\":{\"file\":\"none.csv\"}", "occupancy.file", "",
     0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"occupancy\":{\"file\":\"use.csv\"}", "", "use.csv", 0,
     422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"targets\":[\"sDA300/50 of the moon >= 50 %\"]", "", "", 0,
     422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"targets\":[\"lots of light\"]", "targets[0]", "", 0, 400},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"accuracy\":{\"verdict\":\"sDA of the moon >= 1 %\"}", "",
     "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"metrics\":[\"DA300\",\"DA300\"]", "metrics", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"rules\":[\"none\"]", "rules[0]", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"formats\":[\"hdr\"]", "formats[0]", "", 0, 422},
    {YEAR_ROOM_SEEDED YEAR_ROOM_GRIDS "\"views\":[]", "views", "", 0, 422},
};

static void test_mistakes_are_named(void **state)
{
    struct year_room *f = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        year_room_post(f, refusals[i].rest, &reply);
        const double line = reply_at(&reply, "line") ? reply_number(&reply, "line") : 0;
        if (reply.status != refusals[i].status || line != refusals[i].line ||
            strcmp(reply_text(&reply, "primitive"), refusals[i].member) != 0 ||
            strcmp(reply_text(&reply, "file"), refusals[i].file) != 0)
            fail_msg("%s: %ld, %s", refusals[i].rest, reply.status, reply.body);
        reply_done(&reply);
    }
}

/* The maps drawn, one for every metric of every grid, are limited in number. */
static void test_pictures_are_bounded(void **state)
{
    enum { GRIDS_OF_ONE = 410, METRICS = 10 };
    struct year_room *f = *state;
    struct reply reply;
    char *text = malloc(GRIDS_OF_ONE * 40 + 200);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text, YEAR_ROOM_SEEDED "\"grids\":[");
    for (int i = 0; i < GRIDS_OF_ONE; i++)
        at += (size_t)sprintf(text + at, "%s{\"sensors\":[[2,2,1,0,0,1]]}", i ? "," : "");
    sprintf(text + at, "]");
    year_room_post(f, text, &reply);
    assert_int_equal(reply.status, 413);
    assert_string_equal(reply_text(&reply, "primitive"), "grids");
    assert_non_null(strstr(reply_text(&reply, "detail"), "4100 pictures"));
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/limits", &reply);
    assert_true(reply_number(&reply, "pictures") == 4096 && reply_number(&reply, "grids") == 4096);
    reply_done(&reply);
    free(text);
}

/* Results kept for every hour of every sensor are counted once sensors and hours are known. */
/* Asserts a refusal for too much memory, with its cause. */
static void assert_too_much(struct year_room *f, const char *members, int sensors,
                            const char *wanted)
{
    char *text = malloc((size_t)sensors * 16 + 200);
    struct reply reply;
    assert_non_null(text);
    size_t at = (size_t)sprintf(text, "%s\"weather\":\"whole.wea\",\"sensors\":[", members);
    for (int i = 0; i < sensors; i++)
        at += (size_t)sprintf(text + at, "%s[2,2,1,0,0,1]", i ? "," : "");
    sprintf(text + at, "]");
    year_room_post(f, text, &reply);
    assert_int_equal(reply.status, 413);
    assert_non_null(strstr(reply_text(&reply, "detail"), wanted));
    reply_done(&reply);
    free(text);
}

static void test_memory_is_foreseen(void **state)
{
    static const char *const little[] = {"--memory", "1G", NULL};
    struct year_room *f = *state;
    if (ORL_SANITIZED)
        skip();
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, little);
    assert_too_much(f, "", 40000, "for 210240000 hours of sensors");
    assert_too_much(f, "\"sun_halvings\":2,", 4000,
                    "720 MiB of them for 15 extra sets of sun nodes");
}

static void test_a_sky_of_its_own_is_refused(void **state)
{
    static const char weather[] = "place x\nlatitude 1\nlongitude 1\ntime_zone 0\n"
                                  "site_elevation 0\nweather_data_file_units 1\n"
                                  "3 21 11.5 800 100\n";
    struct year_room *f = *state;
    struct reply reply;
    char id[65], text[512];
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"sky.rad", room_sky, strlen(room_sky), false},
                                        {"place.wea", weather, strlen(weather), true}};
    daemon_upload(&f->daemon, files, 3, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    snprintf(text, sizeof text,
             "{\"kind\":\"annual\",\"scene\":\"%s\",\"weather\":\"place.wea\","
             "\"sensors\":[[2,2,1,0,0,1]]}",
             id);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    assert_non_null(strstr(reply_text(&reply, "detail"), " distant sources"));
    reply_done(&reply);
}

/* A problem that only the run finds fails the job, with the reason. */
static void test_what_a_year_does_not_follow(void **state)
{
    static const char lens[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
        "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere lens 0 0 4 2 1 1.5 .3\n";
    static const char weather[] = "place x\nlatitude 47\nlongitude -8\ntime_zone -15\n"
                                  "site_elevation 0\nweather_data_file_units 1\n"
                                  "3 21 11.5 800 100\n";
    struct year_room *f = *state;
    struct reply reply;
    char text[512];
    const struct upload_file files[] = {{"room.rad", lens, strlen(lens), false},
                                        {"place.wea", weather, strlen(weather), true}};
    daemon_upload(&f->daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(text, sizeof text,
             "{\"kind\":\"annual\",\"scene\":\"%s\",\"weather\":\"place.wea\","
             "\"sensors\":[[2,2,1,0,0,1]]}",
             reply_text(&reply, "id"));
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(text, sizeof text, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    year_room_expect(f, text, "failed", 1, &reply);
    assert_non_null(strstr(reply_text(&reply, "error.detail"), "lens"));
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "partial");
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, year_room_set_up, year_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_mistakes_are_named), EACH(test_pictures_are_bounded),
        EACH(test_memory_is_foreseen), EACH(test_a_sky_of_its_own_is_refused),
        EACH(test_what_a_year_does_not_follow)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

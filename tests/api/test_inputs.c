/* Files that a job names, sensors, weather and views: read before the job is accepted. */
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
#include "support/daemon.h"

/* Uploads the room without light sources, with files of sensors and weather. */
static void upload(struct daemon *daemon, const char *sensors, size_t size, const char *weather,
                   char ret_id[65])
{
    static const char box[] = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
                              "grey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0\n";
    const struct upload_file files[] = {{"box.rad", box, strlen(box), false},
                                        {"s.txt", sensors, size, true},
                                        {"w.wea", weather, strlen(weather), true}};
    struct reply reply;
    daemon_upload(daemon, files, 3, NULL, &reply);
    assert_int_equal(reply.status / 100, 2);
    snprintf(ret_id, 65, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
}

static void post(struct daemon *daemon, const char *scene, const char *sensors, struct reply *reply)
{
    char text[512];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"direct\",\"gather_samples\":1,\"seed\":1,"
             "\"photons\":{\"global\":1000,\"caustic\":1},\"sensors\":{\"file\":\"%s\"},"
             "\"sky\":{\"weather\":{\"file\":\"w.wea\",\"month\":3,\"day\":21,\"hour\":12}}}",
             scene, sensors);
    daemon_post_json(daemon, "/v1/jobs", text, reply);
}

#define HEAD                                                                                       \
    "place somewhere\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 400\n"              \
    "weather_data_file_units 1\n"
#define HOUR "3 21 11.5 500 200\n3 21 12.5 500 200\n"
static const char good_sensors[] = "# two\n1 1 1 0 0 1\n2 2 1 0 0 1\n", good_weather[] = HEAD HOUR;

/* The error names the place, and no job is created. */
static void test_wrong(void **state)
{
    static const struct {
        const char *sensors, *weather, *file;
        long status, line;
    } cases[] = {
        {"1 1 1 0 0 1\n# none\n1 1 up\n", good_weather, "s.txt", 400, 3},
        {"1 1 1 0 0 0\n", good_weather, "s.txt", 422, 1},
        {"# none\n", good_weather, "s.txt", 400, -1},
        {good_sensors, HEAD "3 21 11.5 sun 200\n", "w.wea", 400, 7},
        {good_sensors, HEAD "13 21 11.5 500 200\n", "w.wea", 422, 7},
        {good_sensors, good_sensors, "w.wea", 400, 1},
    };
    struct daemon *daemon = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char scene[65];
        upload(daemon, cases[i].sensors, strlen(cases[i].sensors), cases[i].weather, scene);
        post(daemon, scene, "s.txt", &reply);
        assert_int_equal(reply.status, cases[i].status);
        assert_string_equal(reply_text(&reply, "file"), cases[i].file);
        if (cases[i].line > 0)
            assert_true(reply_number(&reply, "line") == (double)cases[i].line);
        reply_done(&reply);
    }
    daemon_get(daemon, "/v1/jobs", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 0);
    reply_done(&reply);
}

/* The error names a file that differs only in upper and lower case. */
static void test_ignore_case(void **state)
{
    static const char rad[] = "!xform S.TXT\n";
    const struct upload_file files[] = {{"box.rad", rad, strlen(rad), false},
                                        {"s.txt", good_sensors, strlen(good_sensors), true}};
    struct daemon *daemon = *state;
    char scene[65];
    struct reply reply;
    upload(daemon, good_sensors, strlen(good_sensors), good_weather, scene);
    post(daemon, scene, "S.txt", &reply);
    assert_int_equal(reply.status, 422);
    assert_non_null(strstr(reply.body, "it has 's.txt': upper and lower case differ"));
    reply_done(&reply);
    daemon_upload(daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 422);
    assert_non_null(strstr(reply.body, "there is 's.txt', whose name differs in upper and lower"));
    reply_done(&reply);
}

/* A weather file of two years needs a year in the request; one without years must not have it. */
static void test_years(void **state)
{
    static const char epw[] = "LOCATION,Somewhere,-,TST,made up,000000,47,8,1.0,400.0\n"
                              "DATA PERIODS,1,1,Data,Sunday,1/1,12/31\n"
                              "2020,3,21,12,0,f,9,7,87,101300,0,0,305,0,500,200,0,0,0\n"
                              "2021,3,21,12,0,f,9,7,87,101300,0,0,305,0,500,200,0,0,0\n",
                      wea_of_two[] = HEAD HOUR "3 21 11.5 100 100\n";
    static const struct {
        const char *weather, *year, *says;
        long status;
    } cases[] = {
        {epw, "", "rows of 2020 and of 2021", 422},
        {epw, "\"year\":2019,", "no rows for 2019", 422},
        {epw, "\"year\":2021,", NULL, 202},
        {good_weather, "\"year\":2021,", "rows of WEA files have no year", 422},
        {wea_of_two, "", "lines 7 and 9 have the same time", 422},
    };
    struct daemon *daemon = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char scene[65], text[512];
        struct reply reply;
        upload(daemon, good_sensors, strlen(good_sensors), cases[i].weather, scene);
        snprintf(text, sizeof text,
                 "{\"scene\":\"%s\",\"technique\":\"direct\",\"gather_samples\":1,\"seed\":1,"
                 "\"sensors\":[[1,1,1,0,0,1]],\"sky\":{\"weather\":{\"file\":\"w.wea\",%s"
                 "\"month\":3,\"day\":21,\"hour\":11.5}}}",
                 scene, cases[i].year);
        daemon_post_json(daemon, "/v1/jobs", text, &reply);
        if (reply.status != cases[i].status)
            fail_msg("%zu: %ld, %s", i, reply.status, reply.body);
        if (cases[i].says)
            assert_non_null(strstr(reply_text(&reply, "detail"), cases[i].says));
        reply_done(&reply);
    }
}

/* Posts one view of a file with these lines; entry: JSON, and following text. */
static void post_view(struct daemon *daemon, const char *lines, const char *entry,
                      struct reply *reply)
{
    static const char box[] = "void light lamp 0 0 3 1 1 1\n"
                              "lamp polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0\n";
    const struct upload_file files[] = {{"box.rad", box, strlen(box), false},
                                        {"v.vf", lines, strlen(lines), true}};
    char text[512];
    daemon_upload(daemon, files, 2, NULL, reply);
    assert_int_equal(reply->status / 100, 2);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"backward\",\"pixel_samples\":1,\"views\":["
             "{\"name\":\"a\",\"view\":\"-vp 1 1 1 -vd 0 0 -1 -vu 0 1 0\",\"width\":2,"
             "\"height\":2},{\"name\":\"v\",\"file\":\"./v.vf\",\"entry\":%s,\"width\":2,"
             "\"height\":2}]}",
             reply_text(reply, "id"), entry);
    reply_done(reply);
    daemon_post_json(daemon, "/v1/jobs", text, reply);
}

#define DOWN "-vtv -vp 1 1 1 -vd 0 0 -1 -vu 0 1 0"

static void test_views(void **state)
{
    static const struct {
        const char *lines, *entry, *says;
        long status, line;
    } cases[] = {
        {"# none\n", "1", "has no views", 422, 0},
        {"view= a " DOWN "\n", "\"b\"", "none is 'b'", 422, 0},
        {"view= a " DOWN "\n", "2", "none is '2'", 422, 0},
        {"# a\n\nview= a -vtv -vp 1 1\n", "\"a\"", "", 400, 3},
        {"view= a " DOWN " -vh none\n", "1", "", 400, 1},
        {"rvu " DOWN "\nview= b " DOWN "\n", "\"b\"", NULL, 202, 0},
        {"rvu -vta -vp 1 1 1 -vd 0 1 0\n", "1,\"view\":\"-vd 0 0 -1 -vu 0 1 0 -vh 180\"", NULL, 202,
         0},
    };
    struct daemon *daemon = *state;
    struct reply reply;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        post_view(daemon, cases[i].lines, cases[i].entry, &reply);
        if (reply.status != cases[i].status)
            fail_msg("%zu: %ld, %s", i, reply.status, reply.body);
        if (cases[i].says) {
            assert_string_equal(reply_text(&reply, "file"), "v.vf");
            assert_non_null(strstr(reply_text(&reply, "detail"), cases[i].says));
            assert_true(!cases[i].line || reply_number(&reply, "line") == (double)cases[i].line);
        } else {
            char path[80];
            snprintf(path, sizeof path, "%s", reply_text(&reply, "links.self"));
            reply_done(&reply);
            daemon_wait(daemon, path, 60, &reply);
            assert_string_equal(reply_text(&reply, "state"), "succeeded");
        }
        reply_done(&reply);
    }
}

/* Any spelling of its name is accepted, and the job runs. */
static void test_right(void **state)
{
    static const char *const names[] = {"s.txt", "./s.txt"};
    struct daemon *daemon = *state;
    struct reply reply;
    char scene[65], path[80];
    upload(daemon, good_sensors, strlen(good_sensors), good_weather, scene);
    for (size_t i = 0; i < 2; i++) {
        post(daemon, scene, names[i], &reply);
        assert_int_equal(reply.status, 202);
        snprintf(path, sizeof path, "%s", reply_text(&reply, "links.self"));
        reply_done(&reply);
        daemon_wait(daemon, path, 60, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        reply_done(&reply);
    }
}

/* Returns one line repeated, and another one at the end. */
static char *repeat(const char *line, size_t count, const char *last, size_t *ret_size)
{
    char *text = NULL;
    FILE *stream = open_memstream(&text, ret_size);
    assert_non_null(stream);
    for (size_t i = 0; i < count; i++)
        fputs(line, stream);
    fputs(last, stream);
    assert_int_equal(fclose(stream), 0);
    return text;
}

/* Memory is estimated from sensors, not lines. */
static void test_memory(void **state)
{
    enum { LINES = 1000000 };
    static const char *const little[] = {"--memory", "700M", NULL};
    static const char *const lines[2] = {"#\n", "1 1 1 0 0 1\n"};
    static const long statuses[2] = {202, 413};
    struct daemon daemon;
    struct reply reply;
    (void)state;
    if (ORL_SANITIZED)
        skip();
    daemon_start(&daemon, little);
    for (int i = 0; i < 2; i++) {
        char scene[65];
        size_t size;
        char *sensors = repeat(lines[i], LINES, "1 1 1 0 0 1\n", &size);
        upload(&daemon, sensors, size, good_weather, scene);
        free(sensors);
        post(&daemon, scene, "s.txt", &reply);
        assert_int_equal(reply.status, statuses[i]);
        assert_int_equal(strstr(reply_text(&reply, "detail"), "1000001 sensors") != NULL, i);
        reply_done(&reply);
    }
    daemon_remove(&daemon);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_wrong, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_right, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_ignore_case, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_years, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_views, daemon_set_up, daemon_tear_down),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

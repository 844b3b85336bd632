/* A year's document: what is read, what is refused and how. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "annual_json.h"
#include "decode.h"

static const char good[] =
    "{\"kind\": \"annual\", \"title\": \"A room\", \"scene\": {\"files\": [\"a.rad\", \"b.rad\"]},"
    " \"weather\": \"place.epw\", \"north\": 30, \"ground_reflectance\": 0.1,"
    " \"grids\": [{\"sensors\": {\"file\": \"grid/desks.pts\"}, \"area\": 20},"
    " {\"name\": \"wall\", \"sensors\": [[1, 2, 3, 0, 1, 0], [1, 2, 4, 0, 1, 0]], \"area\": 4}],"
    " \"occupancy\": {\"from\": 9, \"to\": 17.5, \"days\": [\"mon\", \"fri\"], \"first_day\": "
    "\"sun\"},"
    " \"metrics\": [\"DA500\", \"UDI100-2000 over the year\"],"
    " \"targets\": [\"sDA300/50 of wall >= 55 %\"], \"rules\": [\"LEED\", \"EN 17037 high\"],"
    " \"samples\": 64, \"seed\": 7, \"accuracy\": {\"verdict\": \"DA500 of desks >= 70 %\"}}";

static int read_year(const char *text, struct orl_annual_job *ret_job, struct orl_error *err)
{
    json_t *doc = NULL;
    int rc = orl_json_parse("year.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_annual_job_from_json(doc, ORL_JOB_LOCAL, ret_job, NULL, err);
    json_decref(doc);
    return rc;
}

static void test_a_whole_document(void **state)
{
    struct orl_annual_job job;
    (void)state;
    assert_int_equal(read_year(good, &job, NULL), 0);
    assert_string_equal(job.title, "A room");
    assert_int_equal(job.request.n_scene_files, 2);
    assert_string_equal(job.request.scene_files[1], "b.rad");
    assert_string_equal(job.request.weather_file, "place.epw");
    assert_true(job.request.north_deg == 30 && job.request.ground_reflectance == 0.1);
    assert_int_equal(job.request.samples, 64);
    assert_int_equal(job.request.seed, 7);
    assert_int_equal(job.request.n_grids, 2);
    assert_string_equal(job.request.grids[0].name, "desks");
    assert_string_equal(job.grid_files[0], "grid/desks.pts");
    assert_string_equal(job.request.grids[1].name, "wall");
    assert_null(job.grid_files[1]);
    assert_int_equal(job.request.grids[1].count, 2);
    assert_true(job.request.sensors[1].position.z == 4);
    assert_true(job.wishes.grid_area[0] == 20 && job.wishes.grid_area[1] == 4);
    assert_true(job.wishes.occupancy.from_h == 9 && job.wishes.occupancy.to_h == 17.5);
    assert_int_equal(job.wishes.occupancy.days, 1 | 16);
    assert_int_equal(job.wishes.occupancy.first_day, 6);
    assert_int_equal(job.wishes.n_metrics, 2);
    assert_int_equal(job.wishes.metrics[0].kind, ORL_METRIC_DA);
    assert_true(job.wishes.metrics[1].high_lx == 2000);
    assert_int_equal(job.wishes.metrics[1].when, ORL_WHEN_ALWAYS);
    assert_int_equal(job.wishes.n_targets, 1);
    assert_string_equal(job.wishes.targets[0].grid, "wall");
    assert_int_equal(job.wishes.n_rules, 5);
    assert_string_equal(job.wishes.rules[4].name, "EN 17037 high");
    assert_string_equal(job.wishes.until->grid, "desks");
    orl_annual_job_done(&job);
}

/* As little as there can be; sensors of a file, read in between those of other grids. */
static void test_a_short_document(void **state)
{
    static const struct orl_file file = {"0 0 1 0 0 1\n1 0 1 0 0 1\n", 24, NULL};
    static const char *const names[] = {"a.pts"};
    struct orl_memory_files memory = {names, &file, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_annual_job job;
    (void)state;
    assert_int_equal(read_year("{\"kind\": \"annual\", \"scene\": {\"files\": [\"a.rad\"]}, "
                               "\"weather\": \"w.wea\", \"sensors\": {\"file\": \"a.pts\"}}",
                               &job, NULL),
                     0);
    assert_string_equal(job.request.grids[0].name, "a");
    assert_true(job.wishes.n_metrics > 5 && job.wishes.occupancy.from_h == 8);
    assert_null(job.wishes.grid_area);
    assert_int_equal(orl_annual_grids_read(&job.request, job.grid_files, &files, NULL), 0);
    assert_int_equal(job.request.n_sensors, 2);
    assert_int_equal(job.request.grids[0].count, 2);
    orl_annual_job_done(&job);
    assert_int_equal(read_year("{\"kind\": \"annual\", \"scene\": {\"files\": [\"a.rad\"]}, "
                               "\"weather\": \"w.wea\", \"grids\": [{\"sensors\": [[5, 5, 5, 0, 0, "
                               "1]]}, {\"sensors\": {\"file\": \"a.pts\"}}, {\"sensors\": [[6, 6, "
                               "6, 0, 0, 1]]}]}",
                               &job, NULL),
                     0);
    assert_string_equal(job.request.grids[0].name, "grid1");
    assert_int_equal(orl_annual_grids_read(&job.request, job.grid_files, &files, NULL), 0);
    assert_int_equal(job.request.n_sensors, 4);
    assert_int_equal(job.request.grids[2].first, 3);
    assert_true(job.request.sensors[0].position.x == 5 && job.request.sensors[2].position.x == 1 &&
                job.request.sensors[3].position.x == 6);
    orl_annual_job_done(&job);
}

static void test_mistakes_are_named(void **state)
{
    static const struct {
        const char *from, *to, *where;
    } cases[] = {
        {"\"kind\": \"annual\"", "\"kind\": \"study\"", "kind"},
        {"\"weather\"", "\"whether\"", "whether"},
        {"\"weather\": \"place.epw\",", "", "weather"},
        {"\"north\": 30", "\"north\": 500", "north"},
        {"\"ground_reflectance\": 0.1", "\"ground_reflectance\": 2", "ground_reflectance"},
        {"\"files\": [\"a.rad\", \"b.rad\"]", "\"files\": []", "scene.files"},
        {", \"area\": 4", "", "grids"},
        {"\"area\": 4", "\"area\": 0", "grids[1].area"},
        {"[1, 2, 4, 0, 1, 0]", "[1, 2, 4]", "grids[1].sensors[1]"},
        {"\"from\": 9", "\"from\": 25", "occupancy.from"},
        {"\"from\": 9", "\"file\": \"x.csv\", \"from\": 9", "occupancy"},
        {"\"mon\"", "\"monday\"", "occupancy.days[0]"},
        {"\"mon\", \"fri\"", "", "occupancy.days"},
        {"DA500", "sDA500", "metrics[0]"},
        {"UDI100-2000 over the year", "UDI100-2000 on Sundays", "metrics[1]"},
        {"55 %", "lots", "targets[0]"},
        {"LEED", "LED", "rules[0]"},
        {"\"samples\": 64", "\"samples\": 0", "samples"},
        {"{\"verdict\": \"DA500 of desks >= 70 %\"}", "{}", "accuracy.verdict"},
        {">= 70 %", "about 70 %", "accuracy.verdict"},
        {"\"wall\", \"sensors\"", "\"desks\", \"sensors\"", "grids"},
        {"\"wall\", \"sensors\"", "\"desks.direct\", \"sensors\"", "grids"},
        {"UDI100-2000 over the year", "DA500", "metrics"},
        {"\"seed\": 7", "\"formats\": [\"hdr\"]", "formats[0]"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *at = strstr(good, cases[i].from);
        struct orl_annual_job job;
        struct orl_error err = {0};
        char text[2048];
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, cases[i].to,
                 at + strlen(cases[i].from));
        if (read_year(text, &job, &err) == 0)
            fail_msg("'%s' for '%s' is taken", cases[i].to, cases[i].from);
        if (strcmp(err.primitive, cases[i].where) != 0)
            fail_msg("'%s': told at '%s', not at '%s': %s", cases[i].to, err.primitive,
                     cases[i].where, err.message);
        assert_true(err.message[0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_whole_document),
        cmocka_unit_test(test_a_short_document),
        cmocka_unit_test(test_mistakes_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Annual documents: decoded values, refusals and their messages. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "annual_job/annual_json.h"
#include "json/decode.h"

static const char good[] =
    "{\"kind\": \"annual\", \"title\": \"A room\", \"scene\": {\"files\": [\"a.rad\", \"b.rad\"]},"
    " \"weather\": \"place.epw\", \"north\": 30, \"ground_reflectance\": 0.1,"
    " \"sun\": \"radiance\","
    " \"grids\": [{\"sensors\": {\"file\": \"grid/desks.pts\"}, \"area\": 20},"
    " {\"name\": \"wall\", \"sensors\": [[1, 2, 3, 0, 1, 0], [1, 2, 4, 0, 1, 0]], \"area\": 4}],"
    " \"occupancy\": {\"from\": 9, \"to\": 17.5, \"days\": [\"mon\", \"fri\"], \"first_day\": "
    "\"sun\"},"
    " \"metrics\": [\"DA500\", \"UDI100-2000 over the year\"],"
    " \"targets\": [\"sDA300/50 of wall >= 55 %\"], \"rules\": [\"LEED\", \"EN 17037 high\"],"
    " \"shades\": [{\"name\": \"south\", \"windows\": [\"glass\", \"pane.2\"],"
    " \"states\": [{\"name\": \"open\"}, {\"name\": \"half\", \"files\": [\"half.rad\"]},"
    " {\"name\": \"shut\", \"dark\": true}], \"control\": {\"by\": \"LM-83\", \"grid\": \"desks\","
    " \"state\": \"Shut\"}}, {\"name\": \"north\", \"windows\": [\"n\"], \"states\": [{\"name\": "
    "\"a\"},"
    " {\"name\": \"b\", \"material\": \"lcp\"}], \"rules\": [{\"months\": [11, 2], \"from\": 9.5,"
    " \"state\": \"b\"}]}, {\"name\": \"east\", \"windows\": [\"e\"], \"states\": [{\"name\": "
    "\"a\"},"
    " {\"name\": \"b\", \"dark\": true}], \"schedule\": [0, 1, 1]}],"
    " \"exposure\": {\"points\": [{\"name\": \"w\", \"at\": [1, 2, 3]}, {\"at\": [4, 5, 6]}],"
    " \"least_altitude\": 11},"
    " \"view_out\": {\"points\": [{\"at\": [7, 8, 9]}], \"above_sensors\": 0.4,"
    " \"openings\": [\"clear\"], \"ground\": [\"lawn\", \"path\"]},"
    " \"glare\": {\"seats\": [{\"name\": \"desk\", \"at\": [1, 2, 1.2], \"towards\": [0, -1, 0]},"
    " {\"at\": [3, 2, 1.2], \"towards\": [1, 0, 0]}]},"
    " \"median_diffuse\": 14200, \"samples\": 64, \"sun_halvings\": 1, \"seed\": 7, \"accuracy\": "
    "{\"verdict\": \"DA500 of desks >= 70 %\"}}";

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
    assert_int_equal(job.request.sun_method, ORL_SUN_RADIANCE);
    assert_int_equal(job.request.samples, 64);
    assert_int_equal(job.request.sun_halvings, 1);
    assert_true(job.report_request.median_diffuse_lx == 14200);
    assert_int_equal(job.report_request.exposure.n_points, 2);
    assert_string_equal(job.report_request.exposure.points[0].name, "w");
    assert_string_equal(job.report_request.exposure.points[1].name, "point2");
    assert_true(job.report_request.exposure.points[1].at.y == 5);
    assert_true(job.report_request.exposure.least_altitude_deg == 11);
    assert_int_equal(job.report_request.view_out.n_points, 1);
    assert_string_equal(job.report_request.view_out.points[0].name, "point1");
    assert_true(job.report_request.view_out.points[0].at.z == 9);
    assert_true(job.report_request.view_out.above_sensors == 0.4);
    assert_string_equal(job.report_request.view_out.openings[0], "clear");
    assert_string_equal(job.report_request.view_out.ground[1], "path");
    assert_int_equal(job.report_request.glare.n_viewpoints, 2);
    assert_string_equal(job.report_request.glare.viewpoints[0].name, "desk");
    assert_string_equal(job.report_request.glare.viewpoints[1].name, "seat2");
    assert_true(job.report_request.glare.viewpoints[1].at.x == 3 &&
                job.report_request.glare.viewpoints[1].towards.x == 1);
    assert_int_equal(job.request.seed, 7);
    assert_int_equal(job.request.n_grids, 2);
    assert_string_equal(job.request.grids[0].name, "desks");
    assert_string_equal(job.grid_files[0], "grid/desks.pts");
    assert_string_equal(job.request.grids[1].name, "wall");
    assert_null(job.grid_files[1]);
    assert_int_equal(job.request.grids[1].count, 2);
    assert_true(job.request.sensors[1].position.z == 4);
    assert_true(job.report_request.grid_area[0] == 20 && job.report_request.grid_area[1] == 4);
    assert_true(job.report_request.occupancy.from_h == 9 &&
                job.report_request.occupancy.to_h == 17.5);
    assert_int_equal(job.report_request.occupancy.days, 1 | 16);
    assert_int_equal(job.report_request.occupancy.first_day, 6);
    assert_int_equal(job.report_request.n_metrics, 2);
    assert_int_equal(job.report_request.metrics[0].kind, ORL_METRIC_DA);
    assert_true(job.report_request.metrics[1].high_lx == 2000);
    assert_int_equal(job.report_request.metrics[1].when, ORL_WHEN_ALWAYS);
    assert_int_equal(job.report_request.n_targets, 1);
    assert_string_equal(job.report_request.targets[0].grid, "wall");
    assert_int_equal(job.report_request.n_rules, 5);
    assert_string_equal(job.report_request.rules[4].name, "EN 17037 high");
    assert_string_equal(job.report_request.until->grid, "desks");
    orl_annual_job_done(&job);
}

static void test_shades(void **state)
{
    struct orl_annual_job job;
    (void)state;
    assert_int_equal(read_year(good, &job, NULL), 0);
    assert_int_equal(job.request.n_groups, 3);
    const struct orl_window_group *g = job.request.groups;
    assert_string_equal(g[0].name, "south");
    assert_int_equal(g[0].n_windows, 2);
    assert_string_equal(g[0].windows[1], "pane.2");
    assert_int_equal(g[0].n_states, 3);
    assert_string_equal(g[0].states[1].files[0], "half.rad");
    assert_true(g[0].states[2].dark && !g[0].states[0].dark);
    assert_int_equal(g[0].control.kind, ORL_SHADES_BY_SUN);
    assert_string_equal(g[0].control.grid, "desks");
    assert_true(g[0].control.above_lx == 1000 && g[0].control.share_percent == 2);
    assert_int_equal(g[0].control.state, 2);
    assert_string_equal(g[1].states[1].material, "lcp");
    assert_int_equal(g[1].n_spans, 1);
    assert_true(g[1].spans[0].from_month == 11 && g[1].spans[0].to_month == 2);
    assert_true(g[1].spans[0].from_h == 9.5 && g[1].spans[0].to_h == 24);
    assert_int_equal(g[1].spans[0].state, 1);
    assert_int_equal(g[2].n_series, 3);
    assert_int_equal(g[2].series[2], 1);
    assert_int_equal(orl_annual_job_validate(&job, NULL), 0);
    orl_annual_job_done(&job);
}

/* The shortest document; sensors of a file, inserted between those of other grids. */
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
    assert_true(job.report_request.n_metrics > 5 && job.report_request.occupancy.from_h == 8);
    assert_null(job.report_request.grid_area);
    assert_int_equal(orl_annual_grids_read(&job.request, job.grid_files, &files, NULL, NULL), 0);
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
    assert_int_equal(orl_annual_grids_read(&job.request, job.grid_files, &files, NULL, NULL), 0);
    assert_int_equal(job.request.n_sensors, 4);
    assert_int_equal(job.request.grids[2].first, 3);
    assert_true(job.request.sensors[0].position.x == 5 && job.request.sensors[2].position.x == 1 &&
                job.request.sensors[3].position.x == 6);
    orl_annual_job_done(&job);
}

/* Decodes the valid document with one passage replaced by another. */
static int read_changed(const char *from, const char *to, struct orl_annual_job *ret_job,
                        struct orl_error *err)
{
    const char *at = strstr(good, from);
    char text[4096];
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
    return read_year(text, ret_job, err);
}

/* Documents that decode but contradict themselves. */
static void test_shades_that_cannot_be(void **state)
{
    static const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"\"windows\": [\"glass\", \"pane.2\"],", "", "names no windows"},
        {"\"grid\": \"desks\"", "\"grid\": \"sofas\"", "'sofas'"},
        {"\"north\", \"w", "\"South\", \"w", "two window groups"},
        {"\"half\"", "\"OPEN\"", "two states"},
        {"{\"by\": \"LM-83\", \"grid\": \"desks\"",
         "{\"by\": \"dgp\", \"above\": 1, \"seats\": [{\"at\": [1, 2, 1], \"towards\": [1, 0, 0]}]",
         "between 0 and 1"},
        {"{\"by\": \"LM-83\", \"grid\": \"desks\"",
         "{\"by\": \"dgp\", \"seats\": [{\"at\": [1, 2, 1], \"towards\": [0, 0, 1]}]",
         "straight up"},
        {"\"material\": \"lcp\"", "\"material\": \"lcp\", \"dark\": true",
         "dark and have a material"},
        {"\"schedule\"", "\"control\": {\"by\": \"sun\"}, \"schedule\"", "more than one of"},
        {"{\"name\": \"a\"}, {\"name\": \"b\", \"dark\": true}], \"schedule\": [0, 1, 1]",
         "{\"name\": \"a\"}], \"control\": {\"by\": \"sun\"}", "no state 1"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_annual_job job;
        struct orl_error err = {0};
        if (read_changed(cases[i].from, cases[i].to, &job, &err) != 0)
            fail_msg("'%s': %s", cases[i].to, err.message);
        assert_true(orl_annual_job_validate(&job, &err) < 0);
        assert_string_equal(err.primitive, "shades");
        if (!strstr(err.message, cases[i].says))
            fail_msg("'%s': %s", cases[i].to, err.message);
        orl_annual_job_done(&job);
    }
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
        {"\"radiance\"", "\"exact\"", "sun"},
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
        {"\"samples\": 64", "\"technique\": \"photons\"", "technique"},
        {"\"samples\": 64", "\"photons\": 0", "photons"},
        {"\"sun_halvings\": 1", "\"sun_halvings\": 3", "sun_halvings"},
        {"\"samples\": 64", "\"technique\": \"precomputed\"", "glare"},
        {"14200", "0", "median_diffuse"},
        {"[4, 5, 6]", "[4, 5]", "exposure.points[1].at"},
        {"\"least_altitude\": 11", "\"least_altitude\": 91", "exposure.least_altitude"},
        {"[7, 8, 9]", "[7, 8, true]", "view_out.points[0].at"},
        {"\"points\": [{\"at\": [7, 8, 9]}], \"above_sensors\": 0.4,", "", "view_out"},
        {"[\"clear\"]", "[]", "view_out.openings"},
        {"\"towards\": [0, -1, 0]", "\"towards\": [0, -1]", "glare.seats[0].towards"},
        {", \"towards\": [1, 0, 0]", "", "glare.seats[1].towards"},
        {"{\"verdict\": \"DA500 of desks >= 70 %\"}", "{}", "accuracy.verdict"},
        {">= 70 %", "about 70 %", "accuracy.verdict"},
        {"\"wall\", \"sensors\"", "\"desks\", \"sensors\"", "grids"},
        {"\"wall\", \"sensors\"", "\"desks.direct\", \"sensors\"", "grids"},
        {"\"wall\", \"sensors\"", "\"desks.se\", \"sensors\"", "grids"},
        {"UDI100-2000 over the year", "DA500", "metrics"},
        {"\"seed\": 7", "\"formats\": [\"hdr\"]", "formats[0]"},
        {"\"seed\": 7", "\"formats\": [\"coefficients\"]", "formats"},
        {"\"seed\": 7", "\"formats\": [\"phases\"]", "formats"},
        {"\"south\", ", "7, ", "shades[0].name"},
        {"[\"glass\", ", "[3, ", "shades[0].windows[0]"},
        {"[\"half.rad\"]", "\"half.rad\"", "shades[0].states[1].files"},
        {"\"dark\": true", "\"dark\": 1", "shades[0].states[2].dark"},
        {"\"LM-83\"", "\"LM-90\"", "shades[0].control.by"},
        {"\"LM-83\",", "\"LM-83\", \"above\": 500,", "shades[0].control"},
        {"\"LM-83\", \"grid\": \"desks\"", "\"illuminance\"", "shades[0].control"},
        {"\"LM-83\", \"grid\": \"desks\"", "\"dgp\"", "shades[0].control"},
        {"\"LM-83\"", "\"dgp\", \"seats\": [{\"at\": [1, 2, 1], \"towards\": [1, 0, 0]}]",
         "shades[0].control"},
        {"\"LM-83\"", "\"sun\", \"seats\": [{\"at\": [1, 2, 1], \"towards\": [1, 0, 0]}]",
         "shades[0].control"},
        {"\"LM-83\"", "\"dgp\", \"seats\": []", "shades[0].control.seats"},
        {"\"Shut\"", "\"closed\"", "shades[0].control"},
        {"[11, 2]", "[11, 13]", "shades[1].rules[0].months"},
        {"[11, 2]", "[11]", "shades[1].rules[0].months"},
        {"9.5, \"state\": \"b\"", "9.5, \"state\": \"c\"", "shades[1].rules"},
        {"[0, 1, 1]", "[0, 2, 1]", "shades[2].schedule[1]"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_annual_job job;
        struct orl_error err = {0};
        if (read_changed(cases[i].from, cases[i].to, &job, &err) == 0)
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
        cmocka_unit_test(test_a_whole_document),      cmocka_unit_test(test_a_short_document),
        cmocka_unit_test(test_mistakes_are_named),    cmocka_unit_test(test_shades),
        cmocka_unit_test(test_shades_that_cannot_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

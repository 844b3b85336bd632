/* result.json: its members by name, because scripts rely on them; and values that JSON cannot
 * express. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

#include "bsdf_json/bsdf_json.h"
#include "job/job_members_json.h"
#include "result/result_json.h"

static struct orl_result example(void)
{
    static double lux[3] = {812.5, NAN, 0};
    static struct orl_view_result views[1] = {
        {.name = "desk", .files = {"desk.hdr", "desk.png"}, .seconds = 1.5}};
    static char *warnings[1] = {"a polygon has no area"};
    struct orl_result result = {
        .threads = 2,
        .seed = 9,
        .timings_s = {0.5, 0.25, 0.125, 3, 1, 2},
        .total_s = 6.875,
        .n_maps = 1,
        .illuminance_lx = lux,
        .n_sensors = 3,
        .views = views,
        .n_views = 1,
        .health =
            {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 15, 11, 12, 13, 14, 0.5, 0.25, {0, 0, 0}, {0, 0, 0}},
        .warnings = warnings,
        .n_warnings = 1,
    };
    result.maps[0] = (struct orl_map_info){.kind = "global",
                                           .key = "ab",
                                           .family = "cd",
                                           .target = 1800000,
                                           .emitted = 5000000000ULL,
                                           .stored = 1900000,
                                           .bytes = 40000000,
                                           .reused = 500000,
                                           .seconds = 12.25,
                                           .cached = true};
    return result;
}

static void test_members(void **state)
{
    (void)state;
    const struct orl_result result = example();
    json_t *doc = orl_result_to_json(&result, "succeeded");
    json_t *expected = json_loads(
        "{\"state\":\"succeeded\",\"threads\":2,\"seed\":9,\"plan\":null,"
        "\"timings_s\":{\"load\":0.5,\"bvh\":0.25,\"plan\":0.125,\"photons\":3.0,"
        "\"maps\":1.0,\"render\":2.0,\"total\":6.875},"
        "\"maps\":[{\"kind\":\"global\",\"key\":\"ab\",\"emitted\":5000000000,\"stored\":1900000,"
        "\"reused\":500000,\"bytes\":40000000,\"seconds\":12.25,\"cached\":true}],"
        "\"sensors\":[{\"illuminance_lx\":812.5},{\"illuminance_lx\":null},"
        "{\"illuminance_lx\":0.0}],"
        "\"summary\":{\"mean_lx\":406.25,\"interval_95_lx\":[null,null],\"minimum_lx\":0.0,"
        "\"maximum_lx\":812.5,\"uniformity\":0.0,\"share_300\":0.5},"
        "\"views\":[{\"name\":\"desk\",\"hdr\":\"desk.hdr\",\"png\":\"desk.png\","
        "\"seconds\":1.5}],"
        "\"health\":{\"non_finite\":1,\"bsdf_clamped\":2,\"bsdf_rescaled\":3,\"degenerate\":4,"
        "\"photons_capped\":5,\"paths_capped\":6,\"rays_leaked\":7,\"sparse_estimates\":8,"
        "\"bsdf_values\":9,\"surfaces\":10,\"instances\":15,\"photons\":11,\"paths\":12,\"rays\":"
        "13,"
        "\"estimates\":14,\"flux_w\":0.5,\"flux_capped_w\":0.25},"
        "\"warnings\":[\"a polygon has no area\"],"
        "\"cost\":{\"seconds\":{\"load\":0.5,\"bvh\":0.25,\"plan\":0.125,\"photons\":3.0,"
        "\"maps\":1.0,\"render\":2.0,\"total\":6.875},\"rays\":0,\"photons\":0,"
        "\"next\":{\"error\":null,\"halve_s\":null,\"one_percent_s\":null,\"model\":\"\"}}}",
        0, NULL);
    assert_non_null(doc);
    assert_non_null(expected);
    assert_true(json_equal(doc, expected));
    json_decref(doc);
    json_decref(expected);
}

/* The plan appears in the result, and in the output of `oriel plan`. */
static void test_plan(void **state)
{
    (void)state;
    struct orl_result result = example();
    result.plan.technique = result.plan.sensor_technique = ORL_TECHNIQUE_DIRECT;
    json_t *plan = orl_plan_to_json(&result.plan);
    json_t *doc = orl_result_to_json(&result, "succeeded");
    const struct orl_accuracy_curve curve = {.technique = ORL_TECHNIQUE_BACKWARD,
                                             .threads = 2,
                                             .points = {{1.5, 0.25}, {4, 0.125}},
                                             .n_points = 2,
                                             .model = "so"};
    json_t *planned = orl_planned_to_json(&result, NULL);
    json_t *drawn = orl_planned_to_json(&result, &curve);
    json_t *expected = json_loads("{\"technique\":\"backward\",\"threads\":2,\"model\":\"so\","
                                  "\"points\":[{\"seconds\":1.5,\"error\":0.25},"
                                  "{\"seconds\":4.0,\"error\":0.125}]}",
                                  0, NULL);
    assert_non_null(expected);
    assert_true(json_equal(json_object_get(drawn, "curve"), expected));
    assert_true(json_is_null(json_object_get(planned, "curve")));
    json_decref(expected);
    json_decref(drawn);
    assert_true(json_is_object(plan));
    assert_true(json_equal(json_object_get(doc, "plan"), plan));
    assert_true(json_equal(json_object_get(planned, "plan"), plan));
    assert_true(json_equal(json_object_get(planned, "warnings"), json_object_get(doc, "warnings")));
    assert_int_equal(json_object_size(planned), 3);
    json_decref(planned);
    json_decref(doc);
    json_decref(plan);
}

/* Errors appear if they are known; a warning in Latin-1 does not make the result fail. */
static void test_errors_and_odd_warnings(void **state)
{
    (void)state;
    static double errors[3] = {0.5, 0, 0.25}, biases[3] = {-0.25, 0, 0};
    static double intervals[3][2] = {{1, 3}, {0, 0}, {0, INFINITY}};
    static char *warnings[1] = {"stra\xdf\x65 has no area"};
    struct orl_result result = example();
    result.standard_error_lx = errors;
    result.bias_estimate_lx = biases;
    result.interval_95_lx = intervals;
    result.warnings = warnings;
    json_t *doc = orl_result_to_json(&result, "succeeded");
    const json_t *first = json_array_get(json_object_get(doc, "sensors"), 0);
    assert_true(json_real_value(json_object_get(first, "standard_error_lx")) == 0.5);
    assert_true(json_real_value(json_object_get(first, "bias_estimate_lx")) == -0.25);
    const json_t *interval = json_object_get(first, "interval_95_lx");
    assert_int_equal(json_array_size(interval), 2);
    assert_true(json_real_value(json_array_get(interval, 1)) == 3);
    const json_t *last = json_array_get(json_object_get(doc, "sensors"), 2);
    assert_true(json_is_null(json_array_get(json_object_get(last, "interval_95_lx"), 1)));
    assert_string_equal(json_string_value(json_array_get(json_object_get(doc, "warnings"), 0)),
                        "stra?e has no area");
    json_decref(doc);
}

static void test_empty_result(void **state)
{
    (void)state;
    struct orl_result result;
    memset(&result, 0, sizeof result);
    json_t *doc = orl_result_to_json(&result, "failed");
    assert_non_null(doc);
    assert_string_equal(json_string_value(json_object_get(doc, "state")), "failed");
    assert_true(json_is_null(json_object_get(doc, "plan")));
    assert_true(json_is_array(json_object_get(doc, "sensors")));
    assert_int_equal(json_array_size(json_object_get(doc, "views")), 0);
    assert_int_equal(json_object_size(json_object_get(doc, "timings_s")), ORL_STAGE_COUNT + 1);
    json_decref(doc);
}

static void test_scene_summary(void **state)
{
    (void)state;
    char *referenced[] = {"lcp.xml"};
    const struct orl_scene_summary summary = {.surfaces = 12,
                                              .placed_surfaces = 40,
                                              .bsdfs = 1,
                                              .bounds_min = {-1, 0, 0.5},
                                              .bounds_max = {INFINITY, 1, 2},
                                              .digest = "cafe",
                                              .referenced = referenced,
                                              .n_referenced = 1};
    json_t *doc = orl_scene_summary_to_json(&summary);
    assert_non_null(doc);
    assert_int_equal(json_integer_value(json_object_get(doc, "surfaces")), 12);
    assert_int_equal(json_integer_value(json_object_get(doc, "placed_surfaces")), 40);
    const json_t *bounds = json_object_get(doc, "bounds");
    assert_true(json_real_value(json_array_get(json_object_get(bounds, "min"), 2)) == 0.5);
    assert_true(json_is_null(json_array_get(json_object_get(bounds, "max"), 0)));
    assert_string_equal(json_string_value(json_array_get(json_object_get(doc, "referenced"), 0)),
                        "lcp.xml");
    json_decref(doc);
}

static void test_bsdf_info(void **state)
{
    (void)state;
    const struct orl_bsdf_info info = {.name = "na\xefve", /* Latin-1, which is not valid UTF-8 */
                                       .kind = "Klems full",
                                       .resolution = 145,
                                       .has = {{true, false}, {false, true}},
                                       .max_albedo = {0.25, 0.75}};
    json_t *doc = orl_bsdf_info_to_json(&info);
    assert_non_null(doc);
    assert_true(json_is_null(json_object_get(doc, "name")));
    const json_t *components = json_object_get(doc, "components");
    assert_true(json_is_true(json_object_get(components, "reflection_back")));
    assert_true(json_is_true(json_object_get(components, "transmission_front")));
    assert_true(json_is_false(json_object_get(components, "transmission_back")));
    const json_t *albedo = json_object_get(doc, "max_albedo");
    assert_true(json_real_value(json_object_get(albedo, "front")) == 0.75);
    json_decref(doc);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members),
        cmocka_unit_test(test_plan),
        cmocka_unit_test(test_errors_and_odd_warnings),
        cmocka_unit_test(test_empty_result),
        cmocka_unit_test(test_scene_summary),
        cmocka_unit_test(test_bsdf_info),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Recipes of Ladybug Tools: names, inputs, skies as text, weather rows, and the jobs they become.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include <oriel/job/sun_position.h>

#include "recipe/recipe.h"
#include "recipe/recipe_sky.h"
#include "recipe/weather_rows.h"
#include "support/cli.h"

static const char model_text[] = "{\"type\": \"Model\", \"units\": \"Meters\"}";

static const struct orl_recipe *find_recipe(const char *name)
{
    const struct orl_recipe *recipe = NULL;
    struct orl_error err = {0};
    if (orl_recipe_find(name, &recipe, &err))
        fail_msg("%s: %s", name, err.message);
    return recipe;
}

/* Checks inputs given as JSON text; returns the code, and inputs and notes on success. */
static int check_inputs(const char *recipe, const char *text, json_t **ret_inputs,
                        json_t **ret_notes, struct orl_error *err)
{
    json_t *given = json_loads(text, 0, NULL);
    assert_non_null(given);
    const int rc = orl_recipe_check_inputs(find_recipe(recipe), given, ret_inputs, ret_notes, err);
    json_decref(given);
    return rc;
}

static void assert_real(double value, double wanted, double within)
{
    if (!(fabs(value - wanted) <= within))
        fail_msg("%.10g, not %.10g within %g", value, wanted, within);
}

/* ---- Names and inputs ------------------------------------------------------------------------ */

static void test_recipes_are_found_by_name(void **state)
{
    static const char *const names[] = {"point-in-time-grid",
                                        "point-in-time-view",
                                        "daylight-factor",
                                        "annual-daylight",
                                        "annual-daylight-enhanced",
                                        "annual-daylight-en17037",
                                        "direct-sun-hours",
                                        "imageless-annual-glare",
                                        "leed-daylight-option-one",
                                        "leed-daylight-option-two",
                                        "breeam-daylight-4b",
                                        "well-daylight",
                                        "sky-view"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_string_equal(find_recipe(names[i])->name, names[i]);
    assert_ptr_equal(find_recipe("annual_daylight"), find_recipe("annual-daylight"));
}

static void test_unknown_recipes_get_the_nearest_name(void **state)
{
    static const struct {
        const char *name, *hint;
        int code;
    } cases[] = {{"annual-dayligt", "did you mean annual-daylight?", ORL_ERR_NOT_FOUND},
                 {"sky-veiw", "did you mean sky-view?", ORL_ERR_NOT_FOUND},
                 {"teapot", "lists the recipes", ORL_ERR_NOT_FOUND},
                 {"annual-irradiance", "", ORL_ERR_UNSUPPORTED},
                 {"cumulative_radiation", "", ORL_ERR_UNSUPPORTED}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_recipe *recipe = NULL;
        struct orl_error err = {0};
        assert_int_equal(orl_recipe_find(cases[i].name, &recipe, &err), cases[i].code);
        assert_null(recipe);
        assert_non_null(strstr(err.hint, cases[i].hint));
    }
}

static void test_inputs_have_the_recipes_defaults(void **state)
{
    json_t *inputs = NULL, *notes = NULL;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(
        check_inputs("annual-daylight",
                     "{\"model\": \"a.hbjson\", \"wea\": \"b.epw\", \"north\": \"-12.5\", "
                     "\"cpu_count\": 4, \"schedule\": null, \"min-sensor-count\": 200}",
                     &inputs, &notes, &err),
        0);
    assert_real(orl_recipe_number(inputs, "north"), -12.5, 0);
    assert_real(orl_recipe_number(inputs, "timestep"), 1, 0);
    assert_string_equal(orl_recipe_text(inputs, "thresholds"), "-t 300 -lt 100 -ut 3000");
    assert_string_equal(orl_recipe_text(inputs, "grid-filter"), "*");
    assert_string_equal(orl_recipe_weather(inputs), "b.epw");
    assert_null(orl_recipe_text(inputs, "schedule"));
    assert_null(json_object_get(inputs, "cpu-count"));
    assert_int_equal(json_array_size(notes), 2); /* what tunes Radiance is noted, not used */
    json_decref(inputs);
    json_decref(notes);
}

static void test_wrong_inputs_are_refused_by_name(void **state)
{
    static const struct {
        const char *recipe, *inputs, *says, *hint;
    } cases[] = {
        {"annual-daylight", "{\"model\": \"a\"}", "needs the input 'wea'", "weather file"},
        {"annual-daylight", "{\"model\": \"a\", \"wea\": \"b\", \"schedul\": \"c\"}",
         "no input 'schedul'", "did you mean schedule?"},
        {"daylight-factor", "{\"model\": \"a\", \"wea\": \"b\"}", "no input 'wea'", "--help"},
        {"annual-daylight", "{\"model\": \"a\", \"wea\": \"b\", \"north\": 400}",
         "north: it is from -360 to 360", ""},
        {"annual-daylight", "{\"model\": \"a\", \"wea\": \"b\", \"timestep\": 1.5}",
         "timestep: a whole number is expected", ""},
        {"annual-daylight", "{\"model\": \"a\", \"wea\": \"b\", \"north\": \"up\"}",
         "north: a number is expected", ""},
        {"sky-view", "{\"model\": \"a\", \"cloudy-sky\": \"clear\"}",
         "'clear' is none of uniform|cloudy", ""},
        {"sky-view", "{\"model\": 3}", "model: a text is expected", ""},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        json_t *inputs = NULL, *notes = NULL;
        struct orl_error err = {0};
        assert_true(check_inputs(cases[i].recipe, cases[i].inputs, &inputs, &notes, &err) < 0);
        assert_null(inputs);
        if (!strstr(err.message, cases[i].says) || !strstr(err.hint, cases[i].hint))
            fail_msg("expected \"%s\" (%s) in: %s (%s)", cases[i].says, cases[i].hint, err.message,
                     err.hint);
    }
}

/* ---- Skies ----------------------------------------------------------------------------------- */

static json_t *read_sky(const char *text)
{
    json_t *sky = NULL;
    struct orl_error err = {0};
    if (orl_recipe_sky_to_json(text, &sky, &err))
        fail_msg("%s", err.message);
    return sky;
}

static double number_of(const json_t *object, const char *name)
{
    return json_number_value(json_object_get(object, name));
}

static void test_skies_are_read(void **state)
{
    (void)state;
    json_t *sky = read_sky("cie -alt 71.6 -az 185.2 -type 3 -g 0.1"), *cie;
    cie = json_object_get(sky, "cie");
    assert_string_equal(json_string_value(json_object_get(cie, "type")), "intermediate");
    assert_real(number_of(cie, "sun_altitude"), 71.6, 1e-9);
    assert_real(number_of(cie, "sun_azimuth"), 5.2, 1e-9); /* from south towards west */
    assert_real(number_of(cie, "ground_reflectance"), 0.1, 0);
    assert_non_null(json_object_get(cie, "direct_normal_lx")); /* type 3 has no sun */
    json_decref(sky);
    sky = read_sky("climate-based -alt 30 -az 90 -dni 800 -dhi 120");
    const json_t *perez = json_object_get(sky, "perez");
    assert_real(number_of(perez, "sun_azimuth"), -90, 1e-9);
    assert_real(number_of(perez, "direct_normal_w_m2"), 800, 0);
    assert_real(number_of(perez, "diffuse_horizontal_w_m2"), 120, 0);
    json_decref(sky);
    sky = read_sky("irradiance 100 -u");
    cie = json_object_get(sky, "cie");
    assert_string_equal(json_string_value(json_object_get(cie, "type")), "uniform");
    assert_real(number_of(cie, "diffuse_horizontal_lx"), 17900, 1e-9); /* 179 lm/W */
    json_decref(sky);
}

/* At solar noon the sun is in the south, at 90 degrees less latitude plus declination. */
static void test_hours_without_a_zone_are_solar(void **state)
{
    (void)state;
    json_t *sky = read_sky("cie 21 Jun 12:00 -lat 42 -lon -71.06 -n 30");
    const json_t *cie = json_object_get(sky, "cie");
    assert_real(number_of(cie, "sun_altitude"), 90 - 42 + 23.436, 0.02);
    assert_real(number_of(cie, "sun_azimuth"), -30, 0.05); /* north turned by 30 degrees */
    json_decref(sky);
    sky = read_sky("cie 21 Jun 12:00 -lat 42 -lon -71.06 -tz -5");
    /* Standard noon is 15.8 min after solar noon by longitude, less 1.8 min by the equation of
     * time: an hour angle of 3.5 degrees, and 3.5 cos(declination) / sin(zenith distance) in
     * azimuth. */
    assert_real(number_of(json_object_get(sky, "cie"), "sun_azimuth"), 10.0, 0.3);
    json_decref(sky);
}

static void test_wrong_skies_name_the_word(void **state)
{
    static const struct {
        const char *text, *says;
    } cases[] = {{"sunny", "'sunny': a sky begins with"},
                 {"cie -alt high", "'-alt': a number is expected"},
                 {"cie -type 7", "'-type': a whole number from 0 to 5"},
                 {"cie 21 Nonember 12:00", "a time such as"},
                 {"cie 21 Jun", "a time has day, month and hour"},
                 {"climate-based -alt 3 -shine 4", "'-shine': this word is not known"},
                 {"illuminance", "a number is expected"},
                 {" ", "a sky is expected"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        json_t *sky = NULL;
        struct orl_error err = {0};
        assert_int_equal(orl_recipe_sky_to_json(cases[i].text, &sky, &err), ORL_ERR_INVALID);
        if (!strstr(err.message, cases[i].says))
            fail_msg("expected \"%s\" in: %s", cases[i].says, err.message);
    }
}

/* ---- Weather --------------------------------------------------------------------------------- */

static struct orl_weather_rows read_weather(const char *name)
{
    char *text = cli_read_file("tests/fixtures", name);
    struct orl_weather_rows weather = {.rows = NULL};
    struct orl_error err = {0};
    assert_non_null(text);
    if (orl_weather_rows_read(name, text, strlen(text), &weather, &err))
        fail_msg("%s", err.message);
    free(text);
    return weather;
}

static void test_weather_files_of_both_kinds_agree(void **state)
{
    struct orl_weather_rows epw = read_weather("weather.epw"), wea = read_weather("weather.wea");
    (void)state;
    assert_int_equal(epw.count, 48);
    assert_int_equal(wea.count, epw.count);
    assert_real(wea.latitude_deg, epw.latitude_deg, 0.01);
    assert_real(wea.longitude_deg, epw.longitude_deg, 0.01);
    assert_real(wea.time_zone_h, epw.time_zone_h, 1e-6);
    for (size_t i = 0; i < epw.count; i++) {
        assert_int_equal(wea.rows[i].day, epw.rows[i].day);
        assert_real(wea.rows[i].hour, epw.rows[i].hour, 1e-9);
        assert_real(wea.rows[i].direct_normal, epw.rows[i].direct_normal, 1);
        assert_real(wea.rows[i].diffuse_horizontal, epw.rows[i].diffuse_horizontal, 1);
    }
    char *constant = orl_weather_rows_constant(&epw, 1000, 500);
    struct orl_weather_rows again = {.rows = NULL};
    struct orl_error err = {0};
    assert_int_equal(orl_weather_rows_read("c", constant, strlen(constant), &again, &err), 0);
    assert_int_equal(again.count, epw.count);
    assert_real(again.longitude_deg, epw.longitude_deg, 1e-4);
    assert_real(again.rows[30].direct_normal, 1000, 0);
    assert_real(again.rows[30].diffuse_horizontal, 500, 0);
    free(constant);
    orl_weather_rows_done(&again);
    orl_weather_rows_done(&epw);
    orl_weather_rows_done(&wea);
}

static void test_other_files_are_no_weather(void **state)
{
    static const struct {
        const char *text, *says;
        int line;
    } cases[] = {{"hello\n", "no weather file", 1},
                 {"LOCATION,a,b\n", "lacks latitude", 1},
                 {"place x\nlatitude 1\n", "no rows", 2},
                 {"place x\n13 1 0.5 1 1\n", "no date", 2}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_weather_rows weather = {.rows = NULL};
        struct orl_error err = {0};
        assert_int_equal(
            orl_weather_rows_read("w", cases[i].text, strlen(cases[i].text), &weather, &err),
            ORL_ERR_SYNTAX);
        assert_non_null(strstr(err.message, cases[i].says));
        assert_int_equal(err.line, cases[i].line);
    }
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

/* Makes a run of a recipe whose weather and schedule are texts. */
static int make_run(const char *name, const char *given, const char *weather, const char *schedule,
                    struct orl_recipe_run **ret_run, struct orl_error *err)
{
    json_t *inputs = NULL, *notes = NULL, *model = json_loads(model_text, 0, NULL);
    int rc = check_inputs(name, given, &inputs, &notes, err);
    const struct orl_recipe_texts texts = {.model = model,
                                           .weather = weather,
                                           .weather_size = weather ? strlen(weather) : 0,
                                           .schedule = schedule,
                                           .schedule_size = schedule ? strlen(schedule) : 0};
    if (rc == 0)
        rc = orl_recipe_run_new(find_recipe(name), inputs, &texts, "out", ret_run, err);
    json_decref(inputs);
    json_decref(notes);
    json_decref(model);
    return rc;
}

static const char header[] = "place x\nlatitude 40\nlongitude 75\ntime_zone 75\nsite_elevation 0\n"
                             "weather_data_file_units 1\n";

/* The clearest hours from 9:00 are 800 W/m2 on 25 March and 600 on 10 September; the sky has their
 * mean, and the sun of 21 March. */
static void test_leed_option_two_takes_the_clearest_hours(void **state)
{
    char weather[1024];
    struct orl_recipe_run *run = NULL;
    struct orl_error err = {0};
    (void)state;
    snprintf(weather, sizeof weather,
             "%s3 5 9.5 999 1\n3 24 9.5 700 50\n3 25 9.5 800 100\n3 25 15.5 300 10\n"
             "9 10 9.5 600 60\n9 10 15.5 500 30\n9 30 9.5 100 1\n",
             header);
    if (make_run("leed-daylight-option-two", "{\"model\": \"m\", \"wea\": \"w\"}", weather, NULL,
                 &run, &err))
        fail_msg("%s", err.message);
    assert_int_equal(orl_recipe_job_count(run), 2);
    const json_t *sky =
        json_object_get(json_object_get(orl_recipe_job_document(run, 0), "sky"), "perez");
    const struct orl_sun_time time = {40, -75, -5, 3, 21, 9, false};
    double altitude, azimuth;
    orl_sun_angles(&time, &altitude, &azimuth);
    assert_real(number_of(sky, "direct_normal_w_m2"), 700, 1e-9);
    assert_real(number_of(sky, "diffuse_horizontal_w_m2"), 80, 1e-9);
    assert_real(number_of(sky, "sun_altitude"), altitude, 1e-9);
    assert_true(azimuth < -40 && azimuth > -70); /* south-east */
    sky = json_object_get(json_object_get(orl_recipe_job_document(run, 1), "sky"), "perez");
    assert_real(number_of(sky, "direct_normal_w_m2"), 400, 1e-9);
    orl_recipe_run_free(run);
}

static void test_schedules_become_occupancy(void **state)
{
    enum { HOURS = 8760 };
    char weather[512], *schedule = malloc(HOURS * 4 + 1), *at = schedule;
    struct orl_recipe_run *run = NULL;
    struct orl_error err = {0};
    (void)state;
    snprintf(weather, sizeof weather, "%s1 1 8.25 0 0\n1 1 8.75 0 0\n", header);
    for (int i = 0; i < HOURS; i++) /* 0.5 is not in use, as in Honeybee */
        at += sprintf(at, "%s\n", i % 3 == 0 ? "1" : i % 3 == 1 ? "0.5" : "0");
    if (make_run("annual-daylight", "{\"model\": \"m\", \"wea\": \"w\", \"timestep\": 2}", weather,
                 schedule, &run, &err))
        fail_msg("%s", err.message);
    const json_t *document = orl_recipe_job_document(run, 0);
    const char *name =
        json_string_value(json_object_get(json_object_get(document, "occupancy"), "file"));
    const char *marks = json_string_value(json_object_get(orl_recipe_job_files(run), name));
    assert_int_equal(strlen(marks), 2 * 2 * HOURS); /* a digit and a line's end per half hour */
    assert_memory_equal(marks, "1\n1\n0\n0\n0\n0\n1\n", 14);
    orl_recipe_run_free(run);
    assert_int_equal(make_run("annual-daylight", "{\"model\": \"m\", \"wea\": \"w\"}", weather,
                              NULL, &run, &err),
                     ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "2 rows per hour, not 1"));
    assert_int_equal(make_run("annual-daylight",
                              "{\"model\": \"m\", \"wea\": \"w\", \"timestep\": 2}", weather,
                              "1\n0\n", &run, &err),
                     ORL_ERR_RANGE);
    free(schedule);
}

static void test_metrics_without_irradiance_are_refused(void **state)
{
    struct orl_recipe_run *run = NULL;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(make_run("point-in-time-grid",
                              "{\"model\": \"m\", \"sky\": \"illuminance 1\", \"metric\": "
                              "\"irradiance\"}",
                              NULL, NULL, &run, &err),
                     ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "metric: irradiance"));
    assert_string_equal(err.hint, "illuminance is");
}

static void test_filters_keep_matching_names(void **state)
{
    json_t *document = json_loads("{\"grids\": [{\"name\": \"a/x\"}, {\"name\": \"b\"}], "
                                  "\"views\": [{\"name\": \"v\"}]}",
                                  0, NULL);
    struct orl_recipe_run *run = NULL;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(make_run("daylight-factor", "{\"model\": \"m\", \"grid-filter\": \"a*\"}",
                              NULL, NULL, &run, &err),
                     0);
    assert_int_equal(orl_recipe_filter(run, document, &err), 0);
    assert_int_equal(json_array_size(json_object_get(document, "grids")), 1);
    assert_null(json_object_get(document, "views")); /* the recipe has grids alone */
    json_object_set_new(document, "grids", json_pack("[{s:s}]", "name", "c"));
    assert_int_equal(orl_recipe_filter(run, document, &err), ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "no grids that match 'a*'"));
    orl_recipe_run_free(run);
    json_decref(document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_recipes_are_found_by_name),
        cmocka_unit_test(test_unknown_recipes_get_the_nearest_name),
        cmocka_unit_test(test_inputs_have_the_recipes_defaults),
        cmocka_unit_test(test_wrong_inputs_are_refused_by_name),
        cmocka_unit_test(test_skies_are_read),
        cmocka_unit_test(test_hours_without_a_zone_are_solar),
        cmocka_unit_test(test_wrong_skies_name_the_word),
        cmocka_unit_test(test_weather_files_of_both_kinds_agree),
        cmocka_unit_test(test_other_files_are_no_weather),
        cmocka_unit_test(test_leed_option_two_takes_the_clearest_hours),
        cmocka_unit_test(test_schedules_become_occupancy),
        cmocka_unit_test(test_metrics_without_irradiance_are_refused),
        cmocka_unit_test(test_filters_keep_matching_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Annual glare at a viewpoint, compared with glare pictures of the same hours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/extent.h"
#include "support/year.h"

enum { SAMPLES = 512, SIDE = 60, MOST_COLUMNS = 64 };

#define HEAD(latitude)                                                                             \
    "place made_up\nlatitude " latitude "\nlongitude -27.14\ntime_zone -30\nsite_elevation 0\n"    \
    "weather_data_file_units 1\n"
#define ROOM ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND

static const struct year_site izmir = {38.42, 27.14, 2};
static char near_name[] = "near", aside_name[] = "aside";
static struct orl_viewpoint viewpoints[] = {{near_name, {2, 2, 1.8}, {0, -1, 0}},
                                            {aside_name, {3, 3, 1.2}, {-1, -.3, 0}}};
static const struct orl_viewpoint_request both = {viewpoints, 2};
static const struct orl_sensor nowhere = {{2, 2, 2}, {0, 0, 1}};

static struct year_run run_of(const char *scene, const char *weather)
{
    return (struct year_run){.scene = scene,
                             .site = izmir,
                             .weather = weather,
                             .sensors = &nowhere,
                             .n_sensors = 1,
                             .samples = SAMPLES,
                             .photons = (uint32_t)extent(20000, 0),
                             .seed = 3};
}

/* Returns a year in which all rows have light. */
static struct orl_annual_result lit_year(size_t columns)
{
    static uint32_t rows[MOST_COLUMNS];
    for (uint32_t i = 0; i < MOST_COLUMNS; i++)
        rows[i] = i;
    return (struct orl_annual_result){
        .n_steps = columns, .n_columns = columns, .step_of_column = rows};
}

/*
 * A low sun on the floor, a veiled and an overcast sky. Annual DGP must be within 0.05 of a
 * picture's, and within 0.02 on average: paths on both sides contribute less than 0.006, pixels
 * of 1.1 and 2.8 degrees the rest, where sun patches and the sky beside bars are as wide as the
 * pixels.
 */
static void test_against_pictures(void **state)
{
    static const char weather[] = HEAD("38.42") "1 21 10.5 700 90\n9 3 14.5 300 250\n"
                                                "11 5 12.5 0 160\n";
    const struct year_run run = run_of(ROOM, weather);
    struct orl_annual_result year = year_run(&run);
    const uint32_t pixel_samples = (uint32_t)extent(6, 12);
    unsigned char wanted[MOST_COLUMNS];
    double squares = 0, worst = 0;
    (void)state;
    memset(wanted, 1, sizeof wanted);
    struct orl_viewpoint_hours *hours = year_glare(&run, &year, &both, wanted);
    assert_int_equal(year.n_columns, 3);
    for (size_t s = 0; s < both.n_viewpoints; s++)
        for (size_t c = 0; c < year.n_columns; c++) {
            const struct orl_annual_step *step = &year.steps[year.step_of_column[c]];
            double eye_lx;
            const double dgp = year_dgp(&run, step, &viewpoints[s], SIDE, pixel_samples, &eye_lx);
            const double found = (double)hours[s].dgp[c];
            print_message("%s, %d/%d %.1f h: %.3f [%.3f, %.3f] %.0f lx, picture %.3f %.0f lx\n",
                          viewpoints[s].name, step->month, step->day, step->hour, found,
                          (double)hours[s].low[c], (double)hours[s].high[c],
                          (double)hours[s].eye_lx[c], dgp, eye_lx);
            assert_true(hours[s].low[c] <= hours[s].dgp[c] && hours[s].dgp[c] <= hours[s].high[c]);
            squares += (found - dgp) * (found - dgp) / (2 * 3);
            worst = fmax(worst, fabs(found - dgp));
        }
    print_message("rms %.4f, worst %.4f\n", sqrt(squares), worst);
    assert_true(sqrt(squares) <= 0.02);
    assert_true(worst <= 0.05);
    orl_viewpoint_hours_free(hours, both.n_viewpoints);
    orl_annual_done(&year);
}

/* Only the requested columns are rated, with equal results for any number of threads. */
static void test_wanted(void **state)
{
    static const char weather[] = HEAD("38.42") "1 21 10.5 700 90\n1 21 11.5 700 90\n";
    struct year_run run = run_of(ROOM, weather);
    const unsigned char wanted[MOST_COLUMNS] = {0, 1};
    (void)state;
    run.samples = 16;
    const struct orl_annual_result year = lit_year(2);
    struct orl_viewpoint_hours *one = year_glare(&run, &year, &both, wanted);
    run.threads = 3;
    struct orl_viewpoint_hours *three = year_glare(&run, &year, &both, wanted);
    for (size_t s = 0; s < both.n_viewpoints; s++) {
        assert_true(isnan(one[s].dgp[0]) && isnan(three[s].eye_lx[0]));
        assert_true(one[s].dgp[1] > 0.16F);
        assert_memory_equal(&one[s].dgp[1], &three[s].dgp[1], sizeof(float));
        assert_memory_equal(&one[s].low[1], &three[s].low[1], sizeof(float));
        assert_memory_equal(&one[s].high[1], &three[s].high[1], sizeof(float));
    }
    orl_viewpoint_hours_free(one, both.n_viewpoints);
    orl_viewpoint_hours_free(three, both.n_viewpoints);
}

/* A viewer with the sun through a pane 12 degrees off the line of sight has intolerable glare; a
 * viewer facing away in the same light has not. */
static void test_sun_in_sight(void **state)
{
    static const char weather[] = HEAD("38.42") "12 21 11.5 800 60\n";
    static struct orl_viewpoint two[] = {{near_name, {2, 1.5, 1.2}, {0, -1, .3}},
                                         {aside_name, {2, 1.5, 1.2}, {0, 1, 0}}};
    const struct orl_viewpoint_request viewpoint_request = {two, 2};
    const struct year_run run = run_of(ROOM, weather);
    const unsigned char wanted[MOST_COLUMNS] = {1};
    const struct orl_annual_result year = lit_year(1);
    (void)state;
    struct orl_viewpoint_hours *hours = year_glare(&run, &year, &viewpoint_request, wanted);
    assert_true(hours[0].dgp[0] > 0.95F && hours[0].eye_lx[0] > 20000);
    assert_true(hours[1].dgp[0] < 0.5F && hours[1].eye_lx[0] < 10000);
    orl_viewpoint_hours_free(hours, viewpoint_request.n_viewpoints);
}

/* In hours in which a shade is another pane, the viewpoint sees through that pane; dark hours have
 * no glare. These hours equal those of a scene written with that pane. */
static void test_shades(void **state)
{
    static const char weather[] = HEAD("38.42") "1 21 10.5 700 90\n3 22 9.5 600 110\n"
                                                "6 21 12.5 850 100\n";
    static char name[] = "south", clear[] = "clear", tinted[] = "tinted", dark[] = "dark",
                pane[] = "pane", tint[] = "t";
    static char *windows[] = {pane};
    static struct orl_shade_state states[] = {
        {.name = clear}, {.name = tinted, .material = tint}, {.name = dark, .dark = true}};
    unsigned char series[] = {0, 1, 2};
    const struct orl_window_group group = {
        .name = name, .windows = windows, .n_windows = 1, .states = states, .n_states = 3};
    static const unsigned char wanted[MOST_COLUMNS] = {1, 1, 1};
    const struct orl_viewpoint_request viewpoint_request = {viewpoints, 1};
    struct year_run run = run_of("void glass t 0 0 3 .2 .2 .2\n" ROOM, weather);
    run.samples = 16;
    struct orl_annual_result year = lit_year(3);
    struct orl_viewpoint_hours *clearly = year_glare(&run, &year, &viewpoint_request, wanted);
    run.groups = &group;
    run.n_groups = 1;
    year.states = series;
    year.n_groups = 1;
    struct orl_viewpoint_hours *shaded = year_glare(&run, &year, &viewpoint_request, wanted);
    (void)state;
    for (size_t s = 0; s < viewpoint_request.n_viewpoints; s++) {
        assert_true(shaded[s].dgp[0] == clearly[s].dgp[0]);
        assert_true(shaded[s].eye_lx[1] < 0.3F * clearly[s].eye_lx[1]);
        assert_true(shaded[s].dgp[1] > 0.16F && shaded[s].dgp[1] < clearly[s].dgp[1]);
        assert_true(shaded[s].eye_lx[2] == 0 && shaded[s].dgp[2] < 0.16F);
    }
    orl_viewpoint_hours_free(clearly, viewpoint_request.n_viewpoints);
    orl_viewpoint_hours_free(shaded, viewpoint_request.n_viewpoints);
}

/* A shade controlled by a viewpoint's glare is closed in the hours in which glare with the open
 * shade is above the limit. */
static void test_control(void **state)
{
    static const char weather[] = HEAD("38.42") "1 21 10.5 700 90\n9 3 14.5 300 250\n"
                                                "11 5 12.5 0 160\n";
    static char name[] = "south", clear[] = "clear", dark[] = "dark", pane[] = "pane";
    static char *windows[] = {pane};
    static struct orl_shade_state states[] = {{.name = clear}, {.name = dark, .dark = true}};
    const struct orl_viewpoint_request viewpoint_request = {viewpoints, 1};
    const struct orl_window_group group = {.name = name,
                                           .windows = windows,
                                           .n_windows = 1,
                                           .states = states,
                                           .n_states = 2,
                                           .control = {.kind = ORL_SHADES_BY_GLARE,
                                                       .viewpoints = viewpoint_request,
                                                       .above_dgp = 0.36,
                                                       .state = 1}};
    static const unsigned char wanted[MOST_COLUMNS] = {1, 1, 1};
    struct year_run run = run_of(ROOM, weather);
    run.samples = 64;
    struct orl_annual_result lit = lit_year(3);
    struct orl_viewpoint_hours *open = year_glare(&run, &lit, &viewpoint_request, wanted);
    run.groups = &group;
    run.n_groups = 1;
    struct orl_annual_result year = year_run(&run);
    (void)state;
    assert_true(open[0].dgp[0] > 0.36F && open[0].dgp[1] > 0.36F && open[0].dgp[2] < 0.36F);
    for (size_t c = 0; c < 3; c++) {
        assert_int_equal(year.states[c], open[0].dgp[c] > 0.36F);
        assert_true((year.total[c] > 0) == (year.states[c] == 0));
    }
    orl_viewpoint_hours_free(open, 1);
    orl_annual_done(&year);
}

/* Requests for which glare cannot be computed are refused with a reason. */
static void test_refused(void **state)
{
    struct orl_viewpoint viewpoint = {near_name, {2, 2, 1.2}, {0, 0, -1}};
    const struct orl_viewpoint_request viewpoint_request = {&viewpoint, 1};
    struct orl_annual_request request = {.n_terms = 0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_viewpoints_validate(&viewpoint_request, &request, &err), ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "straight up or down"));
    viewpoint.towards = orl_v3(0, NAN, 0);
    assert_int_equal(orl_viewpoints_validate(&viewpoint_request, &request, NULL), ORL_ERR_RANGE);
    viewpoint.towards = orl_v3(1, 0, 0);
    assert_int_equal(orl_viewpoints_validate(&viewpoint_request, &request, NULL), 0);
    request.n_terms = 1;
    assert_int_equal(orl_viewpoints_validate(&viewpoint_request, &request, &err),
                     ORL_ERR_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_pictures), cmocka_unit_test(test_wanted),
        cmocka_unit_test(test_sun_in_sight),     cmocka_unit_test(test_shades),
        cmocka_unit_test(test_control),          cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests_name("annual_glare", tests, NULL, NULL);
}

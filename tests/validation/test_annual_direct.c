/*
 * Direct sunlight (oriel/annual/annual.h) behind a clear pane described in four ways: as glass, as
 * a Klems matrix, as a tensor tree and as aBSDF. The results do not depend on the description.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "fixtures/bsdf_make.h"
#include "support/extent.h"
#include "support/year.h"

enum { COLUMNS = 8, ROWS = 40, SENSORS = COLUMNS * ROWS, HOURS = 4, SUNNY = 3, PANES = 4 };
enum pane { GLASS, ABSDF, TREE, KLEMS };

static const double through = 0.6, of_glass = 0.66, pane_m2 = 3;
/* The sensors cover the front part of the room, where the sun's patch is. */
static const double width_m = 4, depth_m = 2;
static const char *const names[PANES] = {"glass", "aBSDF", "tensor tree", "Klems"};
static const char *const materials[PANES] = {
    "void glass p 0 0 3 .66 .66 .66\n", "void aBSDF p 5 pane.xml 0 0 1 . 0 0\n",
    "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n", "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"};
/* About noon, the sun 45 to 52 degrees high: even blurred, its patch lies on the sensors. The last
 * hour has no sun. */
static const char weather[] = "place made_up\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                              "site_elevation 0\nweather_data_file_units 1\n"
                              "3 22 10.5 850 100\n3 22 12.5 850 100\n3 22 13.5 850 100\n"
                              "3 22 15.5 0 100\n";

/* Maps each cell to the cell of the same direction, with a clear pane's transmittance. */
static struct text make_klems(void)
{
    static const double edges[] = {0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
    static const int counts[] = {1, 8, 16, 20, 24, 24, 24, 16, 12};
    enum { CELLS = 145 };
    double values[CELLS];
    int n = 0;
    for (int ring = 0; ring < 9; ring++)
        for (int i = 0; i < counts[ring]; i++) {
            const double inner = cos(edges[ring] * ORL_DEG_TO_RAD);
            const double outer = cos(edges[ring + 1] * ORL_DEG_TO_RAD);
            values[n++] = through * counts[ring] / (ORL_PI * (inner * inner - outer * outer));
        }
    struct text t;
    text_open(&t);
    make_head(t.stream, "Columns");
    make_block_head(t.stream, "Visible", "Transmission Front", "LBNL/Klems Full");
    for (int out = 0; out < CELLS; out++)
        for (int in = 0; in < CELLS; in++)
            fprintf(t.stream, "%.9g\n", out == in ? values[in] : 0);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t;
}

/* height_m: height of the sensors; screen: more scene text. */
static struct orl_annual_result run_at(double height_m, enum pane pane, const char *screen,
                                       const struct orl_window_group *group)
{
    static struct orl_sensor sensors[SENSORS];
    struct text bsdf = pane == KLEMS ? make_klems() : make_clear_file(5, through, 0);
    char scene[4096];
    for (int i = 0; i < SENSORS; i++) {
        const int row = i / COLUMNS, column = i % COLUMNS;
        sensors[i] = (struct orl_sensor){
            {width_m * (column + 0.5) / COLUMNS, depth_m * (row + 0.5) / ROWS, height_m},
            {0, 0, 1}};
    }
    snprintf(scene, sizeof scene, "%s%s%s", materials[pane], screen,
             ROOM_GREY ROOM_SHELL ROOM_PANE ROOM_GROUND);
    struct orl_annual_result year =
        year_run(&(struct year_run){.scene = scene,
                                    .resource_name = "pane.xml",
                                    .resource_text = bsdf.data,
                                    .weather = weather,
                                    .sensors = sensors,
                                    .n_sensors = SENSORS,
                                    .groups = group,
                                    .n_groups = group ? 1 : 0,
                                    .samples = 16,
                                    .photons = (uint32_t)extent(2000, 0),
                                    .threads = 2,
                                    .seed = 3});
    free(bsdf.data);
    assert_int_equal(year.n_columns, HOURS);
    return year;
}

static struct orl_annual_result run_pane(enum pane pane, const char *screen,
                                         const struct orl_window_group *group)
{
    return run_at(0.8, pane, screen, group);
}

/* Flux over all sensors in an hour, lm, and number of sensors above 1000 lx. */
struct hour {
    double flux_lm;
    int above;
};

static struct hour sum_hour(const struct orl_annual_result *year, size_t column)
{
    struct hour hour = {0, 0};
    for (size_t i = 0; i < SENSORS; i++) {
        const double lx = (double)orl_annual_row(year, year->direct, i)[column];
        assert_true(lx <= (double)orl_annual_row(year, year->total, i)[column] * (1 + 1e-6));
        hour.flux_lm += lx * width_m * depth_m / SENSORS;
        hour.above += lx > 1000;
    }
    return hour;
}

/* Glass of refractive index 1.52: Fresnel reflectances of both polarisations, all orders. */
static double glass_transmittance(double cosine)
{
    const double inside = sqrt(1 - (1 - cosine * cosine) / (1.52 * 1.52));
    const double across = (cosine - 1.52 * inside) / (cosine + 1.52 * inside);
    const double along = (1.52 * cosine - inside) / (1.52 * cosine + inside);
    const double once = pow(of_glass, 1 / inside);
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const double r = i ? along * along : across * across;
        sum += (1 - r) * (1 - r) * once / (1 - r * r * once * once) / 2;
    }
    return sum;
}

/* Returns the flux through the pane, all of which falls on the work plane. */
static double flux_through(enum pane pane, const struct orl_annual_step *step)
{
    const double cosine =
        cos(step->sun_altitude_deg * ORL_DEG_TO_RAD) * cos(step->sun_azimuth_deg * ORL_DEG_TO_RAD);
    return step->direct_normal_lx * cosine * pane_m2 *
           (pane == GLASS ? glass_transmittance(cosine) : through);
}

/*
 * The flux equals that through the pane to 2 %: the patch is 1.1 m deep, and rows of sensors 5 cm
 * apart include or miss half a row. The patch of aBSDF equals that of glass to the sensor; patches
 * of BSDF cells are blurred, and larger.
 */
static void test_panes_agree(void **state)
{
    int sharp[SUNNY] = {0};
    (void)state;
    for (int pane = 0; pane < PANES; pane++) {
        struct orl_annual_result year = run_pane((enum pane)pane, "", NULL);
        for (size_t c = 0; c < SUNNY; c++) {
            const struct hour hour = sum_hour(&year, c);
            const double wanted =
                flux_through((enum pane)pane, &year.steps[year.step_of_column[c]]);
            print_message("# %s, hour %zu: %.0f lm of %.0f, %d sensors above 1000 lx\n",
                          names[pane], c, hour.flux_lm, wanted, hour.above);
            assert_true(fabs(hour.flux_lm - wanted) < 0.02 * wanted);
            if (pane == GLASS)
                sharp[c] = hour.above;
            assert_in_range(hour.above, sharp[c], pane > ABSDF ? 3 * sharp[c] : sharp[c]);
        }
        assert_true(sum_hour(&year, SUNNY).flux_lm == 0);
        orl_annual_done(&year);
    }
}

/* A black screen in front of half of the pane, outside or inside, halves the flux for any pane.
 * Rays are traced to panes that are partly hidden, or partly in the sun. */
static void test_half_a_pane(void **state)
{
    static const char *const screens[] = {
        "void plastic k 0 0 5 0 0 0 0 0\n"
        "k polygon screen 0 0 12 .9 -.004 .9 2 -.004 .9 2 -.004 2.6 .9 -.004 2.6\n",
        "void plastic k 0 0 5 0 0 0 0 0\n"
        "k polygon screen 0 0 12 .9 .004 .9 2 .004 .9 2 .004 2.6 .9 .004 2.6\n"};
    (void)state;
    for (int pane = TREE; pane < PANES; pane++)
        for (int where = 0; where < 2; where++) {
            struct orl_annual_result year = run_pane((enum pane)pane, screens[where], NULL);
            for (size_t c = 0; c < SUNNY; c++) {
                const double wanted =
                    flux_through((enum pane)pane, &year.steps[year.step_of_column[c]]) / 2;
                const double flux = sum_hour(&year, c).flux_lm;
                print_message("# %s, screen %d, hour %zu: %.0f lm of %.0f\n", names[pane], where, c,
                              flux, wanted);
                assert_true(fabs(flux - wanted) < 0.02 * wanted);
            }
            orl_annual_done(&year);
        }
}

/*
 * Sensors at heights between the pane's edges get the flux through the part above them, also for
 * half a pane. The patch is shallower than that of the whole pane, so that half a row weighs more.
 */
static void test_cut_panes(void **state)
{
    static const double heights_m[] = {1.5, 1.9}, top_m = 2.5, pane_m = 1.5;
    static const char screen[] = "void plastic k 0 0 5 0 0 0 0 0\n"
                                 "k polygon screen 0 0 12 .9 .004 .9 2 .004 .9 2 .004 2.6 .9 .004 "
                                 "2.6\n";
    (void)state;
    for (int pane = TREE; pane < PANES; pane++)
        for (int k = 0; k < 4; k++) {
            const double height_m = heights_m[k / 2], above = (top_m - height_m) / pane_m;
            const double seen = k % 2 == 0 ? above : above / 2;
            struct orl_annual_result year =
                run_at(height_m, (enum pane)pane, k % 2 == 0 ? "" : screen, NULL);
            for (size_t c = 0; c < SUNNY; c++) {
                const double wanted =
                    seen * flux_through((enum pane)pane, &year.steps[year.step_of_column[c]]);
                const double flux = sum_hour(&year, c).flux_lm;
                print_message("# %s, sensors at %.1f m, %s, hour %zu: %.0f lm of %.0f\n",
                              names[pane], height_m, k % 2 == 0 ? "clear" : "half", c, flux,
                              wanted);
                assert_true(fabs(flux - wanted) < 0.02 * wanted / above);
            }
            orl_annual_done(&year);
        }
}

/* LM-83 blinds close in the hours with sun, behind any of the panes. */
static void test_blinds_agree(void **state)
{
    char open_word[] = "open", shut_word[] = "shut", name[] = "south", pane_name[] = "pane";
    char *windows[] = {pane_name};
    struct orl_shade_state states[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    const struct orl_window_group group = {
        .name = name,
        .windows = windows,
        .n_windows = 1,
        .states = states,
        .n_states = 2,
        .control = {ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2, .state = 1}};
    (void)state;
    for (int pane = 0; pane < PANES; pane++) {
        struct orl_annual_result year = run_pane((enum pane)pane, "", &group);
        for (size_t step = 0; step < HOURS; step++)
            assert_int_equal(year.states[step], step < SUNNY);
        orl_annual_done(&year);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_panes_agree), cmocka_unit_test(test_half_a_pane),
        cmocka_unit_test(test_cut_panes), cmocka_unit_test(test_blinds_agree)};
    return cmocka_run_group_tests_name("annual_direct", tests, NULL, NULL);
}

/*
 * Skies in the job, through orl_run: an open sensor reads the value given for the sky, and a photon
 * map's key depends on the sky's numbers.
 *
 * 65536 stratified rays: the error of the sky's integral is 1e-4, that of the horizon's edge 3e-4.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/scene_text.h"

static const struct orl_sensor up_and_down[2] = {{{0, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, -1}}};

static struct orl_sky_request perez(double altitude, double direct_lx, double diffuse_lx)
{
    return (struct orl_sky_request){.model = ORL_SKY_BY_PEREZ,
                                    .sun_given = true,
                                    .sun_altitude_deg = altitude,
                                    .sun_azimuth_deg = 25,
                                    .input = ORL_SKY_NORMAL_LX,
                                    .first = direct_lx,
                                    .second = diffuse_lx,
                                    .ground_reflectance = 0.2,
                                    .turbidity = 2.45,
                                    .direct_normal_lx = -1};
}

static struct orl_sky_request cie(enum orl_sky_cie type, double diffuse_lx, double direct_lx)
{
    struct orl_sky_request request = perez(50, 0, 0);
    request.model = ORL_SKY_BY_CIE;
    request.cie_type = type;
    request.input = ORL_SKY_DIFFUSE_LX;
    request.first = diffuse_lx;
    request.direct_normal_lx = direct_lx;
    return request;
}

static void read_open(const struct orl_sky_request *sky, double ret_lx[2])
{
    const struct scene_run run = {.scene = "# nothing\n",
                                  .sky = sky,
                                  .sensors = up_and_down,
                                  .n_sensors = 2,
                                  .samples = 65536,
                                  .global = 1};
    scene_run_lx(&run, ret_lx);
}

static void assert_within(double value, double wanted, double relative)
{
    if (!(fabs(value - wanted) <= relative * wanted))
        fail_msg("%.6g is not within %.2g of %.6g", value, relative, wanted);
}

static void test_open_sensor_reads_the_input(void **state)
{
    static const double sun50 = 0.76604444311897804; /* sin 50 degrees */
    const struct {
        struct orl_sky_request sky;
        double lx;
    } cases[] = {{perez(50, 0, 10000), 10000},
                 {perez(50, 30000, 40000), 30000 * sun50 + 40000},
                 {perez(50, 85000, 12000), 85000 * sun50 + 12000},
                 {perez(12, 20000, 9000), 20000 * 0.20791169081775934 + 9000},
                 {cie(ORL_SKY_CLEAR, 12000, 80000), 80000 * sun50 + 12000},
                 {cie(ORL_SKY_INTERMEDIATE, 30000, 20000), 20000 * sun50 + 30000},
                 {cie(ORL_SKY_OVERCAST, 15000, -1), 15000},
                 {cie(ORL_SKY_UNIFORM, 10000, -1), 10000}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double lx[2];
        read_open(&cases[i].sky, lx);
        print_message("# sky %zu: %+.4f %%, ground %.4f of it\n", i,
                      100 * (lx[0] / cases[i].lx - 1), lx[1] / lx[0]);
        assert_within(lx[0], cases[i].lx, 0.002);
        /* The ground blends into the horizon's sky, which may be several times as bright. */
        assert_true(lx[1] > 0.199 * lx[0] && lx[1] < 0.215 * lx[0]);
    }
}

static void key_of(const struct scene_run *run, char ret_key[ORL_DIGEST_HEX + 1])
{
    struct orl_result result = scene_run(run);
    assert_int_equal(result.n_maps, 1);
    memcpy(ret_key, result.maps[0].key, ORL_DIGEST_HEX + 1);
    orl_result_done(&result);
}

/* Equal sky numbers share a map, however they were given; other numbers do not. */
static void test_maps_are_known_by_the_sky(void **state)
{
    static const char wea[] = "place a_b\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                              "site_elevation 0\nweather_data_file_units 1\n3 22 11.5 800 120\n";
    static const char scene[] = "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                                "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n";
    char name[] = "x.wea", keys[4][ORL_DIGEST_HEX + 1];
    struct orl_sky_request sky = perez(0, 800, 120);
    struct scene_run run = {.scene = scene,
                            .resource_name = name,
                            .resource_text = wea,
                            .sky = &sky,
                            .sensors = up_and_down,
                            .n_sensors = 2,
                            .samples = 16,
                            .global = 100};
    (void)state;
    sky.sun_given = false;
    sky.time_given = true;
    sky.month = 3;
    sky.day = 22;
    sky.hour = 11.5;
    sky.latitude_deg = 38.42;
    sky.longitude_deg = 27.14;
    sky.time_zone_h = 2;
    sky.input = ORL_SKY_NORMAL_W;
    key_of(&run, keys[0]);
    sky.model = ORL_SKY_BY_WEATHER;
    sky.weather_file = name;
    key_of(&run, keys[1]);
    assert_string_equal(keys[0], keys[1]);
    sky.ground_reflectance = 0.3;
    key_of(&run, keys[2]);
    sky.ground_reflectance = 0.2;
    sky.normalise = ORL_SKY_GENDAYLIT;
    key_of(&run, keys[3]);
    for (int i = 1; i < 4; i++)
        for (int k = i + 1; k < 4; k++)
            assert_string_not_equal(keys[i], keys[k]);
    /* Without a sky there is no light, and the plan traces none. */
    run.sky = NULL;
    struct orl_result dark = scene_run(&run);
    assert_int_equal(dark.n_maps, 0);
    orl_result_done(&dark);
}

static void test_two_skies_are_refused(void **state)
{
    const struct orl_sky_request sky = perez(40, 0, 10000);
    struct orl_error err = {0};
    (void)state;
    const struct scene_run run = {.scene =
                                      "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 180\n",
                                  .sky = &sky,
                                  .sensors = up_and_down,
                                  .n_sensors = 2};
    assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_INVALID);
    assert_string_equal(err.primitive, "sky");
}

/* A missing file, and one with a mistake in it: the error names the place. */
static void test_weather_file_mistakes(void **state)
{
    char name[] = "x.wea", other[] = "y.wea";
    struct orl_sky_request sky = {.model = ORL_SKY_BY_WEATHER,
                                  .time_given = true,
                                  .month = 1,
                                  .day = 1,
                                  .hour = 12,
                                  .weather_file = other};
    struct orl_error err = {0};
    const struct scene_run run = {.scene = "# nothing\n",
                                  .resource_name = name,
                                  .resource_text = "place a_b\nlatitude 95\n",
                                  .sky = &sky,
                                  .sensors = up_and_down,
                                  .n_sensors = 2};
    (void)state;
    assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.primitive, "sky");
    assert_non_null(strstr(err.message, "y.wea"));
    sky.weather_file = name;
    assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_RANGE);
    assert_string_equal(err.file, "x.wea");
    assert_int_equal(err.line, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_sensor_reads_the_input),
        cmocka_unit_test(test_maps_are_known_by_the_sky),
        cmocka_unit_test(test_two_skies_are_refused),
        cmocka_unit_test(test_weather_file_mistakes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

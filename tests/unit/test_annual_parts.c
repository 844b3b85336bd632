/* Components of an annual run: direction bins, binned skies, sun nodes, surface squares. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "annual/sky/hours.h"
#include "annual/sun/sun_weights.h"
#include "annual/sun_map/sun_map.h"
#include "base/sampling/sampling.h"
#include "light/daylight/daylight.h"
#include "support/scene_text.h"

static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double z = 2 * orl_random_uniform(random) - 1, turn = orl_random_uniform(random);
    const double level = sqrt(1 - z * z);
    return orl_v3(level * cos(2 * ORL_PI * turn), level * sin(2 * ORL_PI * turn), z);
}

/* The bins cover the sphere once; the upper half gives horizontal planes pi. Rows are whole bins.
 */
static void test_bins(void **state)
{
    static struct orl_bins bins;
    double solid = 0, level = 0;
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 1);
    (void)state;
    orl_bins_init(&bins);
    for (uint32_t i = 0; i < ORL_BINS; i++) {
        solid += bins.solid_sr[i];
        level += i < ORL_BINS_ABOVE ? bins.level_sr[i] : 0;
        assert_int_equal(orl_bins_find(&bins, bins.at[i]), i);
        assert_true(bins.coarse_of[i] < ORL_BINS_COARSE);
    }
    assert_true(fabs(solid - 4 * ORL_PI) < 1e-9);
    assert_true(fabs(level - ORL_PI) < 1e-9);
    /* Directions fall into bins in proportion to solid angle: a fifth of them above 0.6. */
    size_t high = 0;
    for (int i = 0; i < 100000; i++) {
        const struct orl_vec3 d = any_direction(&random);
        const uint32_t bin = orl_bins_find(&bins, d);
        const struct orl_bin_row *row = &bins.rows[bins.row_of[bin]];
        assert_true(d.z >= row->low - 1e-12 && d.z <= row->high + 1e-12);
        high += d.z > 0.6;
    }
    assert_true(fabs((double)high - 20000) < 5 * 126.5); /* binomial deviation */
}

static const char sunny[] = "place p\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                            "site_elevation 0\nweather_data_file_units 1\n"
                            "3 22 10.500 700 110\n3 22 11.500 0 210\n3 22 12.500 300 180\n"
                            "3 22 13.500 9999 9999\n3 22 23.500 0 0\n";

static struct orl_hours hours_of(const struct orl_bins *bins, const char *text, double north_deg)
{
    struct orl_weather weather = {0};
    struct orl_hours hours;
    struct orl_error err = {0};
    assert_int_equal(orl_weather_parse("w.wea", text, strlen(text), 0, &weather, &err), 0);
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    assert_int_equal(orl_hours_init(&hours, bins, &weather, "w.wea", north_deg, 0.2, pool, &err),
                     0);
    orl_thread_pool_stop(pool);
    orl_weather_done(&weather);
    return hours;
}

/*
 * A binned sky gives a horizontal plane the measured illuminance, to single precision. Each bin is
 * as bright as the pattern there: the mean over three degrees of altitude is within 3 % of the
 * middle. This excludes the horizon, where the pattern changes faster.
 */
static void test_skies(void **state)
{
    static const double diffuse_w[] = {110, 210, 180};
    static struct orl_bins bins;
    (void)state;
    orl_bins_init(&bins);
    struct orl_hours hours = hours_of(&bins, sunny, 0);
    assert_int_equal(hours.n_columns, 3);
    assert_true(hours.steps[3].missing);
    assert_int_equal(hours.n_missing, 1);
    assert_int_equal(hours.steps[3].column, ORL_ANNUAL_DARK);
    assert_false(hours.steps[4].missing);
    assert_int_equal(hours.steps[4].column, ORL_ANNUAL_DARK);
    for (uint32_t c = 0; c < 3; c++) {
        struct orl_sky_request request;
        struct orl_daylight daylight;
        struct orl_error err = {0};
        double level = 0;
        orl_sky_request_init(&request);
        request.model = ORL_SKY_BY_PEREZ;
        request.time_given = true;
        request.month = 3;
        request.day = 22;
        request.hour = 10.5 + c;
        request.latitude_deg = 38.42;
        request.longitude_deg = 27.14;
        request.time_zone_h = 2;
        request.input = ORL_SKY_NORMAL_W;
        request.first = c == 0 ? 700 : c == 1 ? 0 : 300;
        request.second = diffuse_w[c];
        assert_int_equal(orl_daylight_from_request(&request, NULL, &daylight, &err), 0);
        for (uint32_t i = 0; i < ORL_BINS; i++) {
            const double here = (double)hours.fine[(size_t)i * ORL_HOURS_TILE + c];
            const double there = orl_sky_brightness(&daylight.pattern, bins.at[i]);
            level += i < ORL_BINS_ABOVE ? here * bins.level_sr[i] : 0;
            if (fabs(bins.at[i].z) > 0.1)
                assert_true(fabs(here / there - 1) < 0.03);
        }
        const double lx = hours.steps[c].diffuse_lx;
        assert_true(fabs(ORL_EFFICACY_LM_PER_W * level / lx - 1) < 1e-4);
        assert_true(fabs(ORL_EFFICACY_LM_PER_W * orl_sky_horizontal(&daylight.pattern) / lx - 1) <
                    1e-4);
    }
    orl_hours_done(&hours);
}

/* Checks that at a node its weight is one, and elsewhere weights sum to one and reproduce linear
 * functions. */
static void check_nodes(double latitude_deg, const struct orl_vec3 *suns, size_t n,
                        double within_deg)
{
    double farthest = 1;
    struct orl_sun_grid nodes;
    const struct orl_sun_spacing steps =
        orl_sun_spacing_at(latitude_deg, (struct orl_sun_spacing){6, 15});
    assert_int_equal(orl_sun_grid_init(&nodes, latitude_deg, suns, n, steps), 0);
    for (uint32_t k = 0; k < nodes.count; k++) {
        const struct orl_sun_interpolation at = orl_sun_grid_interpolate(&nodes, nodes.at[k]);
        struct orl_vec3 there = {0, 0, 0};
        assert_true(nodes.at[k].z > -1e-9);
        for (int i = 0; i < ORL_SUN_CORNERS; i++)
            there = orl_madd(there, nodes.at[at.nodes[i]], (double)at.weights[i]);
        assert_true(orl_length(orl_sub(there, nodes.at[k])) < 1e-5);
    }
    for (size_t s = 0; s < n; s++) {
        const struct orl_sun_interpolation at = orl_sun_grid_interpolate(&nodes, suns[s]);
        struct orl_vec3 there = {0, 0, 0};
        double sum = 0;
        for (int i = 0; i < ORL_SUN_CORNERS; i++) {
            assert_true(at.nodes[i] < nodes.count);
            sum += (double)at.weights[i];
            there = orl_madd(there, nodes.at[at.nodes[i]], (double)at.weights[i]);
        }
        assert_true(fabs(sum - 1) < 1e-6);
        farthest = fmin(farthest, orl_dot(orl_normalize(there), suns[s]));
    }
    print_message("latitude %g: %zu nodes, suns within %.2f degrees\n", latitude_deg, nodes.count,
                  acos(farthest) / ORL_DEG_TO_RAD);
    assert_true(farthest > cos(within_deg * ORL_DEG_TO_RAD));
    orl_sun_grid_done(&nodes);
}

/* Suns of a year, while they are above the horizon. */
static void test_nodes(void **state)
{
    static const double latitudes[] = {38, -35, 0, 68, -80};
    (void)state;
    for (size_t l = 0; l < sizeof latitudes / sizeof *latitudes; l++) {
        struct orl_vec3 *suns = malloc(365UL * 24 * sizeof *suns);
        size_t n = 0;
        assert_non_null(suns);
        const double s = sin(latitudes[l] * ORL_DEG_TO_RAD), c = cos(latitudes[l] * ORL_DEG_TO_RAD);
        for (int day = 0; day < 365; day += 5)
            for (int hour = 0; hour < 24; hour++) {
                const double d = -0.4093 * cos(2 * ORL_PI * (day + 10) / 365.0);
                const double w = (hour + 0.5 - 12) * ORL_PI / 12;
                const struct orl_vec3 sun = {-cos(d) * sin(w), c * sin(d) - s * cos(d) * cos(w),
                                             s * sin(d) + c * cos(d) * cos(w)};
                if (sun.z > 0.01)
                    suns[n++] = sun;
            }
        /* Beyond the polar circles the middle of a cell may lie further off, where the polar day
         * ends. */
        check_nodes(latitudes[l], suns, n, fabs(latitudes[l]) > 58 ? 3 : 0.5);
        free(suns);
    }
    check_nodes(89, NULL, 0, 1); /* polar night */
}

/* The squares of a surface partition its area; each point lies in its own square. */
static void test_squares(void **state)
{
    static const char text[] = "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                               "w polygon l 0 0 18 0 0 0 3 0 0 3 1 0 1 1 0 1 2.3 0 0 2.3 0\n"
                               "w sphere ball 0 0 4 9 9 9 1\n";
    struct orl_geometry *g = scene_geometry(text);
    struct orl_sun_texels texels;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 2);
    (void)state;
    assert_int_equal(orl_sun_texels_init(&texels, g, 0.4), 0);
    for (uint32_t facet = 0; facet < g->n_facets; facet++) {
        uint64_t names[4096];
        size_t n = 0;
        double sum = 0;
        for (int i = 0; i < 200000; i++) {
            const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
            struct orl_hit hit = {.facet = facet, .front = true};
            size_t k = 0;
            orl_facet_sample(g, facet, u, &hit.point, &hit.normal);
            const uint64_t name = orl_sun_texel_of(&texels, &hit);
            while (k < n && names[k] != name)
                k++;
            if (k < n)
                continue;
            assert_true(n < 4096);
            names[n++] = name;
            sum += orl_sun_texel_area(&texels, &hit);
        }
        assert_true(fabs(sum / g->facets[facet].area - 1) < 1e-4);
    }
    orl_sun_texels_done(&texels);
    orl_geometry_free(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bins),
        cmocka_unit_test(test_skies),
        cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_squares),
    };
    return cmocka_run_group_tests_name("annual_parts", tests, NULL, NULL);
}

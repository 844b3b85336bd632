/*
 * Radiance of the sky: values of Radiance's own perezlum.cal and skybright.cal, and closed forms.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "light/daylight/daylight.h"

enum { DIRECTIONS = 8 };

static const struct orl_vec3 directions[DIRECTIONS] = {
    {0, 0, 1},       {0.6, 0, 0.8},       {0.48, -0.64, 0.6}, {-0.8, 0.6, 0.005},
    {0.28, 0.96, 0}, {0.96, 0.28, -0.02}, {0, -0.8, -0.6},    {0, 0, -1}};

static const struct {
    struct orl_sky sky;
    double brightness[DIRECTIONS];
} cases[] = {
    {{ORL_SKY_PEREZ,
      {36.81, 28.19, -0.968251, -0.21475, 15.621716, -3.920319, 0.628189, 0.080798, -0.61939,
       0.780915},
      10},
     {20.0804092, 17.9986842, 50.7882331, 35.7388596, 37.1467873, 32.5509526, 28.1900002, 28.19}},
    {{ORL_SKY_PEREZ,
      {23.7, 9.413, 0.871201, -0.476826, 1.091681, -0.710907, -0.023294, -0.571714, -0.269603,
       0.774891},
      10},
     {60.5154453, 50.316068, 48.2934422, 23.617941, 20.6351457, 18.0654926, 9.41300038, 9.413}},
    {{ORL_SKY_CIE, {1, 27.75, 29.71, 1.514, 0.005614, -0.284825, 0.958563}, 7},
     {27.7425567, 14.7002931, 17.9419812, 22.9344839, 23.2797026, 24.4390699, 29.7099998, 29.71}},
    {{ORL_SKY_CIE, {4, 17.35, 6.699, 0.9927, -0.582809, -0.527712, 0.617942}, 7},
     {17.3463637, 11.3875465, 20.103684, 12.6604455, 7.43567168, 7.10714085, 6.6990002, 6.699}},
    {{ORL_SKY_CIE, {2, 7.761, 1.811}, 3},
     {7.76099486, 6.72616549, 5.69111665, 2.27119146, 2.23748037, 2.11357807, 1.81099996, 1.811}},
    {{ORL_SKY_CIE, {3, 16.48, 3.296}, 3},
     {16.4799886, 16.4799074, 16.4790373, 10.8622691, 10.5417696, 9.22770357, 3.29600024, 3.296}},
};

static void test_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int k = 0; k < DIRECTIONS; k++) {
            const double value = orl_sky_brightness(&cases[i].sky, directions[k]);
            const double wanted = cases[i].brightness[k];
            if (fabs(value - wanted) > 1e-8 * wanted)
                fail_msg("sky %zu, direction %d: %.10g, not %.10g", i, k, value, wanted);
        }
    }
}

/* Integrates the horizontal irradiance of the upper half, by midpoints in z^2 and azimuth. */
static double horizontal(const struct orl_sky *sky)
{
    enum { ROWS = 400, COLUMNS = 200 };
    double sum = 0;
    for (int i = 0; i < ROWS; i++) {
        const double z = sqrt((i + 0.5) / ROWS), r = sqrt(1.0 - z * z);
        for (int k = 0; k < COLUMNS; k++) {
            const double phi = 2.0 * ORL_PI * (k + 0.5) / COLUMNS;
            sum += orl_sky_brightness(sky, orl_v3(r * cos(phi), r * sin(phi), z));
        }
    }
    return ORL_PI * sum / (ROWS * COLUMNS);
}

/* The ground, here as bright as the horizon, blends in above it: 0.05 % of the overcast sky. */
static void test_closed_forms(void **state)
{
    const struct orl_sky uniform = {ORL_SKY_CIE, {3, 12, 12}, 3};
    const struct orl_sky overcast = {ORL_SKY_CIE, {2, 30, 10}, 3};
    (void)state;
    assert_true(fabs(horizontal(&uniform) / (ORL_PI * 12) - 1.0) < 1e-12);
    assert_true(fabs(orl_sky_horizontal(&uniform) / (ORL_PI * 12) - 1.0) < 1e-12);
    assert_true(fabs(horizontal(&overcast) / (7.0 * ORL_PI * 30 / 9.0) - 1.0) < 1e-3);
}

/* Integrates the horizontal irradiance by angles about a sun: dense where the pattern has its
 * peak, at any altitude. */
static double horizontal_about(const struct orl_sky *sky, struct orl_vec3 sun)
{
    enum { ROWS = 3000, COLUMNS = 300 };
    const struct orl_frame f = orl_frame_about(sun);
    double sum = 0;
    for (int i = 0; i < ROWS; i++) {
        const double t = (i + 0.5) / ROWS, gamma = ORL_PI * t * t;
        double row = 0;
        for (int k = 0; k < COLUMNS; k++) {
            const double psi = 2 * ORL_PI * (k + 0.5) / COLUMNS;
            const struct orl_vec3 d =
                orl_to_world(&f, orl_v3(sin(gamma) * cos(psi), sin(gamma) * sin(psi), cos(gamma)));
            row += d.z > 0 ? orl_sky_brightness(sky, d) * d.z : 0;
        }
        sum += row * sin(gamma) * 2 * ORL_PI * t;
    }
    return 2 * ORL_PI * sum / ((double)ROWS * COLUMNS);
}

/* Sharp suns at every altitude; midpoints in altitude and azimuth had errors of 7e-3 near the
 * zenith. */
static void test_horizontal_irradiance(void **state)
{
    static const double altitudes[] = {-2, 0.3, 2, 20, 45, 70, 89.5, 90};
    (void)state;
    for (size_t i = 0; i < sizeof altitudes / sizeof *altitudes; i++) {
        const double up = altitudes[i] * ORL_DEG_TO_RAD;
        const struct orl_vec3 sun = {0.6 * cos(up), -0.8 * cos(up), sin(up)};
        const struct orl_sky skies[] = {
            {ORL_SKY_PEREZ, {1, 0, -0.9, -0.2, 24, -25, 0.3, sun.x, sun.y, sun.z}, 10},
            {ORL_SKY_PEREZ, {1, 0, -1, -0.32, 10, -3, 0.45, sun.x, sun.y, sun.z}, 10},
            {ORL_SKY_PEREZ, {30, 20, 1.35, -0.77, 0.1, -1, 0.1, sun.x, sun.y, sun.z}, 10},
            {ORL_SKY_CIE, {1, 27.75, 29.71, 1.514, sun.x, sun.y, sun.z}, 7},
            {ORL_SKY_CIE, {4, 17.35, 6.699, 0.9927, sun.x, sun.y, sun.z}, 7}};
        for (size_t k = 0; k < sizeof skies / sizeof *skies; k++) {
            const double got = orl_sky_horizontal(&skies[k]);
            const double wanted = horizontal_about(&skies[k], sun);
            if (!(fabs(got / wanted - 1) < 5e-6))
                fail_msg("sun at %g, sky %zu: off by %.2g", altitudes[i], k, got / wanted - 1);
        }
    }
}

/* Rotating the sun and the direction about the vertical together changes nothing. */
static void test_turning_sun_and_direction_together(void **state)
{
    (void)state;
    for (size_t i = 0; i < 4; i++) {
        const int at = cases[i].sky.kind == ORL_SKY_PEREZ ? 7 : 4;
        for (int k = 0; k < DIRECTIONS; k++) {
            struct orl_sky turned = cases[i].sky;
            const struct orl_vec3 d = directions[k];
            const double x = turned.a[at], before = orl_sky_brightness(&cases[i].sky, d);
            turned.a[at] = -turned.a[at + 1];
            turned.a[at + 1] = x;
            const double after = orl_sky_brightness(&turned, orl_v3(-d.y, d.x, d.z));
            assert_true(fabs(after - before) <= 1e-12 * before);
        }
    }
}

/* Nothing is negative or infinite anywhere. */
static void test_everywhere_finite(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int k = 0; k <= 20000; k++) {
            const double z = k / 10000.0 - 1.0, r = sqrt(1.0 - z * z), phi = 2.4 * k;
            const double value =
                orl_sky_brightness(&cases[i].sky, orl_v3(r * cos(phi), r * sin(phi), z));
            assert_true(isfinite(value) && value >= 0);
        }
    }
}

static void test_black_sky(void **state)
{
    const struct orl_sky black = {ORL_SKY_PEREZ, {0, 0, 0, 0, 0, 0, 0, 0.6, 0, -0.8}, 10};
    (void)state;
    for (int k = 0; k < DIRECTIONS; k++)
        assert_true(orl_sky_brightness(&black, directions[k]) == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_horizontal_irradiance),
        cmocka_unit_test(test_turning_sun_and_direction_together),
        cmocka_unit_test(test_everywhere_finite),
        cmocka_unit_test(test_black_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Hours of sun at points, compared with the length of days above an altitude. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include <oriel/annual/annual.h>
#include <oriel/annual/sun_exposure.h>

#define LATITUDE 38.42
#define STONE "void plastic w 0 0 5 0 0 0 0 0\nw sphere stone 0 0 4 0 0 -50 .1\n"
#define BOX(m)                                                                                     \
    m " polygon a 0 0 12 -1 -1 -1 1 -1 -1 1 -1 1 -1 -1 1\n" m                                      \
      " polygon b 0 0 12 -1 1 -1 1 1 -1 1 1 1 -1 1 1\n" m                                          \
      " polygon c 0 0 12 -1 -1 -1 -1 1 -1 -1 1 1 -1 -1 1\n" m                                      \
      " polygon d 0 0 12 1 -1 -1 1 1 -1 1 1 1 1 -1 1\n" m                                          \
      " polygon e 0 0 12 -1 -1 1 1 -1 1 1 1 1 -1 1 1\n"
/* In front of the point: an endless wall in the west; and the equivalent wall for rotated north. */
#define WALL_WEST "w polygon wall 0 0 12 -.1 -1e5 -1e5 -.1 1e5 -1e5 -.1 1e5 1e5 -.1 -1e5 1e5\n"
#define WALL_SOUTH "w polygon wall 0 0 12 -1e5 -.1 -1e5 1e5 -.1 -1e5 1e5 -.1 1e5 -1e5 -.1 1e5\n"
/* A roof above the point that ends in the south at a profile angle of 36 degrees, and covers higher
 * angles. */
#define ROOF "w polygon roof 0 0 12 -1e5 1e5 1 1e5 1e5 1 1e5 -1.37638 1 -1e5 -1.37638 1\n"

struct site {
    const char *scene;
    double latitude_deg, north_deg, least_altitude_deg;
    double longitude_deg; /* 0: 27.14 */
    enum orl_sun_method sun_method;
};

static double no_clock(void *ctx)
{
    (void)ctx;
    return 0;
}

static struct orl_exposure expose(const struct site *site)
{
    static char scene_name[] = "scene.rad", point_name[] = "p";
    static char *scene_names[] = {scene_name};
    static const char *const names[] = {scene_name};
    const struct orl_file contents[] = {{site->scene, strlen(site->scene), NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    atomic_bool cancel = false;
    const struct orl_run_env env = {
        .pool = orl_thread_pool_start(2), .files = &files, .cancel = &cancel, .now_s = no_clock};
    const struct orl_annual_request request = {.scene_files = scene_names,
                                               .n_scene_files = 1,
                                               .north_deg = site->north_deg,
                                               .sun_method = site->sun_method};
    struct orl_named_point point = {point_name, {0, 0, 0}};
    const struct orl_exposure_request exposure_request = {&point, 1, site->least_altitude_deg};
    const struct orl_annual_site place = {
        site->latitude_deg, site->longitude_deg != 0 ? site->longitude_deg : 27.14, 2};
    struct orl_exposure exposure = {0};
    struct orl_error err = {0};
    if (orl_exposure_compute(&exposure_request, &place, &request, &env, &exposure, &err) < 0)
        fail_msg("%s", err.message);
    orl_thread_pool_stop(env.pool);
    return exposure;
}

/* Returns the declination at noon of a day of 2017, by the Astronomical Almanac's low-precision
 * formulas, accurate to 0.01 degrees. */
static double declination_of(int day_of_year)
{
    const double n = 2457754.5 + day_of_year - 1 + 10.3 / 24 - 2451545;
    const double anomaly = (357.528 + 0.9856003 * n) * ORL_DEG_TO_RAD;
    const double longitude =
        280.460 + 0.9856474 * n + 1.915 * sin(anomaly) + 0.020 * sin(2 * anomaly);
    return asin(sin((23.439 - 4e-7 * n) * ORL_DEG_TO_RAD) * sin(longitude * ORL_DEG_TO_RAD));
}

/* Returns the hours of a day with the sun above an altitude: from its hour angle there, with noon's
 * declination all day. */
static double day_hours(double latitude_deg, int day_of_year, double altitude_deg)
{
    const double declination = declination_of(day_of_year);
    const double latitude = latitude_deg * ORL_DEG_TO_RAD;
    const double cosine = (sin(altitude_deg * ORL_DEG_TO_RAD) - sin(latitude) * sin(declination)) /
                          (cos(latitude) * cos(declination));
    return 24 / ORL_PI * acos(fmax(-1, fmin(1, cosine)));
}

/* Minutes count by their middles: each end of a day is off by at most half a minute. Between both
 * ends the equation of time changes by up to 10 s. */
static const double minute = (1.001 + 10.0 / 60) / 60;

static void test_open_ground(void **state)
{
    static const struct {
        double altitude;
        enum orl_exposure_level level;
    } cases[] = {{0, ORL_EXPOSED_HIGH},     {40, ORL_EXPOSED_HIGH}, {45, ORL_EXPOSED_MEDIUM},
                 {49, ORL_EXPOSED_MINIMUM}, {51, ORL_EXPOSED_NONE}, {60, ORL_EXPOSED_NONE}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_exposure e =
            expose(&(struct site){STONE, LATITUDE, 0, cases[i].altitude, 0, ORL_SUN_ACCURATE});
        const double hours = day_hours(LATITUDE, 80, cases[i].altitude);
        assert_true(fabs(e.hours - hours) < minute);
        assert_true(fabs(e.last_day_hours - hours) < minute);
        assert_int_equal(e.level, cases[i].level);
        if (hours > 0)
            assert_true(e.month == 3 && e.day == 21);
    }
}

/* Helsinki: in March with a horizon of 28.2 degrees the sun is above it around noon: 2.70 h by its
 * true position, 2.10 h by the fit that Radiance's programs use. */
static void test_helsinki(void **state)
{
    const struct site helsinki = {STONE, 60.17, 0, 28.2, 24.94, ORL_SUN_ACCURATE};
    struct site radiance = helsinki;
    (void)state;
    radiance.sun_method = ORL_SUN_RADIANCE;
    const struct orl_exposure accurate = expose(&helsinki), fit = expose(&radiance);
    assert_true(fabs(accurate.last_day_hours - 2.70) < 0.005);
    assert_true(fabs(accurate.last_day_hours - day_hours(60.17, 80, 28.2)) < minute);
    assert_int_equal(accurate.level, ORL_EXPOSED_MINIMUM);
    assert_true(fabs(fit.last_day_hours - 2.10) < 0.005);
}

/* In the south spring is in September, and the last day is the 21st. */
static void test_south(void **state)
{
    const struct orl_exposure e =
        expose(&(struct site){STONE, -LATITUDE, 0, 0, 0, ORL_SUN_ACCURATE});
    (void)state;
    assert_true(e.month == 9 && e.day == 21);
    assert_true(fabs(e.hours - day_hours(-LATITUDE, 264, 0)) < minute);
}

/*
 * The wall hides half of the day, since the sun is in the east until noon; also with rotated north.
 */
static void test_wall(void **state)
{
    const double half = day_hours(LATITUDE, 80, 0) / 2;
    const struct orl_exposure plain =
        expose(&(struct site){STONE WALL_WEST, LATITUDE, 0, 0, 0, ORL_SUN_ACCURATE});
    const struct orl_exposure turned =
        expose(&(struct site){STONE WALL_SOUTH, LATITUDE, 90, 0, 0, ORL_SUN_ACCURATE});
    (void)state;
    assert_true(fabs(plain.last_day_hours - half) < minute);
    assert_true(fabs(turned.last_day_hours - half) < minute);
}

/* Tinted glass counts as open, paper does not. */
static void test_panes(void **state)
{
    const struct orl_exposure glass = expose(&(struct site){
        "void glass g 0 0 3 .1 .1 .1\n" BOX("g"), LATITUDE, 0, 0, 0, ORL_SUN_ACCURATE});
    const struct orl_exposure paper = expose(&(struct site){
        "void trans t 0 0 7 .8 .8 .8 0 0 .7 .5\n" BOX("t"), LATITUDE, 0, 0, 0, ORL_SUN_ACCURATE});
    (void)state;
    assert_true(fabs(glass.hours - day_hours(LATITUDE, 80, 0)) < minute);
    assert_true(paper.hours == 0 && paper.level == ORL_EXPOSED_NONE);
}

/* At the equinox the sun moves along a plane of 90 degrees less the latitude, 52, which the roof
 * covers; on the first of February it stays below 35. The reported day is one of those before. */
static void test_roof(void **state)
{
    const struct orl_exposure e =
        expose(&(struct site){STONE ROOF, LATITUDE, 0, 0, 0, ORL_SUN_ACCURATE});
    (void)state;
    assert_true(e.last_day_hours < 0.5);
    assert_true(e.month == 2);
    assert_true(e.hours > day_hours(LATITUDE, 32, 0) - minute);
    assert_true(e.hours < day_hours(LATITUDE, 59, 0) + minute);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_ground), cmocka_unit_test(test_south),
        cmocka_unit_test(test_helsinki),    cmocka_unit_test(test_wall),
        cmocka_unit_test(test_panes),       cmocka_unit_test(test_roof),
    };
    return cmocka_run_group_tests_name("sun_exposure", tests, NULL, NULL);
}

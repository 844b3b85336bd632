/*
 * Skies that jobs request: delivered flux against the request, by a quadrature of the test's own;
 * values of Radiance's programs; refusals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "light/daylight/daylight.h"
#include "support/scene_text.h"

static const double efficacy = ORL_EFFICACY_LM_PER_W;

static struct orl_sky_request request_at(double altitude, double azimuth)
{
    return (struct orl_sky_request){.model = ORL_SKY_BY_PEREZ,
                                    .sun_given = true,
                                    .sun_altitude_deg = altitude,
                                    .sun_azimuth_deg = azimuth,
                                    .ground_reflectance = 0.2,
                                    .turbidity = 2.45,
                                    .direct_normal_lx = -1};
}

/* Returns a request for about noon at an eastern site, as a document would have it. */
static struct orl_sky_request request_by_time(void)
{
    struct orl_sky_request request = request_at(0, 0);
    request.sun_given = false;
    request.time_given = true;
    request.month = 3;
    request.day = 22;
    request.hour = 11.5;
    request.latitude_deg = 38.42;
    request.longitude_deg = 27.14;
    request.time_zone_h = 2;
    return request;
}

static struct orl_daylight find_daylight(const struct orl_sky_request *request)
{
    struct orl_daylight daylight = {0};
    struct orl_error err = {0};
    if (orl_daylight_check(request, &err) < 0 ||
        orl_daylight_from_request(request, NULL, &daylight, &err) < 0)
        fail_msg("%s", err.message);
    return daylight;
}

/* Integrates the sky's horizontal illuminance, by midpoints of equal flux: z^2 and azimuth. */
static double sky_lx(const struct orl_daylight *daylight)
{
    enum { ROWS = 1600, COLUMNS = 720 };
    double sum = 0;
    for (int i = 0; i < ROWS; i++) {
        const double z = sqrt((i + 0.5) / ROWS), r = sqrt(1.0 - z * z);
        for (int k = 0; k < COLUMNS; k++) {
            const double phi = 2.0 * ORL_PI * (k + 0.25) / COLUMNS;
            const struct orl_vec3 d = {r * cos(phi), r * sin(phi), z};
            sum += orl_sky_brightness(&daylight->pattern, d);
        }
    }
    return efficacy * ORL_PI * sum / ((double)ROWS * COLUMNS);
}

static double sun_normal_lx(const struct orl_daylight *daylight)
{
    const double half = 0.5 * daylight->sun_angle_deg * ORL_DEG_TO_RAD;
    return efficacy * daylight->sun_radiance * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

static void assert_near(double value, double wanted, double relative, const char *what)
{
    if (!(fabs(value - wanted) <= relative * fabs(wanted)))
        fail_msg("%s: %.8g, not %.8g (off by %.3g)", what, value, wanted, value / wanted - 1);
}

/* Checks each term of the budget: sky, sun, and ground lit by both. */
static double check_flux(const struct orl_sky_request *request, double diffuse_lx,
                         double direct_normal_lx, const char *what)
{
    const struct orl_daylight d = find_daylight(request);
    const int ground_at = d.pattern.kind == ORL_SKY_PEREZ ? 1 : 2;
    const double got = sky_lx(&d);
    const double total = diffuse_lx + direct_normal_lx * fmax(d.sun.z, 0);
    assert_near(got, diffuse_lx, 1e-4, what);
    assert_near(sun_normal_lx(&d), direct_normal_lx, 1e-9, what);
    assert_near(d.pattern.a[ground_at] * ORL_PI * efficacy, request->ground_reflectance * total,
                1e-9, what);
    return fabs(got / diffuse_lx - 1);
}

/*
 * From overcast to clear, the sun from low to high: every bin of the model delivers its flux. A
 * strong sun near the horizon is outside the model: such a sky is simplified with a warning, and
 * still delivers.
 */
static void test_perez_delivers_its_flux(void **state)
{
    static const double altitudes[] = {3, 10, 30, 50, 70, 86},
                        directs[] = {0, 2000, 10000, 30000, 60000, 90000};
    double worst = 0;
    int beyond = 0;
    (void)state;
    for (size_t i = 0; i < 6; i++) {
        for (size_t k = 0; k < 6; k++) {
            char what[80];
            struct orl_sky_request request = request_at(altitudes[i], 17 * (double)(i + k) - 60);
            request.input = ORL_SKY_NORMAL_LX;
            request.first = directs[k];
            request.second = 12000;
            snprintf(what, sizeof what, "altitude %g, direct %g", altitudes[i], directs[k]);
            const struct orl_daylight d = find_daylight(&request);
            if (strstr(d.warnings, "no valid values here")) {
                assert_true(altitudes[i] == 3 && directs[k] >= 30000);
                beyond++;
            }
            worst = fmax(worst, check_flux(&request, 12000, directs[k], what));
        }
    }
    assert_in_range(beyond, 1, 3);
    print_message("# Perez: at most %.4f %% off\n", 100 * worst);
}

static void test_cie_delivers_its_flux(void **state)
{
    static const double altitudes[] = {5, 20, 45, 80};
    double worst = 0;
    (void)state;
    for (int type = ORL_SKY_CLEAR; type <= ORL_SKY_INTERMEDIATE; type++) {
        for (size_t i = 0; i < 4; i++) {
            char what[80];
            struct orl_sky_request request = request_at(altitudes[i], 30);
            const bool even = type == ORL_SKY_OVERCAST || type == ORL_SKY_UNIFORM;
            request.model = ORL_SKY_BY_CIE;
            request.cie_type = (enum orl_sky_cie)type;
            request.input = ORL_SKY_DIFFUSE_LX;
            request.first = 15000;
            request.direct_normal_lx = even ? -1 : 70000;
            snprintf(what, sizeof what, "type %d, altitude %g", type, altitudes[i]);
            worst = fmax(worst, check_flux(&request, 15000, even ? 0 : 70000, what));
        }
    }
    print_message("# CIE: at most %.4f %% off\n", 100 * worst);
}

/* A given zenith luminance is kept for any flux. */
static void test_zenith_stays(void **state)
{
    struct orl_sky_request request = request_at(0, 0);
    (void)state;
    request.sun_given = false;
    request.model = ORL_SKY_BY_CIE;
    request.cie_type = ORL_SKY_OVERCAST;
    request.input = ORL_SKY_ZENITH_CD_M2;
    request.first = 5000;
    const struct orl_daylight d = find_daylight(&request);
    assert_near(efficacy * orl_sky_brightness(&d.pattern, orl_v3(0, 0, 1)), 5000, 1e-5, "zenith");
    /* 7 pi / 9 of it, minus the loss by the blend with the ground. */
    assert_near(sky_lx(&d), 5000 * 7 * ORL_PI / 9, 5e-3, "flux");
    assert_near(efficacy * ORL_PI * d.pattern.a[2], 0.2 * sky_lx(&d), 1e-4, "ground");
}

/* The gendaylit mode returns gendaylit's own values, and reports the flux they lose. */
static void test_gendaylit_mode(void **state)
{
    struct orl_sky_request request = request_by_time();
    (void)state;
    request.first = 800;
    request.second = 120;
    request.sun_method = ORL_SUN_RADIANCE; /* then only the quadratures differ */
    const struct orl_daylight flux = find_daylight(&request);
    request.normalise = ORL_SKY_GENDAYLIT;
    const struct orl_daylight same = find_daylight(&request);
    struct orl_parsed_scene text =
        scene_parse_text("!gendaylit 3 22 11.5 -a 38.42 -o -27.14 -m -30 -W 800 120\n"
                         "skyfunc glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n",
                         NULL, NULL);
    assert_int_equal(text.n_skies, 1);
    for (int i = 0; i < 10; i++)
        assert_true(fabs(text.skies[0].a[i] - same.pattern.a[i]) <=
                    5.1e-4 * fabs(same.pattern.a[i]) + 6e-7);
    assert_near(text.materials[text.distant_sources[0].material].color.g, same.sun_radiance, 5.1e-4,
                "sun");
    assert_true(orl_dot(text.distant_sources[0].direction, same.sun) > 1 - 1e-10);
    orl_parsed_scene_done(&text);
    const double lost = 1 - sky_lx(&same) / sky_lx(&flux);
    print_message("# gendaylit's quadrature loses %.2f %%\n", 100 * lost);
    assert_true(lost > 0.005 && lost < 0.03);
    assert_true(same.sun_radiance == flux.sun_radiance);
}

/* Longitude is positive east of Greenwich; a wrong sign gives a warning. */
static void test_longitude_is_east(void **state)
{
    struct orl_sky_request request = request_by_time();
    (void)state;
    request.first = 800;
    request.second = 120;
    /* At 27.14 E and 38.42 N, GMT + 2, solar noon is at 12 h 18 min that day; before it, the sun
     * is in the east. */
    request.hour = 12.2;
    assert_true(find_daylight(&request).sun.x > 0);
    request.hour = 12.4;
    const struct orl_daylight after = find_daylight(&request);
    assert_true(after.sun.x < 0);
    assert_true(after.warnings[0] == '\0');
    request.longitude_deg = -27.14;
    assert_non_null(strstr(find_daylight(&request).warnings, "time zone differ by"));
}

static void test_black_skies_say_so(void **state)
{
    struct orl_sky_request request = request_by_time();
    struct orl_daylight d;
    (void)state;
    request.first = 800;
    request.second = 120;
    request.hour = 1.5;
    d = find_daylight(&request);
    assert_true(d.black && strstr(d.warnings, "horizon"));
    request.hour = 11.5;
    request.first = request.second = 0;
    d = find_daylight(&request);
    assert_true(d.black && strstr(d.warnings, "black"));
    request = request_at(-10, 0);
    request.model = ORL_SKY_BY_CIE;
    request.cie_type = ORL_SKY_CLEAR;
    request.input = ORL_SKY_DIFFUSE_LX;
    request.first = 1000;
    d = find_daylight(&request);
    assert_true(d.black && strstr(d.warnings, "horizon"));
}

/*
 * Sunset by the clock, in steps of 2 s; the disc takes some 80 s. The irradiance facing the sun
 * falls to zero without a jump, and the sky gives light until then.
 */
static void test_sunset(void **state)
{
    struct orl_sky_request request = request_by_time();
    double before = 20000, most = 0;
    int partial = 0, lit = 0;
    (void)state;
    request.input = ORL_SKY_NORMAL_LX;
    request.first = 20000;
    request.second = 0;
    for (int i = 0; i < 300; i++) {
        request.hour = 18.32 + i / 1800.0; /* noon is at 12.3 h, half the day 6.1 h long */
        const struct orl_daylight d = find_daylight(&request);
        const double lx = d.black ? 0 : sun_normal_lx(&d);
        assert_true(lx <= before * (1 + 1e-9));
        assert_true(d.black == (lx == 0) && d.black == (d.warnings[0] != '\0'));
        most = fmax(most, before - lx);
        partial += lx > 0 && lx < 19999;
        lit += lx > 0;
        before = lx;
    }
    assert_in_range(partial, 70, 100);
    assert_in_range(lit, partial + 1, 299);
    assert_true(most < 20000 * 2.0 / 60); /* the disc's widest part, 4 / pi of its mean */
}

/* A weather row uses its own hour, site and measurements; from the request only the date. */
static void test_weather_row_is_a_perez_sky(void **state)
{
    static const char epw[] =
        "LOCATION,a,b,c,d,e,38.42,27.14,2.0,25\nDATA PERIODS,1,1,Data,Sunday,1/1,12/31\n"
        "0,3,22,12,0,f,0,0,0,0,0,0,0,0,800,120,0\n0,3,22,13,0,f,0,0,0,0,0,0,0,0,9999,120,0\n"
        "0,3,22,14,0,f,0,0,0,0,0,0,0,0,1500,120,0\n0,3,22,15,0,f,0,0,0,0,0,0,0,0,-5,120,0\n";
    struct orl_sky_request asked = request_by_time(), perez = request_by_time();
    struct orl_weather weather;
    struct orl_daylight a = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_weather_parse("x", epw, strlen(epw), 0, &weather, &err), 0);
    asked.model = ORL_SKY_BY_WEATHER;
    asked.latitude_deg = asked.longitude_deg = asked.time_zone_h = 0;
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), 0);
    perez.first = 800;
    perez.second = 120;
    const struct orl_daylight b = find_daylight(&perez);
    assert_memory_equal(a.pattern.a, b.pattern.a, sizeof a.pattern.a);
    assert_true(a.sun_radiance == b.sun_radiance && a.warnings[0] == '\0');
    asked.hour = 11.3; /* the same row, with a warning */
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), 0);
    assert_memory_equal(a.pattern.a, b.pattern.a, sizeof a.pattern.a);
    assert_non_null(strstr(a.warnings, "hour 11.5"));
    asked.hour = 12.5; /* not measured */
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 4);
    asked.hour = 13.5; /* more than the solar constant */
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 5);
    assert_non_null(strstr(err.hint, "W/m2"));
    asked.hour = 14.5;
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), 0);
    assert_non_null(strstr(a.warnings, "negative"));
    asked.day = 23;
    assert_int_equal(orl_daylight_from_request(&asked, &weather, &a, &err), ORL_ERR_NOT_FOUND);
    orl_weather_done(&weather);
}

/* Direct normal irradiance that a program got by dividing by the sine of a low sun: the row is
 * accepted with the solar constant as the limit, and a warning. */
static void test_too_much_of_a_low_sun(void **state)
{
    static const char *const values[] = {"9998", "1367"};
    struct orl_sky_request asked = request_by_time();
    struct orl_daylight skies[2] = {0};
    (void)state;
    asked.model = ORL_SKY_BY_WEATHER;
    asked.hour = 6.5;
    for (int i = 0; i < 2; i++) {
        struct orl_weather weather;
        struct orl_error err = {0};
        char epw[200];
        const int n = snprintf(epw, sizeof epw,
                               "LOCATION,a,b,c,d,e,38.42,27.14,2.0,25\nDATA PERIODS,1,1,Data\n"
                               "0,3,22,7,0,f,0,0,0,0,0,0,0,0,%s,20,0\n",
                               values[i]);
        assert_int_equal(orl_weather_parse("x", epw, (size_t)n, 0, &weather, &err), 0);
        if (orl_daylight_from_request(&asked, &weather, &skies[i], &err) < 0)
            fail_msg("%s", err.message);
        orl_weather_done(&weather);
    }
    assert_true(skies[0].sun_radiance > 0 && skies[0].sun.z < 0.1);
    assert_true(skies[0].sun_radiance == skies[1].sun_radiance);
    assert_non_null(strstr(skies[0].warnings, "line 3 of the weather file: 9998 W/m2"));
    assert_null(strstr(skies[1].warnings, "low sun"));
}

static void test_scene_with_a_sky_is_refused(void **state)
{
    struct orl_sky_request request = request_at(40, 0);
    struct orl_error err = {0};
    (void)state;
    request.first = 500;
    request.second = 100;
    const struct orl_daylight d = find_daylight(&request);
    struct orl_lit_scene *taken = build_lit_scene(
        "void glow g 0 0 4 1 1 1 0\ng source heaven 0 0 4 0 0 1 180\n", NULL, NULL, NULL);
    struct orl_lit_scene *free_one = build_lit_scene("# nothing\n", NULL, NULL, NULL);
    struct orl_lights *lights = NULL;
    assert_int_equal(orl_lights_new(taken->scene, &d, &lights, &err), ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "heaven"));
    assert_null(lights);
    assert_int_equal(orl_lights_new(free_one->scene, &d, &lights, &err), 0);
    assert_int_equal(lights->n_suns, 1);
    assert_int_equal(lights->n_domes, 2);
    assert_true(fabs(lights->suns[0].cos_half_angle - cos(0.5 * 0.533 * ORL_DEG_TO_RAD)) < 1e-12);
    orl_lights_release(lights);
    orl_lit_scene_free(taken);
    orl_lit_scene_free(free_one);
}

static void test_bad_requests(void **state)
{
    struct orl_sky_request r[16];
    size_t n = 0;
    (void)state;
    for (size_t i = 0; i < 16; i++) {
        r[i] = request_by_time();
        r[i].first = 800;
        r[i].second = 120;
    }
    r[n++].latitude_deg = 91;
    r[n++].longitude_deg = NAN;
    r[n++].time_zone_h = 120;
    r[n++].hour = 24;
    r[n++].month = 13;
    r[n++].day = 32;
    r[n++].first = 1400;
    r[n++].second = -1;
    r[n++].ground_reflectance = 1.1;
    r[n++].sun_given = true;
    r[n++].time_given = false;
    r[n++].input = ORL_SKY_TYPICAL;
    r[n++].input = ORL_SKY_INDICES;
    r[n++].model = ORL_SKY_BY_WEATHER;
    r[n++].model = ORL_SKY_BY_CIE; /* no type given */
    r[n].month = 4;
    r[n++].day = 31;
    for (size_t i = 0; i < n; i++) {
        struct orl_error err = {0};
        const int code = orl_daylight_check(&r[i], &err);
        if (code != ORL_ERR_RANGE && code != ORL_ERR_INVALID)
            fail_msg("request %zu: code %d", i, code);
        assert_string_equal(err.primitive, "sky");
    }
}

/* If glows overlap, the first shines; a light hides them; lights add up. Values as rtrace's. */
static void test_sources_over_one_another(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene("void glow a 0 0 4 1 1 1 0\nvoid glow b 0 0 4 2 2 2 0\n"
                        "void light l 0 0 3 4 4 4\n"
                        "a source up 0 0 4 0 0 1 180\nb source all 0 0 4 0 0 1 360\n"
                        "l source x 0 0 4 1 0 0 60\nl source y 0 0 4 1 1 0 60\n",
                        NULL, NULL, NULL);
    static const struct {
        struct orl_vec3 direction;
        double radiance;
    } seen[] = {{{0, 0, 1}, 1},      {{0, -.8, .6}, 1},  {{0, 0, -1}, 2},   {{0, -.8, -.6}, 2},
                {{.96, -.28, 0}, 4}, {{.28, .96, 0}, 4}, {{.96, .28, 0}, 8}};
    (void)state;
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++)
        assert_true(orl_lit_scene_dome_radiance(lit_scene, seen[i].direction).g ==
                    seen[i].radiance);
    orl_lit_scene_free(lit_scene);
}

/* A glow of negative radius is only visible directly; it is dark for all else, and hides what lies
 * behind it. rtrace -I: 0 lx if it comes first, 562.3 lx (179 pi) if it comes second. */
static void test_glows_that_light_nothing(void **state)
{
    static const char *const scenes[] = {
        "void glow a 0 0 4 2 2 2 -1\nvoid glow b 0 0 4 1 1 1 0\n"
        "a source x 0 0 4 0 0 1 180\nb source y 0 0 4 0 0 1 360\n",
        "void glow a 0 0 4 2 2 2 -1\nvoid glow b 0 0 4 1 1 1 0\n"
        "b source y 0 0 4 0 0 1 180\na source x 0 0 4 0 0 1 360\n"};
    static const double lit[2][2] = {{0, 1}, {1, 0}}, seen[2][2] = {{2, 1}, {1, 2}};
    const struct orl_vec3 ways[2] = {{0, .6, .8}, {0, .6, -.8}};
    (void)state;
    for (int s = 0; s < 2; s++) {
        struct orl_lit_scene *lit_scene = build_lit_scene(scenes[s], NULL, NULL, NULL);
        for (int i = 0; i < 2; i++) {
            assert_true(orl_lit_scene_dome_radiance(lit_scene, ways[i]).g == lit[s][i]);
            assert_true(orl_lit_scene_dome_seen(lit_scene, ways[i]).g == seen[s][i]);
        }
        orl_lit_scene_free(lit_scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_perez_delivers_its_flux),
        cmocka_unit_test(test_cie_delivers_its_flux),
        cmocka_unit_test(test_zenith_stays),
        cmocka_unit_test(test_gendaylit_mode),
        cmocka_unit_test(test_longitude_is_east),
        cmocka_unit_test(test_black_skies_say_so),
        cmocka_unit_test(test_sunset),
        cmocka_unit_test(test_weather_row_is_a_perez_sky),
        cmocka_unit_test(test_too_much_of_a_low_sun),
        cmocka_unit_test(test_scene_with_a_sky_is_refused),
        cmocka_unit_test(test_bad_requests),
        cmocka_unit_test(test_sources_over_one_another),
        cmocka_unit_test(test_glows_that_light_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The function language: names that files rely on, names of rays, and noise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "function/function.h"
#include "support/function_text.h"

/* Values of these names in Radiance's own standard file, by rcalc. */
static void test_standard_names(void **state)
{
    static const struct {
        const char *expression;
        double value;
    } rows[] = {
        {"-2^2", 4},
        {"2^3^2", 512},
        {"2^-1", .5},
        {"2*-3", -6},
        {"select(0, 1, 2, 3)", 3},
        {"select(1.5, 1, 2, 3)", 2},
        {"if(0, 1, 2)", 2},
        {"if(1e-9, 1, 2)", 1},
        {"rand(1)", .35008305980591103},
        {"rand(1e10)", .12742023584723938},
        {"ceil(-.5) + floor(-.5)", -1},
        {"sin(1, 2)", .8414709848078965},
        {"erf(.5) + erfc(.5)", 1},
        {"PI", 3.141592653589793},
        {"DEGREE", .017453292519943295},
        {"bound(1,5,3) + bound(3,2,5) + bound(1,2,5)", 8},
        {"Acos(2) + Asin(-2)", -1.5707963267948966},
        {"Exp(-400) + Exp(100)", 2.6881171418161356e43},
        {"Sqrt(-1) + Atan2(0,0)", 0},
        {"and(-2,3)", -2},
        {"or(-2,-3)", -3},
        {"not(0)", 1},
        {"xor(2,3) + 10*xor(2,-3) + 100*xor(-2,3) + 1000*xor(-2,-3)", -2691},
        {"inside(0,2,50)", 48},
        {"sgn(-3) + abs(-3) + sq(3)", 11},
        {"mod(-7,3) + mod(7,-3)", 0},
        {"tri(5,3) + 10*tri(4,3) + 100*tri(-1,3) + 1000*tri(6.5,3)", 621},
        {"frac(-.3)", .7},
        {"linterp(2,0,1)", 2},
        {"grey(1,0,0) - clipgrey(9,9,9) + clip(-1) + noneg(-1)", .265074126 - 1},
        {"fade(1,2,3) + 10*fade(5,2,1) + 100*fade(1,2,20)", 236.9},
        {"hermite(1,2,3,4,.3)", 1.405},
        {"bezier(1,2,3,5,.3)", 1.927},
        {"bspline(1,2,3,5,.3)", 2.3044999999999995},
        {"nrand(3)", -.47186979401774476},
        {"unif2norm(.001)", -3.090522225780171},
        {"A2 + AC + arg(0)", 12},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        function_check_near(rows[i].expression, function_value("", rows[i].expression, NULL, NULL),
                            rows[i].value);
}

/* Names of vectors: the plane's coordinates, the local frame (rcalc, with the same normal and
 * rays). */
static void test_ray_names(void **state)
{
    static const struct {
        const char *expression;
        double value;
    } rows[] = {
        {"U", .4065040650406504}, {"V", 2.008130081300813}, {"D(1) + N(2) + P(3)", 5.7},
        {"Ldx(1,2,3)", .9210050}, {"Ldy(1,2,3)", .4378924}, {"Ldz(1,2,3)", 3.6},
        {"Idx", .8831872},        {"Idy", -.0765024},
    };
    double inputs[ORL_RAY_INPUTS] = {.1, .2, -.97, .48, .6, .64, 2, 3, 5};
    const char *const up = "A1 = .1; arg(i) = select(i+1, 5, 9, 9, .1, .2, 2); AC = 5;"
                           "upward`P.(i) = arg(2+i);";
    (void)state;
    inputs[ORL_RAY_NXP] = .48;
    inputs[ORL_RAY_NYP] = .6;
    inputs[ORL_RAY_NZP] = .64;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double value = function_value(up, rows[i].expression, inputs, NULL);
        if (!(fabs(value - rows[i].value) < 1e-6))
            fail_msg("%s is %.9g, not %.9g", rows[i].expression, rows[i].value, value);
    }
}

/* Returns the value of a standard file's name at a place of the ray. */
static double value_of(const char *file, const char *expression, const double *arguments,
                       size_t n_arguments, const double inputs[ORL_RAY_INPUTS])
{
    struct orl_functions *const set = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    struct orl_function *function = NULL;
    struct orl_function_request request = {.expressions = &expression,
                                           .n_expressions = 1,
                                           .arguments = arguments,
                                           .n_arguments = n_arguments};
    double value = 0;
    assert_int_equal(orl_functions_load(set, NULL, file, false, &request.context, NULL), 0);
    assert_int_equal(orl_function_compile(set, &request, &function, NULL), 0);
    orl_function_at(function, function_scratch, inputs, &value);
    orl_function_free(function);
    orl_functions_free(set);
    return value;
}

/* Our own texts of standard files against the values of Radiance's (rcalc, 9 digits). */
static void test_standard_files(void **state)
{
    static const struct {
        const char *file, *expression;
        double inputs[9], arguments[10], value; /* D, N, P; 9 digits */
    } rows[] = {
        {"skybright.cal",
         "skybr",
         {.3, .4, .866025403784},
         {1, 10, 3, .7, .2, .5, .842614977},
         34.6577373},
        {"skybright.cal", "skybr", {.7, .7, .1414}, {1, 10, 3, .7, .2, .5, .842614977}, 20.9197407},
        {"skybright.cal", "skybr", {.1, 0, -.05}, {4, 10, 3, .7, .2, .5, .842614977}, 4.0746111},
        {"skybright.cal",
         "skybr",
         {-.2, -.6, .7745966692},
         {4, 10, 3, .7, .2, .5, .842614977},
         5.65039451},
        {"skybright.cal", "skybr", {.7, .7, .1414}, {2, 10, 3}, 4.20419225},
        {"skybright.cal", "skybr", {0, 1, 0}, {3, 10, 3}, 6.84711674},
        {"perezlum.cal",
         "skybright",
         {.3, .4, .001},
         {1.5, 4, .9, -.3, 6, -2.5, .4, .2, .5, .842614977},
         2.82661625},
        {"perezlum.cal",
         "skybright",
         {.7, .7, .1414},
         {1.5, 4, .9, -.3, 6, -2.5, .4, .2, .5, .842614977},
         2.97944582},
        {"perezlum.cal",
         "intersky",
         {0, 1, 0},
         {1.5, 4, .9, -.3, 6, -2.5, .4, .2, .5, .842614977},
         2.30654155},
        {"illum.cal", "il_azi", {.3, -.4, .001}, {.8, .6, 0, -.6, .8, 0, 0, 0, 1}, 5.35589009},
        {"illum.cal", "il_alth", {.3, .4, .866025403784}, {.8, .6, 0, -.6, .8, 0, 0, 0, 1}, .75},
        {"illum.cal",
         "il_azih",
         {.3, .4, .866025403784},
         {.8, .6, 0, -.6, .8, 0, 0, 0, 1},
         3.42538676},
        {"rev.cal", "rev_dx", {0, 0, 0, 0, 0, 0, 1, 2, 3}, {.5, .25, -.3, 1.5}, .370820393},
        {"rev.cal", "rev_dz", {0, 0, 0, 0, 0, 0, 1, 2, 3}, {.5, .25, -.3, 1.5}, 1.75},
        {"source.cal", "src_theta", {.3, .4, -.866025403784}, {0}, 150},
        {"source.cal", "src_phi", {.3, .4, -.866025403784}, {0}, 233.130102354},
        {"source.cal", "src_phi4", {.3, .4, -.866025403784}, {0}, 53.130102354},
        {"source.cal", "boxcorr(2)", {.3, .4, -.866025403784}, {1.5, .5, .6, .7}, 5.705508782},
        {"source.cal", "cylcorr(2)", {.3, .4, -.866025403784}, {1.5, .5, .6}, 9.373720183},
        {"picture.cal", "match_u", {0, 0, 0, 0, 0, 0, 2.3, 1.2}, {.5}, 1.7},
        {"picture.cal", "tile_v", {0, 0, 0, 0, 0, 0, 2.3, 1.2}, {.5}, .2},
        {"picture.cal", "stag_u", {0, 0, 0, 0, 0, 0, 2.3, .2}, {.5}, 1.3},
        {"picture.cal", "inpic", {0, 0, 0, 0, 0, 0, 1.9, .9}, {.5}, 1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double inputs[ORL_RAY_INPUTS] = {0};
        memcpy(inputs, rows[i].inputs, sizeof rows[i].inputs);
        const double value =
            value_of(rows[i].file, rows[i].expression, rows[i].arguments, 10, inputs);
        if (!(fabs(value - rows[i].value) < 1e-8 * fmax(1, fabs(rows[i].value))))
            fail_msg("%s of %s, row %zu, is %.10g, not %.10g", rows[i].expression, rows[i].file, i,
                     rows[i].value, value);
    }
}

/* Our own texts of patterns against rtrace -ov of a glow with Radiance's patterns: six digits. The
 * ray's direction is 0 0 -1, the normal 0 0 1. */
static void test_standard_patterns(void **state)
{
    static const struct {
        const char *file, *expression;
        double at[3], arguments[6], value, within;
    } rows[] = {
        {"dirt.cal", "dirt", {.37, 1.9, -2.4}, {.6}, .6559205, 1e-6},
        {"dirt.cal", "dirt", {12.3, -7.1, .21}, {1}, .408183, 1e-6},
        {"woodpat.cal", "xgrain", {3.7, 19.1, -24}, {.6}, .8236888, 1e-6},
        {"woodpat.cal", "ygrain", {33.7, 1.1, 5.2}, {.4}, .7585553, 1e-6},
        {"woodpat.cal", "zgrain", {-13.7, 41.3, 2}, {.8}, .9795288, 1e-6},
        {"marble.cal", "marble", {.37, .12, .44}, {.5}, .6614192, 1e-6},
        {"marble.cal", "marble", {2.1, -1.4, .3}, {1}, .1973827, 1e-6},
        {"brick.cal", "brick_x", {.5, .1, .245}, {.01, .08, .21, .105, .6, .3}, .3, 1e-6},
        {"brick.cal", "brick_y", {.5, .317, .21}, {.01, .08, .21, .105, .6, .3}, .6, 1e-6},
        {"brick.cal", "brick_xy", {.41, .317, .215}, {.01, .08, .21, .105, .6, .3}, .6, 1e-6},
        {"brick.cal", "brick_xy", {.41, .317, .165}, {.01, .08, .21, .105, .6, .3}, .3, 1e-6},
        {"adobe.cal", "dx + 2", {.37, 1.9, -2.4}, {.3}, 2.208685, 1e-3},
        {"adobe.cal", "dy + 2", {1.37, -.9, .4}, {.3}, 2.111886, 1e-3},
        {"adobe.cal", "cdz + 2", {1.37, -.9, .4}, {.1}, 2.076714, 1e-3},
        {"adobe.cal", "dx + 2", {-1.19, -2.81, 2.19}, {.3}, .200994, 5e-3}, /* in cracks */
        {"adobe.cal", "dz + 2", {2.79, 2.43, .41}, {.3}, 2.123326, 5e-3},
        {"woodtex.cal", "xgrain_dy + 2", {.37, 1.9, -2.4}, {.3}, 2.299924, 1e-6},
        {"woodtex.cal", "ygrain_dx + 2", {.37, 1.9, -2.4}, {.3}, 2.006732, 1e-6},
        {"wrinkle.cal", "xwrink + 2", {.37, 1.9, -2.4}, {.02, .3, .7}, 2, 1e-6},
        {"wrinkle.cal", "ywrink + 2", {1.37, -.9, .4}, {.02, .3, .7}, 1.996685, 1e-6},
        {"wrinkle.cal", "zwrink + 2", {1.37, -.9, .4}, {.02, .3, .7}, 1.984475, 1e-6},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double inputs[ORL_RAY_INPUTS] = {0, 0, -1, 0, 0, 1};
        inputs[ORL_RAY_RDOT] = 1;
        memcpy(inputs + 6, rows[i].at, sizeof rows[i].at);
        const double value =
            value_of(rows[i].file, rows[i].expression, rows[i].arguments, 6, inputs);
        if (!(fabs(value - rows[i].value) < rows[i].within))
            fail_msg("%s of %s, row %zu, is %.7g, not %.7g", rows[i].expression, rows[i].file, i,
                     rows[i].value, value);
    }
}

/* Panes of genglaze, by rcalc with Radiance's files; args 10 to 19: 1 .3 .2 .1 .5 .6 .7 .4 .45
 * .35. */
static void test_panes(void **state)
{
    static const double arguments[19] = {0,  0,  0,  0,  0,  0,  0,  0,   0,  1,
                                         .3, .2, .1, .5, .6, .7, .4, .45, .35};
    static const struct {
        const char *file, *expression;
        double values[2]; /* for Rdot .6 and -.25 */
    } rows[] = {
        {"glaze2.cal", "cr(fr(.06),ft(.789),fr(.086))", {.150631919, .384316225}},
        {"glaze2.cal", "rclr", {.100963722, .287389495}},
        {"glaze2.cal", "tclr", {.859143976, .680990342}},
        {"glaze1.cal", "sr_clear_r", {.318911911, .614388255}},
        {"glaze1.cal", "sr_clear_b", {.124315314, .768632953}},
        {"glaze1.cal", "st_clear_g", {.437842343, .34705057}},
        {"glaze1.cal", "st_clear_b", {.340544045, .269928221}},
        {"glaze1.cal", "sr_frit_g", {.100963722, .201172647}},
        {"glaze1.cal", "st_frit_b", {.601400783, .476693239}},
    };
    (void)state;
    for (size_t i = 0; i < 2 * (sizeof rows / sizeof *rows); i++) {
        double inputs[ORL_RAY_INPUTS] = {0};
        inputs[ORL_RAY_RDOT] = i % 2 ? -.25 : .6;
        const double value =
            value_of(rows[i / 2].file, rows[i / 2].expression, arguments, 19, inputs);
        if (!(fabs(value - rows[i / 2].values[i % 2]) < 2e-9))
            fail_msg("%s is %.10g, not %.10g", rows[i / 2].expression, value,
                     rows[i / 2].values[i % 2]);
    }
}

/* Radiance's noise functions at test places, by rtrace -ov of a glow of noise + 2: six digits. */
static void test_noise(void **state)
{
    static const struct {
        const char *expression;
        double value;
    } rows[] = {
        {"noise3(0,0,.3)", .365232},
        {"noise3x(0,0,.3)", .673844},
        {"noise3y(0,0,.3)", 0},
        {"fnoise3(0,0,.3)", -.427265},
        {"fnoise3(3.25,4.5,2.4475)", .219823},
        {"noise3(3.25,4.5,2.4475)", .169684},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double value = function_value("", rows[i].expression, NULL, NULL);
        if (!(fabs(value - rows[i].value) < 6e-6))
            fail_msg("%s is %.9g, not %.9g", rows[i].expression, rows[i].value, value);
    }
}

/* The gradient is the derivative of the value. */
static void test_noise_gradient(void **state)
{
    (void)state;
    for (int i = 0; i < 50; i++) {
        double inputs[ORL_RAY_INPUTS] = {0};
        const double h = 1e-5;
        inputs[ORL_RAY_PX] = .37 * i - 5;
        inputs[ORL_RAY_PY] = .21 * i;
        inputs[ORL_RAY_PZ] = -.43 * i;
        inputs[ORL_RAY_T] = h;
        const double slope =
            function_value("", "(noise3(Px,Py+T,Pz) - noise3(Px,Py-T,Pz))/(2*T)", inputs, NULL);
        assert_true(fabs(slope - function_value("", "noise3y(Px,Py,Pz)", inputs, NULL)) < 1e-7);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_standard_names), cmocka_unit_test(test_ray_names),
        cmocka_unit_test(test_standard_files), cmocka_unit_test(test_standard_patterns),
        cmocka_unit_test(test_panes),          cmocka_unit_test(test_noise),
        cmocka_unit_test(test_noise_gradient),
    };
    return cmocka_run_group_tests(tests, function_set_up, function_tear_down);
}

#include "function/interpreter/machine.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/*
 * Built-in functions, with Radiance's pseudo-random numbers and noise functions.
 *
 * noise3: Perlin noise (Perlin 1985) in the form of Perlin, "Improving Noise", SIGGRAPH 2002. Every
 * point of the integer lattice has one of 16 gradient directions; quintic polynomials blend the
 * gradients along each axis.
 * fnoise3: midpoint displacement in the cube of a cell, halved down to the resolution of the
 * lattice.
 * Both range from about -1 to 1; tests compare them with rtrace.
 */

/* Returns Radiance's pseudo-random number of a seed, which defines the look of its scenes. */
static double number_of(int64_t seed)
{
    uint64_t s = (uint64_t)seed;
    s ^= s << 13;
    const uint64_t bits = (s * (s * s * 15731 + 789221) + 1376312589) & 0x7fffffff;
    return 1 - (double)bits / 1073741824.0;
}

/* Returns a pseudo-random number from 0 to below 1. */
static double noise_rand(double x)
{
    const double spread = x * (1 / (1 + x * x) + 2.71828182845904);
    const double rest = spread + (.785398163397447 - floor(spread));
    const double quotient = 1e5 / rest;
    return quotient - floor(quotient);
}

/* Limit of coordinates; beyond it they cannot be mapped to an integer lattice. */
static const double farthest = 1e12;

/* Perlin's permutation of 0 to 255. */
static const uint8_t permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180};

/* Directions to the middles of a cube's edges, four of them twice: Perlin's choice by four bits. */
static const int8_t directions[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1}};

static const int8_t *direction_at(const int64_t p[3])
{
    uint8_t mixed = 0;
    for (int axis = 0; axis < 3; axis++)
        mixed = permutation[(uint8_t)(mixed + (uint8_t)p[axis])];
    return directions[mixed & 15];
}

/* 6 t^5 - 15 t^4 + 10 t^3, and its slope. */
static double fade(double t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

static double fade_slope(double t)
{
    return 30 * t * t * (t - 1) * (t - 1);
}

static double perlin_noise3(const double p[3], double ret_gradient[3])
{
    double t[3], value = 0, gradient[3] = {0, 0, 0};
    int64_t base[3];
    for (int axis = 0; axis < 3; axis++) {
        const double below = floor(p[axis]);
        if (!(fabs(below) < farthest))
            return NAN;
        base[axis] = (int64_t)below;
        t[axis] = p[axis] - below;
    }
    for (int i = 0; i < 8; i++) {
        const int side[3] = {i & 1, i >> 1 & 1, i >> 2};
        const int64_t corner[3] = {base[0] + side[0], base[1] + side[1], base[2] + side[2]};
        const int8_t *const towards = direction_at(corner);
        double weight[3], slope[3], height = 0;
        for (int axis = 0; axis < 3; axis++) {
            weight[axis] = side[axis] ? fade(t[axis]) : 1 - fade(t[axis]);
            slope[axis] = side[axis] ? fade_slope(t[axis]) : -fade_slope(t[axis]);
            height += towards[axis] * (t[axis] - side[axis]);
        }
        const double all = weight[0] * weight[1] * weight[2];
        value += all * height;
        gradient[0] += all * towards[0] + slope[0] * weight[1] * weight[2] * height;
        gradient[1] += all * towards[1] + slope[1] * weight[0] * weight[2] * height;
        gradient[2] += all * towards[2] + slope[2] * weight[0] * weight[1] * height;
    }
    for (int axis = 0; ret_gradient && axis < 3; axis++)
        ret_gradient[axis] = gradient[axis];
    return value;
}

/* ---- Fractal noise --------------------------------------------------------------------------- */

enum { CELL = 2000 }; /* lattice units per cell for displacements */

static double displacement_at(const int64_t p[3])
{
    return number_of(17 * p[0] + 23 * p[1] + 29 * p[2]);
}

/*
 * Reduces a cell of corner values to the octant that contains a point. The corner that the octant
 * shares with the cell (by the bits of octant) stays. Other corners get the mean of the values they
 * lie between, displaced.
 */
static void halve_cell(double corners[8], const int64_t low[3], int64_t half, int octant)
{
    double halved[8];
    for (int moved = 0; moved < 8; moved++) {
        int64_t p[3];
        double sum = 0;
        int n = 0;
        for (int part = 0; part < 8; part++)
            if ((part & ~moved) == 0) {
                sum += corners[octant ^ part];
                n++;
            }
        for (int axis = 0; axis < 3; axis++)
            p[axis] = low[axis] + (moved >> axis & 1 ? half : octant >> axis & 1 ? 2 * half : 0);
        halved[octant ^ moved] = moved ? sum / n + (double)half / CELL * displacement_at(p) : sum;
    }
    for (int i = 0; i < 8; i++)
        corners[i] = halved[i];
}

static double fractal_noise3(const double p[3])
{
    int64_t low[3], place[3];
    double corners[8], sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        if (!(fabs(p[axis]) < farthest))
            return NAN;
        place[axis] = (int64_t)(CELL * p[axis]);
        low[axis] = CELL * (int64_t)floor(p[axis]);
    }
    for (int i = 0; i < 8; i++) {
        const int64_t corner[3] = {low[0] + (i & 1 ? CELL : 0), low[1] + (i & 2 ? CELL : 0),
                                   low[2] + (i & 4 ? CELL : 0)};
        corners[i] = displacement_at(corner);
    }
    for (int64_t half = CELL / 2; half > 0; half /= 2) {
        int octant = 0;
        for (int axis = 0; axis < 3; axis++)
            octant |= place[axis] > low[axis] + half ? 1 << axis : 0;
        halve_cell(corners, low, half, octant);
        for (int axis = 0; axis < 3; axis++)
            low[axis] += octant >> axis & 1 ? half : 0;
    }
    for (int i = 0; i < 8; i++)
        sum += corners[i];
    return sum / 8;
}

/* Returns the value if it is finite. Otherwise the function is undefined there, and the value is
 * 0. */
static double finite_or_undefined(double value, bool *undefined)
{
    if (isfinite(value))
        return value;
    *undefined = true;
    return 0;
}

static double at_sqrt(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    *undefined |= a[0] < 0;
    return a[0] < 0 ? 0 : sqrt(a[0]);
}

static double at_floor(const double *a, uint32_t n, bool *undefined)
{
    (void)n, (void)undefined;
    return floor(a[0]);
}

static double at_ceil(const double *a, uint32_t n, bool *undefined)
{
    (void)n, (void)undefined;
    return ceil(a[0]);
}

static double at_min(const double *a, uint32_t n, bool *undefined)
{
    double least = a[0];
    (void)undefined;
    for (uint32_t i = 1; i < n; i++)
        least = a[i] < least ? a[i] : least;
    return least;
}

static double at_max(const double *a, uint32_t n, bool *undefined)
{
    double most = a[0];
    (void)undefined;
    for (uint32_t i = 1; i < n; i++)
        most = a[i] > most ? a[i] : most;
    return most;
}

/* Used when if() was passed as a function, so that all arguments are evaluated. */
static double at_if(const double *a, uint32_t n, bool *undefined)
{
    (void)n, (void)undefined;
    return a[0] > 0 ? a[1] : a[2];
}

static double at_select(const double *a, uint32_t n, bool *undefined)
{
    const double wanted = floor(a[0] + 0.5);
    if (wanted == 0)
        return n - 1;
    if (wanted >= 1 && wanted <= n - 1)
        return a[(uint32_t)wanted];
    *undefined = true;
    return 0;
}

static double of_atan2(const double *a)
{
    return atan2(a[0], a[1]);
}

static double of_noise3(const double *a)
{
    return perlin_noise3(a, NULL);
}

static double gradient_along(const double *a, int axis)
{
    double gradient[3] = {NAN, NAN, NAN}; /* where the noise is undefined */
    perlin_noise3(a, gradient);
    return gradient[axis];
}

static double of_noise3x(const double *a)
{
    return gradient_along(a, 0);
}

static double of_noise3y(const double *a)
{
    return gradient_along(a, 1);
}

static double of_noise3z(const double *a)
{
    return gradient_along(a, 2);
}

const struct orl_builtin orl_builtins[] = {
    {"sqrt", 1, false, .at = at_sqrt},
    {"exp", 1, false, .of_number = exp},
    {"log", 1, false, .of_number = log},
    {"log10", 1, false, .of_number = log10},
    {"sin", 1, false, .of_number = sin},
    {"cos", 1, false, .of_number = cos},
    {"tan", 1, false, .of_number = tan},
    {"asin", 1, false, .of_number = asin},
    {"acos", 1, false, .of_number = acos},
    {"atan", 1, false, .of_number = atan},
    {"atan2", 2, false, .of_numbers = of_atan2},
    {"floor", 1, false, .at = at_floor},
    {"ceil", 1, false, .at = at_ceil},
    {"min", 1, true, .at = at_min},
    {"max", 1, true, .at = at_max},
    {"if", 3, false, .at = at_if},
    {"select", 1, true, .at = at_select},
    {"rand", 1, false, .of_number = noise_rand},
    {"noise3", 3, false, .of_numbers = of_noise3},
    {"noise3x", 3, false, .of_numbers = of_noise3x},
    {"noise3y", 3, false, .of_numbers = of_noise3y},
    {"noise3z", 3, false, .of_numbers = of_noise3z},
    {"fnoise3", 3, false, .of_numbers = fractal_noise3},
    {"erf", 1, false, .of_number = erf},
    {"erfc", 1, false, .of_number = erfc},
};
const uint32_t orl_n_builtins = sizeof orl_builtins / sizeof *orl_builtins;

double orl_builtin_apply(uint32_t which, const double *args, uint32_t n, bool *undefined)
{
    const struct orl_builtin *const builtin = &orl_builtins[which];
    if (builtin->at)
        return builtin->at(args, n, undefined);
    return finite_or_undefined(
        builtin->of_number ? builtin->of_number(args[0]) : builtin->of_numbers(args), undefined);
}

int orl_builtin_named(const char *name)
{
    for (uint32_t i = 0; i < orl_n_builtins; i++)
        if (strcmp(orl_builtins[i].name, name) == 0)
            return (int)i;
    return -1;
}

double orl_builtin_power(double a, double b, bool *undefined)
{
    return finite_or_undefined(b == 2 ? a * a : pow(a, b), undefined);
}

#include "function/interpreter/builtins.h"

#include <math.h>
#include <string.h>

#include "function/interpreter/noise.h"

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

static double at_exp(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(exp(a[0]), undefined);
}

static double at_log(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(log(a[0]), undefined);
}

static double at_log10(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(log10(a[0]), undefined);
}

static double at_sin(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(sin(a[0]), undefined);
}

static double at_cos(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(cos(a[0]), undefined);
}

static double at_tan(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(tan(a[0]), undefined);
}

static double at_asin(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(asin(a[0]), undefined);
}

static double at_acos(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(acos(a[0]), undefined);
}

static double at_atan(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(atan(a[0]), undefined);
}

static double at_atan2(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(atan2(a[0], a[1]), undefined);
}

static double at_erf(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(erf(a[0]), undefined);
}

static double at_erfc(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(erfc(a[0]), undefined);
}

static double at_floor(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    (void)undefined;
    return floor(a[0]);
}

static double at_ceil(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    (void)undefined;
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
    (void)n;
    (void)undefined;
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

static double at_rand(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(orl_noise_rand(a[0]), undefined);
}

static double at_noise3(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(orl_noise3(a, NULL), undefined);
}

static double at_gradient(const double *a, int axis, bool *undefined)
{
    double gradient[3];
    orl_noise3(a, gradient);
    return finite_or_undefined(gradient[axis], undefined);
}

static double at_noise3x(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return at_gradient(a, 0, undefined);
}

static double at_noise3y(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return at_gradient(a, 1, undefined);
}

static double at_noise3z(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return at_gradient(a, 2, undefined);
}

static double at_fnoise3(const double *a, uint32_t n, bool *undefined)
{
    (void)n;
    return finite_or_undefined(orl_noise_fractal3(a), undefined);
}

const struct orl_builtin orl_builtins[] = {
    {"sqrt", 1, false, at_sqrt},       {"exp", 1, false, at_exp},
    {"log", 1, false, at_log},         {"log10", 1, false, at_log10},
    {"sin", 1, false, at_sin},         {"cos", 1, false, at_cos},
    {"tan", 1, false, at_tan},         {"asin", 1, false, at_asin},
    {"acos", 1, false, at_acos},       {"atan", 1, false, at_atan},
    {"atan2", 2, false, at_atan2},     {"floor", 1, false, at_floor},
    {"ceil", 1, false, at_ceil},       {"min", 1, true, at_min},
    {"max", 1, true, at_max},          {"if", 3, false, at_if},
    {"select", 1, true, at_select},    {"rand", 1, false, at_rand},
    {"noise3", 3, false, at_noise3},   {"noise3x", 3, false, at_noise3x},
    {"noise3y", 3, false, at_noise3y}, {"noise3z", 3, false, at_noise3z},
    {"fnoise3", 3, false, at_fnoise3}, {"erf", 1, false, at_erf},
    {"erfc", 1, false, at_erfc},
};
const uint32_t orl_n_builtins = sizeof orl_builtins / sizeof *orl_builtins;

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

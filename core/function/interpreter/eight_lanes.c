#include "function/interpreter/eight_lanes.h"

#include <math.h>

#include "function/interpreter/builtins.h"

enum { LANES = ORL_FUNCTION_LANES };

void orl_lanes_add(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] += b[l];
}

void orl_lanes_subtract(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] -= b[l];
}

void orl_lanes_multiply(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] *= b[l];
}

void orl_lanes_negate(double *a)
{
    for (int l = 0; l < LANES; l++)
        a[l] = -a[l];
}

unsigned orl_lanes_divide(double *a, const double *b, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        undefined |= b[l] == 0 ? 1U << l : 0;
        a[l] = b[l] == 0 ? 0 : a[l] / b[l];
    }
    return undefined & active;
}

unsigned orl_lanes_power(double *a, const double *b, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        bool without = false;
        if (active >> l & 1)
            a[l] = orl_builtin_power(a[l], b[l], &without);
        undefined |= without ? 1U << l : 0;
    }
    return undefined;
}

unsigned orl_lanes_apply(uint32_t which, double (*args)[ORL_FUNCTION_LANES], uint32_t count,
                         unsigned active)
{
    const uint32_t n = count < ORL_FUNCTION_PARAMETERS ? count : ORL_FUNCTION_PARAMETERS;
    double one[ORL_FUNCTION_PARAMETERS];
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        bool without = false;
        if (!(active >> l & 1))
            continue;
        for (uint32_t i = 0; i < n; i++)
            one[i] = args[i][l];
        args[0][l] = orl_builtins[which].at(one, n, &without);
        undefined |= without ? 1U << l : 0;
    }
    return undefined;
}

unsigned orl_lanes_look_up(double *value, const double *list, size_t count, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        const double wanted = floor(value[l] + 0.5);
        const bool is_there = wanted >= 1 && wanted <= (double)count;
        if (!is_there && !(wanted == 0))
            undefined |= 1U << l;
        value[l] = is_there ? list[(size_t)wanted - 1] : wanted == 0 ? (double)count : 0;
    }
    return undefined & active;
}

unsigned orl_lanes_above_zero(const double *a)
{
    unsigned above = 0;
    for (int l = 0; l < LANES; l++)
        above |= a[l] > 0 ? 1U << l : 0;
    return above;
}

void orl_lanes_copy(double *into, const double *from, unsigned lanes)
{
    for (int l = 0; l < LANES; l++)
        into[l] = lanes >> l & 1 ? from[l] : into[l];
}

#include "metrics/annual/annual_figures.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include <oriel/annual/annual_metrics.h>
#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>

enum { PLACES = 1 << 14 };
static const double nothing = 1e-18; /* negligible probability; such places are dropped */

double orl_student_above(double t)
{
    const double angle = atan2(fabs(t), sqrt(ORL_ANNUAL_DEGREES)), c = cos(angle);
    double term = c, sum = c;
    for (int k = 3; k <= ORL_ANNUAL_DEGREES - 2; k += 2) {
        term *= c * c * (k - 1) / k;
        sum += term;
    }
    const double within = 2 / ORL_PI * (angle + sin(angle) * sum);
    return t > 0 ? (1 - within) / 2 : (1 + within) / 2;
}

double orl_student_t(double share_above)
{
    double low = -1e4, high = 1e4;
    for (int i = 0; i < 200; i++) {
        const double middle = (low + high) / 2;
        if (orl_student_above(middle) > share_above)
            low = middle;
        else
            high = middle;
    }
    return (low + high) / 2;
}

/* Distribution over places; those outside first to last are empty. */
struct spread {
    double *at;
    size_t first, last;
};

static void add_part(struct spread *s, double places, double pass)
{
    const size_t whole = (size_t)places;
    const double rest = places - (double)whole, near = pass * (1 - rest), far = pass * rest;
    const size_t reach = whole + (far > 0);
    for (size_t i = s->last + reach + 1; i-- > s->first;) {
        double sum = s->at[i] * (1 - pass);
        if (i >= s->first + whole)
            sum += s->at[i - whole] * near;
        if (far > 0 && i >= s->first + whole + 1)
            sum += s->at[i - whole - 1] * far;
        s->at[i] = sum;
    }
    s->last += reach;
    while (s->first < s->last && s->at[s->first] < nothing)
        s->at[s->first++] = 0;
    while (s->last > s->first && s->at[s->last] < nothing)
        s->at[s->last--] = 0;
}

static bool areas_are_equal(const struct orl_area_part *parts, size_t n)
{
    for (size_t i = 1; i < n; i++)
        if (parts[i].area != parts[0].area)
            return false;
    return true;
}

static void find_bounds(const struct spread *s, double tail, size_t *ret_low, size_t *ret_high)
{
    double below = 0, above = 0;
    *ret_low = s->first;
    *ret_high = s->last;
    while (*ret_low < s->last && below + s->at[*ret_low] <= tail)
        below += s->at[(*ret_low)++];
    while (*ret_high > s->first && above + s->at[*ret_high] <= tail)
        above += s->at[(*ret_high)--];
}

int orl_passing_area_bounds(const struct orl_area_part *parts, size_t n, double tail,
                            const atomic_bool *cancel, double *ret_low, double *ret_high)
{
    const bool alike = areas_are_equal(parts, n);
    double total = 0;
    bool cancelled = false;
    for (size_t i = 0; i < n; i++)
        total += parts[i].area;
    *ret_low = *ret_high = 0;
    if (n == 0 || !(total > 0))
        return 0;
    const double unit = alike ? parts[0].area : total / PLACES;
    struct spread s = {.at = calloc((alike ? n : PLACES) + n + 2, sizeof *s.at)};
    if (!s.at)
        return ORL_ERR_NOMEM;
    s.at[0] = 1;
    for (size_t i = 0; i < n && !cancelled; i++) {
        add_part(&s, alike ? 1 : parts[i].area / unit, parts[i].pass);
        cancelled = orl_is_cancelled(cancel);
    }
    size_t low = 0, high = 0;
    find_bounds(&s, tail, &low, &high);
    *ret_low = (double)low * unit;
    *ret_high = (double)high * unit;
    free(s.at);
    return cancelled ? ORL_ERR_CANCELLED : 0;
}

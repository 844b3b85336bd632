/* Colours of MGF: by chromaticity, spectrum or temperature, and mixtures. */
#include <math.h>

#include "scene/generate/mgf/mgf_context.h"
#include "scene/material/patterns/observer.h"

enum { STEP_NM = 5 };

static struct orl_mgf_color *current_color(struct orl_mgf_reader *r)
{
    return &r->current[ORL_MGF_COLOR]->is.color;
}

bool orl_mgf_is_gray(struct orl_mgf_color color)
{
    return fabs(color.x - 1. / 3) <= 0.01 && fabs(color.y - 1. / 3) <= 0.01;
}

bool orl_mgf_same_color(struct orl_mgf_color a, struct orl_mgf_color b)
{
    return fabs(a.x - b.x) + fabs(a.y - b.y) <= 0.015;
}

struct orl_rgb orl_mgf_rgb(struct orl_mgf_color color, double luminance)
{
    const double scale = luminance / color.y;
    return orl_tristimulus_rgb(
        (struct orl_tristimulus){color.x * scale, luminance, (1 - color.x - color.y) * scale});
}

static int set_seen(struct orl_mgf_reader *r, struct orl_tristimulus seen)
{
    const double sum = seen.x + seen.y + seen.z;
    if (!(seen.y > 0) || !isfinite(sum))
        return orl_mgf_fail(r, ORL_ERR_RANGE, "nothing of the colour can be seen");
    *current_color(r) = (struct orl_mgf_color){seen.x / sum, seen.y / sum};
    return 0;
}

int orl_mgf_cxy(struct orl_mgf_reader *r)
{
    double x = 0, y = 0;
    int code = orl_mgf_expect_words(r, 2, 2);
    if (code == 0)
        code = orl_mgf_number(r, 1, &x);
    if (code == 0)
        code = orl_mgf_number(r, 2, &y);
    if (code == 0 && !(x >= 0 && y > 1e-4 && x + y <= 1.0001))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "x %g and y %g are no chromaticity", x, y);
    if (code == 0)
        *current_color(r) = (struct orl_mgf_color){x, y};
    return code;
}

/* Evenly spaced values, linear in between. */
int orl_mgf_cspec(struct orl_mgf_reader *r)
{
    struct orl_tristimulus seen = {0};
    double range[2] = {0, 0}, value = 0, next = 0;
    const size_t n = r->n_words > 3 ? r->n_words - 3 : 0;
    int code = orl_mgf_expect_words(r, 4, ORL_MGF_WORDS);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = orl_mgf_number(r, 1 + i, &range[i]);
    if (code == 0 && !(range[0] > 0 && range[1] > range[0]))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "wavelengths from %g to %g", range[0], range[1]);
    if (code == 0)
        code = orl_mgf_number(r, 3, &value);
    for (size_t i = 1; i < n && code == 0; i++) {
        const double step = (range[1] - range[0]) / (double)(n - 1);
        const double from = range[0] + (double)(i - 1) * step;
        const int parts = (int)fmin(64, ceil(step / STEP_NM));
        code = orl_mgf_number(r, 3 + i, &next);
        for (int k = 0; k < parts; k++)
            orl_tristimulus_add(&seen, from + step * k / parts, from + step * (k + 1) / parts,
                                value + (next - value) * (k + 0.5) / parts);
        value = next;
    }
    return code == 0 ? set_seen(r, seen) : code;
}

/* Colour of a black body by Planck's law; temperature in K. */
int orl_mgf_cct(struct orl_mgf_reader *r)
{
    const double second_radiation_constant = 1.4388e7; /* nm K */
    struct orl_tristimulus seen = {0};
    double kelvin = 0;
    int code = orl_mgf_expect_words(r, 1, 1);
    if (code == 0)
        code = orl_mgf_number(r, 1, &kelvin);
    if (code == 0 && !(kelvin >= 300 && kelvin <= 1e6))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "a temperature of %g K", kelvin);
    for (int nm = 380; nm < 780 && code == 0; nm += STEP_NM) {
        const double middle = nm + STEP_NM / 2.;
        const double exponent = second_radiation_constant / kelvin * (1 / middle - 1. / 560);
        const double below = -expm1(-second_radiation_constant / (middle * kelvin));
        orl_tristimulus_add(&seen, nm, nm + STEP_NM, pow(560 / middle, 5) * exp(-exponent) / below);
    }
    return code == 0 ? set_seen(r, seen) : code;
}

/* Sum of colours, each weighted by a luminance. */
int orl_mgf_cmix(struct orl_mgf_reader *r)
{
    struct orl_tristimulus seen = {0};
    int code = orl_mgf_expect_words(r, 4, ORL_MGF_WORDS);
    if (code == 0 && r->n_words % 2 == 0)
        code = orl_mgf_fail(r, ORL_ERR_SYNTAX, "the last weight has no colour");
    for (size_t i = 1; i + 1 < r->n_words && code == 0; i += 2) {
        double weight = 0;
        const struct orl_mgf_item *item;
        code = orl_mgf_number(r, i, &weight);
        if (code < 0)
            return code;
        item = orl_mgf_find(r, ORL_MGF_COLOR, r->words[i + 1]);
        if (!item)
            return r->err->code;
        seen.x += weight * item->is.color.x / item->is.color.y;
        seen.y += weight;
        seen.z += weight * (1 - item->is.color.x - item->is.color.y) / item->is.color.y;
    }
    return code == 0 ? set_seen(r, seen) : code;
}

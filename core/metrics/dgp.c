#include "metrics/dgp.h"

#include <math.h>

static const struct constants {
    double per_lx, contrast, base;
} constants[] = {
    [ORL_DGP_PUBLISHED] = {5.87e-5, 0.0918, 0.16}, [ORL_DGP_EVALGLARE] = {5.87e-5, 0.092, 0.159}};

static bool is_share(double value)
{
    return isfinite(value) && value >= 0;
}

static int check_source(const struct orl_glare_source *s, size_t number, struct orl_error *err)
{
    if (is_share(s->luminance_cd_m2) && is_share(s->solid_angle_sr) &&
        isfinite(s->position_index) && s->position_index > 0)
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE,
                         "glare source %zu: %g cd/m2 over %g sr at position index %g is no source",
                         number + 1, s->luminance_cd_m2, s->solid_angle_sr, s->position_index);
}

/*
 * Returns log10(1 + sum). Squared luminances may overflow a double, and Ev^1.87 may underflow.
 * Therefore the quotient is computed for each source. A result that overflows is clamped to 1 by
 * the caller.
 */
static double log_contrast(double eye_lx, const struct orl_glare_source *sources, size_t n_sources)
{
    const double adaptation = pow(eye_lx, 1.87 / 2);
    double sum = 0;
    for (size_t i = 0; i < n_sources; i++) {
        const struct orl_glare_source *s = &sources[i];
        const double seen = s->luminance_cd_m2 / (adaptation * s->position_index);
        if (seen > 0 && s->solid_angle_sr > 0)
            sum += seen * seen * s->solid_angle_sr;
    }
    return log1p(sum) / log(10.0);
}

int orl_dgp(double eye_lx, const struct orl_glare_source *sources, size_t n_sources,
            const struct orl_dgp_options *options, double *ret_dgp, struct orl_error *err)
{
    const struct constants *c = &constants[options->constants];
    double dgp = c->base;
    if (!is_share(eye_lx))
        return orl_error_set(err, ORL_ERR_RANGE, "%g lx is no illuminance", eye_lx);
    for (size_t i = 0; i < n_sources; i++) {
        const int code = check_source(&sources[i], i, err);
        if (code < 0)
            return code;
    }
    if (eye_lx > 0)
        dgp += c->per_lx * eye_lx + c->contrast * log_contrast(eye_lx, sources, n_sources);
    if (options->low_light && eye_lx < 1000)
        dgp *= 1 / (1 + exp(4 - 0.024 * eye_lx));
    *ret_dgp = fmin(dgp, 1);
    return 0;
}

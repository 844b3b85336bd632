#include "metrics/indices.h"

#include <math.h>

/* ---- Position index -------------------------------------------------------------------------- */

static const double most = 16;

static double above_sight(double sigma, double tau)
{
    const double by_angle = 35.2 - 0.31889 * tau - 1.22 * exp(-2 * tau / 9);
    const double by_square = 21 + 0.26667 * tau - 0.002963 * tau * tau;
    return exp(by_angle * 1e-3 * sigma + by_square * 1e-5 * sigma * sigma);
}

/* tan beta is the distance from the line of sight on a plane at distance 1, scaled
 * vertically. */
static double below_sight(struct orl_vec3 d)
{
    const double across = hypot(d.x, d.y), cos_tau = across > 0 ? d.y / across : 0;
    const double stretched = across * sqrt(1 + 0.3225 * cos_tau * cos_tau);
    const double beta = atan2(stretched, d.z) / ORL_DEG_TO_RAD;
    return exp(6.49e-3 * beta + 21e-5 * beta * beta);
}

double orl_position_index(struct orl_vec3 direction)
{
    const double across = hypot(direction.x, direction.y);
    const double sigma = atan2(across, direction.z) / ORL_DEG_TO_RAD;
    if (direction.y < 0)
        return fmin(below_sight(direction), most);
    return fmin(above_sight(sigma, atan2(fabs(direction.x), direction.y) / ORL_DEG_TO_RAD), most);
}

/* ---- DGP ------------------------------------------------------------------------------------- */

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
                         "glare source %zu is invalid: %g cd/m2 over %g sr at position index %g",
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
        return orl_error_set(err, ORL_ERR_RANGE, "%g lx is not a valid illuminance", eye_lx);
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

static double finite_or_none(double value)
{
    return isfinite(value) ? value : NAN;
}

static double compute_dgi(const struct orl_glare_light *light,
                          const struct orl_glare_source *sources, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const struct orl_glare_source *s = &sources[i];
        const double l = s->luminance_cd_m2, p = s->position_index;
        const double seen_sr = s->solid_angle_sr / (p * p);
        sum += 0.478 * pow(l, 1.6) * pow(seen_sr, 0.8) /
               (light->background_cd_m2 + 0.07 * sqrt(s->solid_angle_sr) * l);
    }
    return 10 * log10(sum);
}

static double glare_sum(const struct orl_glare_source *sources, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double seen = sources[i].luminance_cd_m2 / sources[i].position_index;
        sum += seen * seen * sources[i].solid_angle_sr;
    }
    return sum;
}

static double compute_vcp(const struct orl_glare_light *light,
                          const struct orl_glare_source *sources, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double w = sources[i].solid_angle_sr;
        const double q = 20.4 * w + 1.52 * pow(w, 0.2) - 0.075;
        sum += 0.5 * sources[i].luminance_cd_m2 * q /
               (sources[i].position_index * pow(light->average_cd_m2, 0.44));
    }
    const double dgr = sum > 0 ? pow(sum, pow((double)count, -0.0914)) : 0;
    return dgr < 20 ? 100 : dgr > 750 ? 0 : 50 * erf((6.374 - 1.3227 * log(dgr)) / sqrt(2)) + 50;
}

void orl_glare_indices(const struct orl_glare_light *light, const struct orl_glare_source *sources,
                       size_t count, double ret_values[ORL_GLARE_METRICS])
{
    const double sum = glare_sum(sources, count), over = sum / light->background_cd_m2;
    const bool any = count > 0;
    double *v = ret_values;
    v[ORL_GLARE_DGPS] = fmin(6.22e-5 * light->eye_lx + 0.184, 1);
    v[ORL_GLARE_DGI] = any ? finite_or_none(compute_dgi(light, sources, count)) : 0;
    v[ORL_GLARE_UGR] = any ? finite_or_none(8 * log10(0.25 * over)) : 0;
    v[ORL_GLARE_UGP] = any ? finite_or_none(0.26 * log10(0.25 * over)) : 0;
    v[ORL_GLARE_CGI] =
        any ? finite_or_none(8 * log10(2 * (1 + light->direct_lx / 500) / light->eye_lx * sum)) : 0;
    v[ORL_GLARE_VCP] = any ? finite_or_none(compute_vcp(light, sources, count)) : 100;
    v[ORL_GLARE_ILLUMINANCE] = light->eye_lx;
    v[ORL_GLARE_AVERAGE] = light->average_cd_m2;
    v[ORL_GLARE_BACKGROUND] = light->background_cd_m2;
}

#include "metrics/indices.h"

#include <math.h>

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

#include "scene/material/kinds.h"

/* Fresnel reflectance and transmittance of one surface for one polarisation. Both are stored
 * because 1 - r cancels. */
struct surface {
    double r, t;
};

struct pane {
    struct surface parallel, perpendicular;
    struct orl_rgb pass; /* transmittance of one pass */
};

static struct surface surface_of(double numerator, double denominator, double product)
{
    const double r = numerator / denominator;
    return (struct surface){r * r, 4 * product / (denominator * denominator)};
}

static struct pane pane_at(const struct orl_material *material, const struct orl_hit *hit,
                           double cosine)
{
    /* Clamps the cosine above 0: glass of index 1 would divide 0 by 0. */
    const double n = material->ior, c = orl_smaller(orl_larger(fabs(cosine), 1e-150), 1);
    const double inside = sqrt((n - 1) * (n + 1) + c * c) / n;
    const double path = 1 / inside; /* path length relative to normal incidence */
    const struct orl_rgb t = orl_transmissivity_at(material, hit);
    struct pane pane = {surface_of(n * c - inside, n * c + inside, n * c * inside),
                        surface_of(c - n * inside, c + n * inside, n * c * inside),
                        orl_gray(pow(t.r, path))};
    /* Most glass is grey, so one pow() is enough. */
    if (t.g != t.r || t.b != t.r) {
        pane.pass.g = pow(t.g, path);
        pane.pass.b = pow(t.b, path);
    }
    return pane;
}

/* Sum over all internal passes, each of transmittance d. Factoring 1 - r^2 d^2 keeps it exact at
 * grazing. */
static double pane_transmittance(struct surface s, double d)
{
    return s.t > 0 ? s.t * s.t * d / ((s.t + s.r * (1 - d)) * (1 + s.r * d)) : 0;
}

static double pane_reflectance(struct surface s, double d)
{
    return s.r * (1 + d * pane_transmittance(s, d));
}

/* Mean of both polarisations of a channel; share: pane_transmittance or pane_reflectance. */
static inline double unpolarised(const struct pane *pane, double pass,
                                 double (*share)(struct surface s, double d))
{
    return 0.5 * (share(pane->parallel, pass) + share(pane->perpendicular, pass));
}

static inline struct orl_rgb pane_share(const struct pane *pane,
                                        double (*share)(struct surface s, double d))
{
    const struct orl_rgb pass = pane->pass;
    const double red = unpolarised(pane, pass.r, share);
    if (pass.g == pass.r && pass.b == pass.r)
        return orl_gray(red);
    return (struct orl_rgb){red, unpolarised(pane, pass.g, share),
                            unpolarised(pane, pass.b, share)};
}

struct orl_rgb orl_glass_transmittance(const struct orl_material *material,
                                       const struct orl_hit *hit, double cosine)
{
    const struct pane pane = pane_at(material, hit, cosine);
    const struct orl_rgb through = pane_share(&pane, pane_transmittance);
    /* An illum's pattern applies to its emission, not to its transmission. */
    return material->pattern && material->kind == ORL_MATERIAL_GLASS
               ? orl_rgb_mul(through, orl_glass_pattern_at(material, hit))
               : through;
}

struct orl_rgb orl_glass_reflectance(const struct orl_material *material, const struct orl_hit *hit,
                                     double cosine)
{
    const struct pane pane = pane_at(material, hit, cosine);
    return pane_share(&pane, pane_reflectance);
}

struct orl_surface_sample orl_glass_sample(const struct orl_bsdf_query *query, const double u[3])
{
    const struct pane pane = pane_at(query->material, query->hit,
                                     orl_cosine_at(query->material, query->hit, query->from));
    struct orl_surface_sample s = {.event = ORL_EVENT_ABSORBED};
    struct orl_rgb through =
        query->lobes & ORL_LOBE_TRANSMITTED ? pane_share(&pane, pane_transmittance) : orl_gray(0);
    if (query->material->pattern)
        through = orl_rgb_mul(through, orl_glass_pattern_at(query->material, query->hit));
    const struct orl_rgb back =
        query->lobes & ORL_LOBE_REFLECTED ? pane_share(&pane, pane_reflectance) : orl_gray(0);
    const double t = orl_luma(through), r = orl_luma(back);
    if (!(t + r > 0))
        return s;
    /* The weight carries the absorption: there is no Russian roulette here. */
    const double p = t / (t + r);
    s.transmitted = u[2] < p;
    s.event = s.transmitted ? ORL_EVENT_STRAIGHT : ORL_EVENT_MIRROR;
    s.direction = s.transmitted ? orl_neg(query->from)
                                : orl_mirrored_at(query->material, query->hit, query->from);
    s.weight = s.transmitted ? orl_rgb_scale(through, 1 / p) : orl_rgb_scale(back, 1 / (1 - p));
    return s;
}

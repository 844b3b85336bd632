/*
 * Materials that only reflect and refract specularly: thin glass, interfaces of clear media,
 * mirrors.
 */
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

/* Returns the glass of a pane, or that behind which an illum lets light pass. */
static const struct orl_glass *glass_of(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_ILLUM ? &orl_illum_of(material)->pane
                                                : orl_glass_of(material);
}

static struct pane pane_at(const struct orl_glass *glass, double cosine)
{
    /* Clamps the cosine above 0: glass of index 1 would divide 0 by 0. */
    const double n = glass->ior, c = orl_smaller(orl_larger(fabs(cosine), 1e-150), 1);
    const double inside = sqrt((n - 1) * (n + 1) + c * c) / n;
    const double path = 1 / inside; /* path length relative to normal incidence */
    const struct orl_rgb t = glass->transmissivity;
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
    const struct pane pane = pane_at(glass_of(material), cosine);
    const struct orl_rgb through = pane_share(&pane, pane_transmittance);
    /* An illum's pattern applies to its emission, not to its transmission. */
    return material->pattern && material->kind == ORL_MATERIAL_GLASS
               ? orl_rgb_mul(through, orl_glass_pattern_at(material, hit))
               : through;
}

struct orl_rgb orl_glass_reflectance(const struct orl_material *material, const struct orl_hit *hit,
                                     double cosine)
{
    (void)hit;
    const struct pane pane = pane_at(orl_glass_of(material), cosine);
    return pane_share(&pane, pane_reflectance);
}

struct orl_surface_sample orl_glass_sample(const struct orl_bsdf_query *query, const double u[3])
{
    const struct pane pane = pane_at(orl_glass_of(query->material),
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

/*
 * Interfaces of two clear media: Fresnel's equations for unpolarised light, Snell's law, and
 * absorption in the media (Beer). media[0] lies behind the surface, media[1] in front of it.
 */

static const struct orl_medium *medium(const struct orl_material *material, bool front)
{
    return &orl_interface_of(material)->media[front ? 1 : 0];
}

/* Reflection and refraction of one direction at the surface. */
struct meeting {
    double reflected, refracted; /* fractions of the light; refracted 0: total reflection */
    double ratio;                /* refractive index on the side of "from" over the index beyond */
    struct orl_vec3 inwards;     /* the refracted direction */
};

static struct meeting fresnel_about(const struct orl_material *material, bool front,
                                    struct orl_vec3 normal, struct orl_vec3 from)
{
    const double here = medium(material, front)->ior, beyond = medium(material, !front)->ior;
    const double ratio = here / beyond, c = fmin(orl_dot(from, normal), 1);
    const double sine2 = ratio * ratio * (1 - c) * (1 + c);
    if (sine2 >= 1)
        return (struct meeting){.reflected = 1, .ratio = ratio};
    const double inside = sqrt(1 - sine2);
    const double across = here * c + beyond * inside, along = beyond * c + here * inside;
    const double product = 4 * here * beyond * c * inside;
    /* 1 - r would lose all digits at grazing angles. */
    const double refracted =
        product > 0 ? 0.5 * product * (1 / (across * across) + 1 / (along * along)) : 0;
    return (struct meeting){
        .reflected = fmax(0, 1 - refracted),
        .refracted = refracted,
        .ratio = ratio,
        .inwards = orl_normalize(orl_madd(orl_scale(from, -ratio), normal, ratio * c - inside))};
}

/* Uses the perturbed normal unless the refracted ray would then stay in front of the surface. */
static struct meeting fresnel_at_hit(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 from)
{
    const bool front = orl_dot(from, hit->normal) >= 0;
    const struct orl_vec3 plain = front ? hit->normal : orl_neg(hit->normal);
    if (material->texture) {
        const struct orl_vec3 turned = orl_texture_normal(material->texture, hit, from);
        const struct meeting m = fresnel_about(material, front, turned, from);
        if (!(m.refracted > 0) || orl_dot(m.inwards, plain) < 0)
            return m;
    }
    return fresnel_about(material, front, plain, from);
}

double orl_dielectric_reflectance(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 from)
{
    return fresnel_at_hit(material, hit, from).reflected;
}

/* Radiance scales with n^2 because the solid angle changes: L / n^2 is constant. Flux is
 * unchanged. */
static struct orl_surface_sample refracted(const struct orl_material *material,
                                           const struct orl_hit *hit, struct orl_vec3 from,
                                           const struct meeting *m, enum orl_transport transport)
{
    const double squeeze = transport == ORL_TRANSPORT_EYE ? m->ratio * m->ratio : 1;
    const bool front = orl_dot(from, hit->normal) >= 0;
    return (struct orl_surface_sample){.event = ORL_EVENT_REFRACTED,
                                       .transmitted = true,
                                       .direction = m->inwards,
                                       .weight = orl_gray(m->refracted * squeeze),
                                       .medium_transmissivity =
                                           medium(material, !front)->transmissivity};
}

bool orl_material_refract(const struct orl_material *material, const struct orl_hit *hit,
                          struct orl_vec3 from, enum orl_transport transport,
                          struct orl_surface_sample *ret_sample)
{
    if (material->kind != ORL_MATERIAL_DIELECTRIC)
        return false;
    const struct meeting m = fresnel_at_hit(material, hit, from);
    if (!(m.refracted > 0))
        return false;
    *ret_sample = refracted(material, hit, from, &m, transport);
    return true;
}

struct orl_surface_sample orl_dielectric_sample(const struct orl_bsdf_query *query,
                                                const double u[3])
{
    const struct orl_vec3 normal = query->hit->normal;
    const struct meeting m = fresnel_at_hit(query->material, query->hit, query->from);
    const double t = query->lobes & ORL_LOBE_TRANSMITTED ? m.refracted : 0;
    const double r = query->lobes & ORL_LOBE_REFLECTED ? m.reflected : 0;
    if (!(t + r > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    const double p = t / (t + r);
    if (u[2] < p) {
        struct orl_surface_sample s =
            refracted(query->material, query->hit, query->from, &m, query->transport);
        s.weight = orl_rgb_scale(s.weight, 1 / p);
        return s;
    }
    const bool front = orl_dot(query->from, normal) >= 0;
    return (struct orl_surface_sample){
        .event = ORL_EVENT_MIRROR,
        .direction = orl_mirrored_at(query->material, query->hit, query->from),
        .weight = orl_gray(r / (1 - p)),
        .medium_transmissivity = medium(query->material, front)->transmissivity};
}

struct orl_rgb orl_medium_transmittance(struct orl_rgb medium_transmissivity, double distance)
{
    if (orl_medium_is_clear(medium_transmissivity))
        return medium_transmissivity;
    return (struct orl_rgb){pow(medium_transmissivity.r, distance),
                            pow(medium_transmissivity.g, distance),
                            pow(medium_transmissivity.b, distance)};
}

struct orl_rgb orl_dielectric_transmittance(const struct orl_material *material,
                                            const struct orl_hit *hit,
                                            struct orl_rgb medium_transmissivity)
{
    if (material->kind == ORL_MATERIAL_DIELECTRIC)
        medium_transmissivity = medium(material, hit->front)->transmissivity;
    return orl_medium_transmittance(medium_transmissivity, hit->distance);
}

/* Mirrors: specular on the front; the back is black. */

struct orl_rgb orl_mirror_reflectance(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 from)
{
    return orl_dot(from, hit->normal) > 0 ? orl_color_at(material, hit) : orl_gray(0);
}

struct orl_surface_sample orl_mirror_sample(const struct orl_bsdf_query *query)
{
    const struct orl_rgb back = orl_mirror_reflectance(query->material, query->hit, query->from);
    if (!(query->lobes & ORL_LOBE_REFLECTED) || !(orl_rgb_max(back) > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    return (struct orl_surface_sample){
        .event = ORL_EVENT_MIRROR,
        .direction = orl_mirrored_at(query->material, query->hit, query->from),
        .weight = back};
}

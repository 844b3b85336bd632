#include "scene/scatter.h"

bool orl_material_is_window(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_GLASS || material->kind == ORL_MATERIAL_BSDF;
}

static bool is_opaque_reflector(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_PLASTIC || material->kind == ORL_MATERIAL_METAL;
}

struct orl_rgb orl_material_diffuse(const struct orl_material *material)
{
    if (!is_opaque_reflector(material))
        return orl_gray(0);
    return orl_rgb_scale(material->color, 1.0 - material->specular);
}

struct orl_rgb orl_material_specular(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_PLASTIC)
        return orl_gray(material->specular);
    if (material->kind == ORL_MATERIAL_METAL)
        return orl_rgb_scale(material->color, material->specular);
    return orl_gray(0);
}

bool orl_material_has_lobes(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_BSDF ||
           (material->roughness > 0 && orl_rgb_max(orl_material_specular(material)) > 0);
}

struct orl_rgb orl_material_emission(const struct orl_material *material, const struct orl_hit *hit)
{
    const bool shines = material->kind == ORL_MATERIAL_LIGHT || material->kind == ORL_MATERIAL_GLOW;
    return shines && hit->front ? material->color : orl_gray(0);
}

struct orl_frame orl_bsdf_frame(const struct orl_material *material, struct orl_vec3 normal)
{
    struct orl_frame frame;
    frame.n = normal;
    frame.v = orl_normalize(orl_madd(material->up, normal, -orl_dot(material->up, normal)));
    frame.u = orl_cross(frame.v, frame.n);
    return frame;
}

/* ---- Glass ----------------------------------------------------------------------------------- */

/* One surface, one polarisation: what Fresnel sends back and lets in. Both, for 1 - r cancels. */
struct surface {
    double r, t;
};

struct pane {
    struct surface parallel, perpendicular;
    double path; /* length inside relative to the normal's */
};

static struct surface surface_of(double numerator, double denominator, double product)
{
    const double r = numerator / denominator;
    return (struct surface){r * r, 4 * product / (denominator * denominator)};
}

static struct pane pane_at(const struct orl_material *material, double cosine)
{
    const double n = material->ior, c = fmin(fabs(cosine), 1.0);
    const double inside = sqrt(1 - (1 - c * c) / (n * n));
    return (struct pane){surface_of(n * c - inside, n * c + inside, n * c * inside),
                         surface_of(c - n * inside, c + n * inside, n * c * inside), 1 / inside};
}

/* All passes, each of transmission d; 1 - r^2 d^2 in factors, which is exact at grazing too. */
static double pane_transmittance(struct surface s, double d)
{
    return s.t > 0 ? s.t * s.t * d / ((s.t + s.r * (1 - d)) * (1 + s.r * d)) : 0;
}

static double pane_reflectance(struct surface s, double d)
{
    return s.r * (1 + d * pane_transmittance(s, d));
}

/* Both polarisations of a channel, averaged; share is pane_transmittance or pane_reflectance. */
static double unpolarised(const struct pane *pane, double transmissivity,
                          double (*share)(struct surface s, double d))
{
    const double d = pow(transmissivity, pane->path);
    return 0.5 * (share(pane->parallel, d) + share(pane->perpendicular, d));
}

static struct orl_rgb pane_share(const struct orl_material *material, double cosine,
                                 double (*share)(struct surface s, double d))
{
    const struct pane pane = pane_at(material, cosine);
    const struct orl_rgb t = material->transmissivity;
    const double red = unpolarised(&pane, t.r, share);
    /* Most glass is grey: one power instead of three. */
    if (t.g == t.r && t.b == t.r)
        return orl_gray(red);
    return (struct orl_rgb){red, unpolarised(&pane, t.g, share), unpolarised(&pane, t.b, share)};
}

struct orl_rgb orl_material_straight(const struct orl_material *material, double cosine)
{
    if (material->kind != ORL_MATERIAL_GLASS)
        return orl_gray(0);
    return pane_share(material, cosine, pane_transmittance);
}

struct orl_rgb orl_glass_reflectance(const struct orl_material *material, double cosine)
{
    return pane_share(material, cosine, pane_reflectance);
}

static struct orl_vec3 mirrored(struct orl_vec3 from, struct orl_vec3 normal)
{
    return orl_sub(orl_scale(normal, 2 * orl_dot(from, normal)), from);
}

static struct orl_scatter sample_glass(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 from,
                                       enum orl_lobes lobes, struct orl_random *random)
{
    const double cosine = orl_dot(from, hit->normal);
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED};
    const struct orl_rgb through =
        lobes & ORL_LOBE_TRANSMITTED ? orl_material_straight(material, cosine) : orl_gray(0);
    const struct orl_rgb back =
        lobes & ORL_LOBE_REFLECTED ? orl_glass_reflectance(material, cosine) : orl_gray(0);
    const double t = orl_luma(through), r = orl_luma(back);
    if (!(t + r > 0))
        return s;
    /* The larger of the two carries the absorbed share as weight: nothing is rolled for here. */
    const double p = t / (t + r);
    s.transmitted = orl_random_uniform(random) < p;
    s.event = s.transmitted ? ORL_EVENT_STRAIGHT : ORL_EVENT_MIRROR;
    s.direction = s.transmitted ? orl_neg(from) : mirrored(from, hit->normal);
    s.weight = s.transmitted ? orl_rgb_scale(through, 1 / p) : orl_rgb_scale(back, 1 / (1 - p));
    return s;
}

/* ---- BSDF ------------------------------------------------------------------------------------ */

struct orl_scatter orl_scatter_sample_bsdf(const struct orl_material *material,
                                           const struct orl_hit *hit, struct orl_vec3 from,
                                           enum orl_transport transport, enum orl_lobes lobes,
                                           const double u[3])
{
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    const struct orl_vec3 local = orl_to_local(&frame, from);
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED};
    struct orl_vec3 next;
    double pdf;
    const int sides = (lobes & ORL_LOBE_REFLECTED ? ORL_BSDF_REFLECT : 0) |
                      (lobes & ORL_LOBE_TRANSMITTED ? ORL_BSDF_TRANSMIT : 0);
    if (sides == 0 ||
        !(transport == ORL_TRANSPORT_LIGHT
              ? orl_bsdf_sample(material->bsdf, local, (enum orl_bsdf_side)sides, u, &next,
                                &s.weight, &pdf)
              : orl_bsdf_sample_adjoint(material->bsdf, local, (enum orl_bsdf_side)sides, u, &next,
                                        &s.weight, &pdf)))
        return s;
    s.event = ORL_EVENT_GLOSSY;
    s.transmitted = next.z * local.z < 0;
    s.direction = orl_to_world(&frame, next);
    return s;
}

/* ---- Plastic and metal ----------------------------------------------------------------------- */

/* Cosine-weighted about normal. */
static struct orl_vec3 sample_cosine(struct orl_vec3 normal, struct orl_random *random)
{
    const struct orl_frame frame = orl_frame_about(normal);
    const double u = orl_random_uniform(random), phi = 2 * ORL_PI * orl_random_uniform(random);
    const double r = sqrt(u);
    return orl_to_world(&frame, orl_v3(r * cos(phi), r * sin(phi), sqrt(1 - u)));
}

/* Ward's half vector by its density; false when the mirrored direction goes below the surface. */
static bool sample_ward(double roughness, struct orl_vec3 normal, struct orl_vec3 from,
                        struct orl_random *random, struct orl_vec3 *ret_direction,
                        double *ret_weight)
{
    const struct orl_frame frame = orl_frame_about(normal);
    const double tangent = roughness * sqrt(-log(1 - orl_random_uniform(random)));
    const double phi = 2 * ORL_PI * orl_random_uniform(random);
    const struct orl_vec3 half =
        orl_normalize(orl_to_world(&frame, orl_v3(tangent * cos(phi), tangent * sin(phi), 1)));
    const struct orl_vec3 d = mirrored(from, half);
    const double cos_in = orl_dot(from, normal), cos_out = orl_dot(d, normal);
    if (cos_out <= 0 || orl_dot(from, half) <= 0)
        return false;
    *ret_direction = d;
    *ret_weight = 2 * cos_out / (cos_in + cos_out);
    return true;
}

static struct orl_scatter sample_reflector(const struct orl_material *material,
                                           const struct orl_hit *hit, struct orl_vec3 from,
                                           enum orl_lobes lobes, struct orl_random *random)
{
    const struct orl_vec3 normal =
        orl_dot(from, hit->normal) >= 0 ? hit->normal : orl_neg(hit->normal);
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED};
    const struct orl_rgb diffuse =
        lobes & ORL_LOBE_DIFFUSE ? orl_material_diffuse(material) : orl_gray(0);
    const struct orl_rgb specular =
        lobes & ORL_LOBE_REFLECTED ? orl_material_specular(material) : orl_gray(0);
    const double d = orl_luma(diffuse), r = orl_luma(specular);
    double lobe = 1;
    if (!(d + r > 0))
        return s;
    const double p = d / (d + r);
    if (r <= 0 || orl_random_uniform(random) < p) {
        s.event = ORL_EVENT_DIFFUSE;
        s.direction = sample_cosine(normal, random);
        s.weight = orl_rgb_scale(diffuse, 1 / p);
        return s;
    }
    if (material->roughness <= 0) {
        s.event = ORL_EVENT_MIRROR;
        s.direction = mirrored(from, normal);
    } else if (sample_ward(material->roughness, normal, from, random, &s.direction, &lobe)) {
        s.event = ORL_EVENT_GLOSSY;
    }
    s.weight = orl_rgb_scale(specular, lobe / (1 - p));
    return s;
}

struct orl_scatter orl_scatter_sample(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 from,
                                      enum orl_transport transport, enum orl_lobes lobes,
                                      struct orl_random *random)
{
    switch (material->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
        return sample_reflector(material, hit, from, lobes, random);
    case ORL_MATERIAL_GLASS:
        return sample_glass(material, hit, from, lobes, random);
    case ORL_MATERIAL_BSDF: {
        const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
        const double u[3] = {u0, u1, orl_random_uniform(random)};
        return orl_scatter_sample_bsdf(material, hit, from, transport, lobes, u);
    }
    case ORL_MATERIAL_VOID:
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
        break;
    }
    return (struct orl_scatter){.event = ORL_EVENT_ABSORBED};
}

struct orl_rgb orl_scatter_eval_lobes(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 light,
                                      struct orl_vec3 eye)
{
    if (material->kind == ORL_MATERIAL_BSDF) {
        const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
        return orl_bsdf_eval(material->bsdf, orl_to_local(&frame, light),
                             orl_to_local(&frame, eye));
    }
    const double a2 = material->roughness * material->roughness;
    const double cos_light = orl_dot(light, hit->normal), cos_eye = orl_dot(eye, hit->normal);
    if (!is_opaque_reflector(material) || a2 <= 0 || cos_light * cos_eye <= 0)
        return orl_gray(0);
    const struct orl_vec3 half = orl_add(light, eye);
    const double h2 = orl_dot(half, half), hn = orl_dot(half, hit->normal), hn2 = hn * hn;
    const double tangent2 = fmax(0, (h2 - hn2) / hn2);
    return orl_rgb_scale(orl_material_specular(material),
                         exp(-tangent2 / a2) * h2 / (ORL_PI * a2 * hn2 * hn2));
}

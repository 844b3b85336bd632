/*
 * ashik2: a Lambertian colour and a lobe after Ashikhmin and Shirley ("An Anisotropic Phong BRDF
 * Model", 2000, equations 4, 6 to 10). Its half vectors are distributed as cos^e about the normal,
 * with different exponents e along the anisotropy axis and across. Sampling by this density loses
 * only the factor of the larger of the two cosines, so a lobe never gains energy.
 *
 * The lobe's reflectance rises towards grazing by Schlick's approximation at the half vector, up to
 * what the diffuse colour leaves of 1. This is reciprocal, and lobe and diffuse reflection together
 * never exceed 1. (In Radiance it rises by the eye's direction, up to 1, and only direct light
 * takes it from the diffuse colour.)
 */
#include "scene/material/kinds.h"

#include "scene/material/scatter.h"

struct lobe {
    struct orl_frame frame; /* u along the anisotropy axis */
    double along, across;   /* exponents */
};

static struct lobe lobe_at(const struct orl_material *m, struct orl_vec3 normal)
{
    const struct orl_ashikhmin *const ashikhmin = orl_ashikhmin_of(m);
    const struct orl_vec3 axis = ashikhmin->anisotropy_axis;
    const struct orl_vec3 flat = orl_madd(axis, normal, -orl_dot(axis, normal));
    const double along = ashikhmin->power[0], across = ashikhmin->power[1];
    if (!(orl_length(flat) > 1e-9 * orl_length(axis))) {
        /* An anisotropy axis along the normal has no direction in the surface: use one mean
         * exponent. */
        const double mean = 2 / (1 / (along + 1) + 1 / (across + 1)) - 1;
        return (struct lobe){orl_frame_about(normal), mean, mean};
    }
    const struct orl_vec3 u = orl_normalize(flat);
    return (struct lobe){{u, orl_cross(normal, u), normal}, along, across};
}

static double fifth(double x)
{
    return x * x * x * x * x;
}

struct orl_rgb orl_ashikhmin_diffuse(const struct orl_material *material, const struct orl_hit *hit)
{
    const struct orl_rgb c = orl_color_at(material, hit), gloss = orl_ashikhmin_of(material)->gloss;
    return (struct orl_rgb){orl_smaller(c.r, 1 - gloss.r), orl_smaller(c.g, 1 - gloss.g),
                            orl_smaller(c.b, 1 - gloss.b)};
}

/* Lobe reflectance for light at that cosine to the half vector. */
static struct orl_rgb gloss_at(const struct orl_material *material, struct orl_rgb diffuse,
                               double cosine)
{
    const double grown = fifth(1 - orl_smaller(cosine, 1));
    const struct orl_rgb gloss = orl_ashikhmin_of(material)->gloss;
    const struct orl_rgb sum = orl_rgb_add(gloss, diffuse);
    const struct orl_rgb left = {1 - sum.r, 1 - sum.g, 1 - sum.b};
    return orl_rgb_add(gloss, orl_rgb_scale(left, grown));
}

struct orl_rgb orl_ashikhmin_gloss(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 from)
{
    return gloss_at(material, orl_ashikhmin_diffuse(material, hit),
                    fabs(orl_dot(from, hit->normal)));
}

/* Density of unit half vectors, per steradian. */
static double density(const struct lobe *lobe, struct orl_vec3 half)
{
    const struct orl_vec3 h = orl_to_local(&lobe->frame, half);
    const double sine2 = h.x * h.x + h.y * h.y;
    const double power =
        sine2 > 0 ? (lobe->along * h.x * h.x + lobe->across * h.y * h.y) / sine2 : lobe->along;
    return sqrt((lobe->along + 1) * (lobe->across + 1)) / (2 * ORL_PI) *
           pow(orl_larger(h.z, 0), power);
}

/* f of the lobe about a normal; both directions lie on the normal's side. */
static struct orl_rgb lobe_between(const struct orl_material *m, struct orl_rgb diffuse,
                                   struct orl_vec3 normal, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct lobe lobe = lobe_at(m, normal);
    const struct orl_vec3 half = orl_normalize(orl_add(a, b));
    const double cosine = orl_dot(half, a);
    const double larger = orl_larger(orl_dot(a, normal), orl_dot(b, normal));
    return orl_rgb_scale(gloss_at(m, diffuse, cosine),
                         density(&lobe, half) / (4 * cosine * larger));
}

/* With a perturbed normal, light is weighted by the cosine to that normal (texture.h). */
struct orl_rgb orl_ashikhmin_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye)
{
    const double cos_light = orl_dot(light, hit->normal), cos_eye = orl_dot(eye, hit->normal);
    if (!(cos_light * cos_eye > 0))
        return orl_gray(0);
    const struct orl_rgb diffuse = orl_ashikhmin_diffuse(material, hit);
    const struct orl_vec3 normal = orl_normal_at(material, hit, eye);
    const double turned = orl_dot(light, normal);
    if (!(turned > 0) || !(orl_dot(eye, normal) > 0))
        return orl_gray(0);
    const struct orl_rgb f = lobe_between(material, diffuse, normal, light, eye);
    return material->texture ? orl_rgb_scale(f, turned / fabs(cos_light)) : f;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static void weigh_parts(const struct orl_bsdf_query *query, double *ret_diffuse, double *ret_gloss)
{
    *ret_diffuse = query->lobes & ORL_LOBE_DIFFUSE
                       ? orl_luma(orl_ashikhmin_diffuse(query->material, query->hit))
                       : 0;
    *ret_gloss = query->lobes & ORL_LOBE_REFLECTED
                     ? orl_luma(orl_ashikhmin_gloss(query->material, query->hit, query->from))
                     : 0;
}

static struct orl_vec3 facing(const struct orl_bsdf_query *query)
{
    const struct orl_vec3 normal = query->hit->normal;
    return orl_dot(query->from, normal) >= 0 ? normal : orl_neg(normal);
}

static struct orl_surface_sample sample_lobe(const struct orl_bsdf_query *query, const double u[2],
                                             double chance)
{
    const struct orl_vec3 normal = orl_normal_at(query->material, query->hit, query->from);
    const struct lobe lobe = lobe_at(query->material, normal);
    const double phi = 2 * ORL_PI * u[0];
    const double x = sqrt(lobe.across + 1) * cos(phi), y = sqrt(lobe.along + 1) * sin(phi);
    const double length = sqrt(x * x + y * y), c = x / length, s = y / length;
    const double z = pow(1 - u[1], 1 / (lobe.along * c * c + lobe.across * s * s + 1));
    const double sine = sqrt(orl_larger(1 - z * z, 0));
    const struct orl_vec3 half = orl_to_world(&lobe.frame, orl_v3(c * sine, s * sine, z));
    const double cosine = orl_dot(query->from, half);
    const struct orl_vec3 d = orl_sub(orl_scale(half, 2 * cosine), query->from);
    const double in = orl_dot(query->from, normal), out = orl_dot(d, normal);
    if (!(cosine > 0) || !(out > 0) || !(in > 0) || !(orl_dot(d, facing(query)) > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    const struct orl_rgb gloss =
        gloss_at(query->material, orl_ashikhmin_diffuse(query->material, query->hit), cosine);
    return (struct orl_surface_sample){
        .event = ORL_EVENT_GLOSSY,
        .direction = d,
        .weight = orl_rgb_scale(gloss, out / (orl_larger(in, out) * chance))};
}

struct orl_surface_sample orl_ashikhmin_sample(const struct orl_bsdf_query *query,
                                               const double u[3])
{
    double diffuse, gloss;
    weigh_parts(query, &diffuse, &gloss);
    if (!(diffuse + gloss > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    const double chance = diffuse / (diffuse + gloss);
    if (u[2] >= chance)
        return sample_lobe(query, u, 1 - chance);
    return (struct orl_surface_sample){
        .event = ORL_EVENT_DIFFUSE,
        .direction = orl_hemisphere_about(facing(query), u[0], u[1]),
        .weight = orl_rgb_scale(orl_ashikhmin_diffuse(query->material, query->hit), 1 / chance)};
}

double orl_ashikhmin_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    double diffuse, gloss;
    const double cosine = orl_dot(towards, facing(query));
    weigh_parts(query, &diffuse, &gloss);
    if (!(diffuse + gloss > 0) || !(cosine > 0))
        return 0;
    double sum = diffuse * cosine / ORL_PI;
    const struct orl_vec3 normal = orl_normal_at(query->material, query->hit, query->from);
    if (gloss > 0 && orl_dot(towards, normal) > 0 && orl_dot(query->from, normal) > 0) {
        const struct lobe lobe = lobe_at(query->material, normal);
        const struct orl_vec3 half = orl_normalize(orl_add(query->from, towards));
        sum += gloss * density(&lobe, half) / (4 * orl_dot(half, query->from));
    }
    return sum / (diffuse + gloss);
}

/*
 * Interfaces of two clear media: Fresnel's equations for unpolarised light, Snell's law, and
 * absorption in the media (Beer). media[0] lies behind the surface, media[1] in front of it.
 */
#include "scene/material/kinds.h"

static const struct orl_medium *medium(const struct orl_material *material, bool front)
{
    return &material->media[front ? 1 : 0];
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

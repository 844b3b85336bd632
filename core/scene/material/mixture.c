/*
 * Mixtures of two materials of different kinds. Every quantity is the sum of both, weighted by
 * their shares; or the plain sum, if they are terms of one material (WGMDfunc).
 *
 * Shares that depend on the ray's direction use the eye's direction, as in Radiance. Reflectance
 * then depends on the viewer, so such a mixture has no diffuse reflection that photon maps could
 * store. The diffuse reflection of its materials counts as a lobe as wide as the hemisphere; with a
 * texture, that lobe is weighted by the cosine to the perturbed normal.
 */
#include "scene/material/kinds.h"

bool orl_mixture_is_directed(const struct orl_material *material)
{
    const struct orl_pattern *const share = orl_mixture_of(material)->share;
    return share && share->directed;
}

bool orl_mixture_any(const struct orl_material *material,
                     bool (*is)(const struct orl_material *material))
{
    const struct orl_material *const mixed = orl_mixture_of(material)->mixed;
    return is(&mixed[0]) || is(&mixed[1]);
}

enum part { DIFFUSE, STRAIGHT, MIRRORED, ALBEDO, LOBES };

struct question {
    enum part part;
    struct orl_vec3 from, eye;
    enum orl_lobes lobes;
};

static struct orl_rgb query_material(const struct orl_mixture_callbacks *callbacks,
                                     const struct orl_material *m, const struct orl_hit *hit,
                                     const struct question *q)
{
    switch (q->part) {
    case DIFFUSE:
        return callbacks->diffuse(m, hit);
    case STRAIGHT:
        return callbacks->straight(m, hit, q->from);
    case MIRRORED:
        return callbacks->mirrored(m, hit, q->from);
    case ALBEDO:
        return callbacks->albedo(m, hit, q->from, q->lobes);
    case LOBES:
        return callbacks->lobes(m, hit, q->from, q->eye);
    }
    return orl_gray(0);
}

/* Skips a material whose share is 0. */
static struct orl_rgb sum_of(const struct orl_mixture_callbacks *callbacks,
                             const struct orl_material *material, const struct orl_hit *hit,
                             const struct question *q)
{
    const struct orl_material *const mixed = orl_mixture_of(material)->mixed;
    double shares[2];
    struct orl_rgb sum = orl_gray(0);
    orl_mixture_shares_at(material, hit, q->eye, shares);
    for (int i = 0; i < 2; i++)
        if (shares[i] > 0)
            sum = orl_rgb_add(
                sum, orl_rgb_scale(query_material(callbacks, &mixed[i], hit, q), shares[i]));
    return sum;
}

/* Returns the lobes to query in the two materials. If diffuse reflection is a lobe, it goes
 * together with the reflected ones. */
enum orl_lobes orl_mixture_lobes_within(const struct orl_material *material, enum orl_lobes lobes)
{
    if (!orl_mixture_is_directed(material))
        return lobes;
    return (enum orl_lobes)(lobes & ORL_LOBE_REFLECTED ? lobes | ORL_LOBE_DIFFUSE
                                                       : lobes & ORL_LOBE_TRANSMITTED);
}

/* Ratio of the perturbed normal's cosine to the true one, for light and an eye on the same side. */
static double turned_by(const struct orl_material *material, const struct orl_hit *hit,
                        struct orl_vec3 light, struct orl_vec3 eye)
{
    if (!material->texture)
        return 1;
    const double cosine = fabs(orl_dot(light, hit->normal));
    const double turned = fmax(orl_dot(light, orl_normal_at(material, hit, eye)), 0);
    return cosine > 1e-9 ? turned / cosine : 0;
}

struct orl_rgb orl_mixture_diffuse(const struct orl_mixture_callbacks *callbacks,
                                   const struct orl_material *material, const struct orl_hit *hit)
{
    if (orl_mixture_is_directed(material))
        return orl_gray(0);
    return sum_of(callbacks, material, hit,
                  &(struct question){.part = DIFFUSE, .eye = hit->normal});
}

struct orl_rgb orl_mixture_straight(const struct orl_mixture_callbacks *callbacks,
                                    const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 from)
{
    return sum_of(callbacks, material, hit,
                  &(struct question){.part = STRAIGHT, .from = from, .eye = from});
}

struct orl_rgb orl_mixture_mirrored(const struct orl_mixture_callbacks *callbacks,
                                    const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 from)
{
    return sum_of(callbacks, material, hit,
                  &(struct question){.part = MIRRORED, .from = from, .eye = from});
}

struct orl_rgb orl_mixture_albedo(const struct orl_mixture_callbacks *callbacks,
                                  const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light, enum orl_lobes lobes)
{
    const enum orl_lobes within = orl_mixture_lobes_within(material, lobes);
    return sum_of(callbacks, material, hit, &(struct question){ALBEDO, light, light, within});
}

struct orl_rgb orl_mixture_lobes(const struct orl_mixture_callbacks *callbacks,
                                 const struct orl_material *material, const struct orl_hit *hit,
                                 struct orl_vec3 light, struct orl_vec3 eye)
{
    const struct question lobes = {LOBES, light, eye, ORL_LOBE_ALL};
    const struct orl_rgb sum = sum_of(callbacks, material, hit, &lobes);
    if (!orl_mixture_is_directed(material) ||
        !(orl_dot(light, hit->normal) * orl_dot(eye, hit->normal) > 0))
        return sum;
    const struct orl_rgb even =
        sum_of(callbacks, material, hit, &(struct question){.part = DIFFUSE, .eye = eye});
    return orl_rgb_add(sum, orl_rgb_scale(even, turned_by(material, hit, light, eye) / ORL_PI));
}

/*
 * Returns the shares and the probability of sampling the first material; false if neither scatters
 * anything. Shares that depend on an outgoing direction which is not known yet are averaged with
 * 1/2.
 */
static bool weigh_materials(const struct orl_mixture_callbacks *callbacks,
                            const struct orl_bsdf_query *query, enum orl_lobes within,
                            double ret_shares[2], double *ret_chance)
{
    const struct orl_material *const m = query->material;
    const bool unknown = orl_mixture_is_directed(m) && query->transport == ORL_TRANSPORT_LIGHT;
    double sent[2];
    orl_mixture_shares_at(m, query->hit, query->from, ret_shares);
    for (int i = 0; i < 2; i++) {
        sent[i] = unknown ? (ret_shares[i] + 0.5) / 2 : ret_shares[i];
        if (sent[i] > 0)
            sent[i] *= orl_luma(
                callbacks->albedo(&orl_mixture_of(m)->mixed[i], query->hit, query->from, within));
    }
    *ret_chance = sent[0] / (sent[0] + sent[1]);
    return sent[0] + sent[1] > 0;
}

struct orl_surface_sample orl_mixture_sample(const struct orl_mixture_callbacks *callbacks,
                                             const struct orl_bsdf_query *query, const double u[3])
{
    const struct orl_material *const m = query->material;
    const enum orl_lobes within = orl_mixture_lobes_within(m, query->lobes);
    double shares[2], first;
    if (!weigh_materials(callbacks, query, within, shares, &first))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    const int which = u[2] < first ? 0 : 1;
    const double chance = which == 0 ? first : 1 - first;
    const double left = which == 0 ? u[2] / first : (u[2] - first) / (1 - first);
    const double rest[3] = {u[0], u[1], orl_smaller(left, 1 - 0x1p-53)};
    struct orl_surface_sample s = callbacks->sample(&orl_mixture_of(m)->mixed[which], query->hit,
                                                    query->from, query->transport, within, rest);
    if (s.event == ORL_EVENT_ABSORBED)
        return s;
    const bool backwards = query->transport == ORL_TRANSPORT_EYE;
    const struct orl_vec3 eye = backwards ? query->from : s.direction;
    const struct orl_vec3 light = backwards ? s.direction : query->from;
    if (orl_mixture_is_directed(m) && !backwards)
        orl_mixture_shares_at(m, query->hit, eye, shares);
    s.weight = orl_rgb_scale(s.weight, shares[which] / chance);
    if (orl_mixture_is_directed(m) && s.event == ORL_EVENT_DIFFUSE) {
        s.event = ORL_EVENT_GLOSSY;
        s.weight = orl_rgb_scale(s.weight, turned_by(m, query->hit, light, eye));
    }
    return s;
}

double orl_mixture_pdf(const struct orl_mixture_callbacks *callbacks,
                       const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    const enum orl_lobes within = orl_mixture_lobes_within(query->material, query->lobes);
    const struct orl_material *const mixed = orl_mixture_of(query->material)->mixed;
    double shares[2], first, sum = 0;
    if (!weigh_materials(callbacks, query, within, shares, &first))
        return 0;
    const double chances[2] = {first, 1 - first};
    for (int i = 0; i < 2; i++)
        if (chances[i] > 0)
            sum += chances[i] * callbacks->pdf(&mixed[i], query->hit, query->from, query->transport,
                                               within, towards);
    return sum;
}

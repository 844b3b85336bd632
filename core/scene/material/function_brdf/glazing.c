/*
 * Glazing by functions of the angle (BRTDfunc without lobes). The functions give the mirrored and
 * the directly transmitted share of each channel. Their argument is the cosine between the outgoing
 * direction and the front normal (negative behind). Diffuse scattering is constant: reflectances of
 * the front and the back, and one transmittance for both directions; these are lobes. Functions
 * whose sum exceeds 1, as approximations do at grazing, are scaled down to 1.
 */
#include "scene/material/kinds.h"

#include "scene/material/scatter.h"

enum part { STRAIGHT, MIRROR, REFLECTED, THROUGH, PARTS };

struct glazing {
    struct orl_rgb part[PARTS];
};

/* Specular shares of light from a direction. */
struct passes {
    struct orl_rgb mirrored, straight;
};

/* Both shares are 0 where a function has no value; otherwise they are scaled to what diffuse
 * scattering leaves. */
static struct passes passes_of(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 light)
{
    const struct orl_glazing *const glazing = orl_glazing_of(material);
    const struct orl_diffuse_parts *const diffuse = &glazing->diffuse;
    const double cosine = orl_dot(light, hit->normal);
    const struct orl_rgb even =
        orl_rgb_add(cosine > 0 ? diffuse->front : diffuse->back, diffuse->through);
    struct passes p = {{0, 0, 0}, {0, 0, 0}};
    double back[ORL_PATTERN_ANGLES], beyond[ORL_PATTERN_ANGLES];
    if (!orl_pattern_of_angle(glazing->angles, cosine, back) ||
        !orl_pattern_of_angle(glazing->angles, -cosine, beyond))
        return p;
    for (int c = 0; c < 3; c++) {
        const double mirrored = orl_larger(back[c], 0), straight = orl_larger(beyond[3 + c], 0);
        const double room = orl_larger(1 - (&even.r)[c], 0), sum = mirrored + straight;
        const double cut = sum > room ? room / sum : 1;
        (&p.mirrored.r)[c] = cut * mirrored;
        (&p.straight.r)[c] = cut * straight;
    }
    return p;
}

struct orl_rgb orl_glazing_mirrored(const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 eye)
{
    return passes_of(material, hit, eye).mirrored;
}

struct orl_rgb orl_glazing_straight(const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 eye)
{
    return passes_of(material, hit, orl_neg(eye)).straight;
}

bool orl_glazing_transmits_lobes(const struct orl_material *material)
{
    return orl_rgb_max(orl_glazing_of(material)->diffuse.through) > 0;
}

bool orl_glazing_has_lobes(const struct orl_material *material)
{
    const struct orl_diffuse_parts *const diffuse = &orl_glazing_of(material)->diffuse;
    return orl_rgb_max(diffuse->through) > 0 || orl_rgb_max(diffuse->front) > 0 ||
           orl_rgb_max(diffuse->back) > 0;
}

bool orl_glazing_is_window(const struct orl_material *material)
{
    return orl_glazing_of(material)->transmitted > 0 || orl_glazing_transmits_lobes(material);
}

struct orl_rgb orl_glazing_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                 struct orl_vec3 light, struct orl_vec3 eye)
{
    const double cos_light = orl_dot(light, hit->normal), cos_eye = orl_dot(eye, hit->normal);
    if (cos_light == 0 || cos_eye == 0)
        return orl_gray(0);
    const struct orl_diffuse_parts *const diffuse = &orl_glazing_of(material)->diffuse;
    const struct orl_rgb back = cos_light > 0 ? diffuse->front : diffuse->back;
    return orl_rgb_scale(cos_light * cos_eye > 0 ? back : diffuse->through, 1 / ORL_PI);
}

static struct glazing parts_of(const struct orl_material *m, const struct orl_hit *hit,
                               struct orl_vec3 from, enum orl_transport transport,
                               enum orl_lobes lobes)
{
    const struct orl_diffuse_parts *const diffuse = &orl_glazing_of(m)->diffuse;
    struct glazing g = {.part = {{0}}};
    if (lobes & ORL_LOBE_TRANSMITTED) {
        const struct orl_vec3 eye = transport == ORL_TRANSPORT_EYE ? from : orl_neg(from);
        g.part[STRAIGHT] = orl_glazing_straight(m, hit, eye);
        g.part[THROUGH] = diffuse->through;
    }
    if (lobes & ORL_LOBE_REFLECTED) {
        g.part[MIRROR] = orl_glazing_mirrored(m, hit, from);
        g.part[REFLECTED] = orl_dot(from, hit->normal) > 0 ? diffuse->front : diffuse->back;
    }
    return g;
}

struct orl_rgb orl_glazing_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light, enum orl_lobes lobes)
{
    const struct glazing g = parts_of(material, hit, light, ORL_TRANSPORT_LIGHT, lobes);
    struct orl_rgb sum = orl_gray(0);
    for (int i = 0; i < PARTS; i++)
        sum = orl_rgb_add(sum, g.part[i]);
    return sum;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static double sum_of(const struct glazing *g)
{
    double sum = 0;
    for (int i = 0; i < PARTS; i++)
        sum += orl_luma(g->part[i]);
    return sum;
}

static enum part choose_part(const struct glazing *g, double sum, double u)
{
    double passed = 0;
    enum part last = STRAIGHT;
    for (int i = 0; i < PARTS; i++) {
        const double luma = orl_luma(g->part[i]);
        passed += luma;
        if (luma > 0)
            last = (enum part)i;
        if (luma > 0 && u * sum < passed)
            return last;
    }
    return last;
}

struct orl_surface_sample orl_glazing_sample(const struct orl_bsdf_query *query, const double u[3])
{
    const struct glazing g =
        parts_of(query->material, query->hit, query->from, query->transport, query->lobes);
    const double sum = sum_of(&g);
    if (!(sum > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    const enum part part = choose_part(&g, sum, u[2]);
    const struct orl_vec3 normal = query->hit->normal, from = query->from;
    const struct orl_vec3 side = orl_dot(from, normal) >= 0 ? normal : orl_neg(normal);
    struct orl_surface_sample s = {.event = ORL_EVENT_GLOSSY,
                                   .transmitted = part == STRAIGHT || part == THROUGH,
                                   .weight =
                                       orl_rgb_scale(g.part[part], sum / orl_luma(g.part[part]))};
    if (part == STRAIGHT) {
        s.event = ORL_EVENT_STRAIGHT;
        s.direction = orl_neg(from);
    } else if (part == MIRROR) {
        s.event = ORL_EVENT_MIRROR;
        s.direction = orl_mirrored(from, normal);
    } else {
        s.direction = orl_hemisphere_about(part == REFLECTED ? side : orl_neg(side), u[0], u[1]);
    }
    return s;
}

double orl_glazing_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    const struct glazing g =
        parts_of(query->material, query->hit, query->from, query->transport, query->lobes);
    const double sum = sum_of(&g), cosine = orl_dot(towards, query->hit->normal);
    const bool back = cosine * orl_dot(query->from, query->hit->normal) > 0;
    if (!(sum > 0))
        return 0;
    return orl_luma(g.part[back ? REFLECTED : THROUGH]) / sum * fabs(cosine) / ORL_PI;
}

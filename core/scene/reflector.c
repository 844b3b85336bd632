#include "scene/kinds.h"

#include "scene/hemisphere.h"

static bool is_rough(const struct orl_material *material)
{
    return material->roughness[0] > 0;
}

struct orl_rgb orl_reflector_specular(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_METAL)
        return orl_rgb_scale(material->color, material->specular);
    return orl_gray(material->specular);
}

/* Ward's half vector by its density; false when the mirrored direction goes below the surface. */
static bool sample_ward(double roughness, struct orl_vec3 normal, struct orl_vec3 from,
                        const double u[2], struct orl_vec3 *ret_direction, double *ret_weight)
{
    const struct orl_frame frame = orl_frame_about(normal);
    const double tangent = roughness * sqrt(-log(1 - u[0]));
    const double phi = 2 * ORL_PI * u[1];
    const struct orl_vec3 half =
        orl_normalize(orl_to_world(&frame, orl_v3(tangent * cos(phi), tangent * sin(phi), 1)));
    const struct orl_vec3 d = orl_mirrored(from, half);
    const double cos_in = orl_dot(from, normal), cos_out = orl_dot(d, normal);
    if (cos_out <= 0 || orl_dot(from, half) <= 0)
        return false;
    *ret_direction = d;
    *ret_weight = 2 * cos_out / (cos_in + cos_out);
    return true;
}

struct orl_scatter orl_reflector_sample(const struct orl_draw *draw, const double u[3])
{
    const struct orl_material *m = draw->material;
    const struct orl_vec3 front = draw->hit->normal, from = draw->from;
    const struct orl_vec3 normal = orl_dot(from, front) >= 0 ? front : orl_neg(front);
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED};
    const struct orl_rgb diffuse =
        draw->lobes & ORL_LOBE_DIFFUSE ? orl_material_diffuse(m) : orl_gray(0);
    const struct orl_rgb specular =
        draw->lobes & ORL_LOBE_REFLECTED ? orl_reflector_specular(m) : orl_gray(0);
    const double d = orl_luma(diffuse), r = orl_luma(specular);
    double lobe = 1;
    if (!(d + r > 0))
        return s;
    const double p = d / (d + r);
    if (r <= 0 || u[2] < p) {
        s.event = ORL_EVENT_DIFFUSE;
        s.direction = orl_hemisphere_about(normal, u[0], u[1]);
        s.weight = orl_rgb_scale(diffuse, 1 / p);
        return s;
    }
    if (!is_rough(m)) {
        s.event = ORL_EVENT_MIRROR;
        s.direction = orl_mirrored(from, normal);
    } else if (sample_ward(m->roughness[0], normal, from, u, &s.direction, &lobe)) {
        s.event = ORL_EVENT_GLOSSY;
    }
    s.weight = orl_rgb_scale(specular, lobe / (1 - p));
    return s;
}

struct orl_rgb orl_reflector_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye)
{
    const double a2 = material->roughness[0] * material->roughness[0];
    const double cos_light = orl_dot(light, hit->normal), cos_eye = orl_dot(eye, hit->normal);
    if (a2 <= 0 || cos_light * cos_eye <= 0)
        return orl_gray(0);
    const struct orl_vec3 half = orl_add(light, eye);
    const double h2 = orl_dot(half, half), hn = orl_dot(half, hit->normal), hn2 = hn * hn;
    const double tangent2 = fmax(0, (h2 - hn2) / hn2);
    return orl_rgb_scale(orl_reflector_specular(material),
                         exp(-tangent2 / a2) * h2 / (ORL_PI * a2 * hn2 * hn2));
}

#include "scene/kinds.h"

struct orl_frame orl_bsdf_frame(const struct orl_material *material, struct orl_vec3 normal)
{
    struct orl_frame frame;
    frame.n = normal;
    frame.v = orl_normalize(orl_madd(material->up, normal, -orl_dot(material->up, normal)));
    frame.u = orl_cross(frame.v, frame.n);
    return frame;
}

static enum orl_bsdf_side sides_of(enum orl_lobes lobes)
{
    return (enum orl_bsdf_side)((lobes & ORL_LOBE_REFLECTED ? ORL_BSDF_REFLECT : 0) |
                                (lobes & ORL_LOBE_TRANSMITTED ? ORL_BSDF_TRANSMIT : 0));
}

struct orl_rgb orl_panel_lobes(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 light, struct orl_vec3 eye)
{
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    return orl_bsdf_eval(material->bsdf, orl_to_local(&frame, light), orl_to_local(&frame, eye));
}

struct orl_rgb orl_panel_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, enum orl_lobes lobes)
{
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    const enum orl_bsdf_side sides = sides_of(lobes);
    return sides ? orl_bsdf_albedo(material->bsdf, orl_to_local(&frame, light), sides)
                 : orl_gray(0);
}

struct orl_scatter orl_panel_sample(const struct orl_draw *draw, const double u[3])
{
    const struct orl_bsdf *bsdf = draw->material->bsdf;
    const struct orl_frame frame = orl_bsdf_frame(draw->material, draw->hit->normal);
    const struct orl_vec3 local = orl_to_local(&frame, draw->from);
    const enum orl_bsdf_side sides = sides_of(draw->lobes);
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED};
    struct orl_vec3 next;
    double pdf;
    if (sides == 0 ||
        !(draw->transport == ORL_TRANSPORT_LIGHT
              ? orl_bsdf_sample(bsdf, local, sides, u, &next, &s.weight, &pdf)
              : orl_bsdf_sample_adjoint(bsdf, local, sides, u, &next, &s.weight, &pdf)))
        return s;
    s.event = ORL_EVENT_GLOSSY;
    s.transmitted = next.z * local.z < 0;
    s.direction = orl_to_world(&frame, next);
    return s;
}

/* A mirror: specular on its front; its back is black. */
#include "scene/material/kinds.h"

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

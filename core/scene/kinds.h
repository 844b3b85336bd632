/*
 * The kinds of material behind scatter.h, one file each: what scatter.c dispatches to. Arguments
 * are as there; u holds three numbers in [0,1), the last of which chooses between parts.
 */
#ifndef ORL_SCENE_KINDS_H
#define ORL_SCENE_KINDS_H

#include "scene/scatter.h"

/* One draw's circumstances. */
struct orl_draw {
    const struct orl_material *material;
    const struct orl_hit *hit;
    struct orl_vec3 from;
    enum orl_transport transport;
    enum orl_lobes lobes;
};

static inline struct orl_vec3 orl_mirrored(struct orl_vec3 from, struct orl_vec3 normal)
{
    return orl_sub(orl_scale(normal, 2 * orl_dot(from, normal)), from);
}

/* glass.c: thin panes. */
struct orl_rgb orl_glass_transmittance(const struct orl_material *material, double cosine);
struct orl_rgb orl_glass_reflectance(const struct orl_material *material, double cosine);
struct orl_scatter orl_glass_sample(const struct orl_draw *draw, const double u[3]);

/* reflector.c: plastic, metal and what is made of the same lobes. */
struct orl_rgb orl_reflector_specular(const struct orl_material *material);
struct orl_rgb orl_reflector_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye);
struct orl_scatter orl_reflector_sample(const struct orl_draw *draw, const double u[3]);

/* panel.c: surfaces described by a BSDF. */
struct orl_rgb orl_panel_lobes(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 light, struct orl_vec3 eye);
struct orl_rgb orl_panel_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, enum orl_lobes lobes);
struct orl_scatter orl_panel_sample(const struct orl_draw *draw, const double u[3]);

#endif

/*
 * Textures: normals perturbed by functions (texfunc), by values on grids (texdata), or by a mesh's
 * corner normals. A function's value is added to the normal, in the function's coordinates without
 * their scale; several textures add up. The normalised sum is the shading normal, tilted back where
 * it would face away from the viewer.
 *
 * Mirror reflections and lobes use the shading normal everywhere, with directions kept above the
 * true surface: a mirror direction below it is replaced by the true surface's, a lobe's sample
 * below it is lost. For diffuse light only views use it: direct light by its cosine, the rest by
 * the irradiance gradient or by integrating the hemisphere. Further bounces and photons see such
 * surfaces as flat, so that no reflection gains or loses energy by a texture.
 *
 * References: "The RADIANCE Synthetic Imaging System", section 2.1.3; Veach 1997, section 5.3, on
 * shading normals and energy.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERNS_TEXTURE_H
#define ORL_SCENE_MATERIAL_PATTERNS_TEXTURE_H

#include "scene/geometry/geometry.h"

struct orl_pattern;

/* Returns the shading normal, unit, on the side of from; the true normal at orl_hit_surface_mean.
 */
struct orl_vec3 orl_texture_normal(const struct orl_pattern *texture, const struct orl_hit *hit,
                                   struct orl_vec3 from);

/* Returns the shading normal on the side of from; the true normal if there is no texture. */
static inline struct orl_vec3 orl_normal_at(const struct orl_material *material,
                                            const struct orl_hit *hit, struct orl_vec3 from)
{
    if (material->texture)
        return orl_texture_normal(material->texture, hit, from);
    return orl_dot(from, hit->normal) >= 0 ? hit->normal : orl_neg(hit->normal);
}

static inline struct orl_vec3 orl_mirrored(struct orl_vec3 from, struct orl_vec3 normal)
{
    return orl_sub(orl_scale(normal, 2 * orl_dot(from, normal)), from);
}

/* Cosine to the shading normal, with the sign of the true one. */
static inline double orl_cosine_at(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 from)
{
    const double plain = orl_dot(from, hit->normal);
    if (!material->texture)
        return plain;
    return copysign(orl_dot(from, orl_texture_normal(material->texture, hit, from)), plain);
}

/* Returns the mirror direction of from, above the true surface. */
static inline struct orl_vec3 orl_mirrored_at(const struct orl_material *material,
                                              const struct orl_hit *hit, struct orl_vec3 from)
{
    const struct orl_vec3 plain = orl_mirrored(from, hit->normal);
    if (!material->texture)
        return plain;
    const struct orl_vec3 turned =
        orl_mirrored(from, orl_texture_normal(material->texture, hit, from));
    return orl_dot(turned, hit->normal) * orl_dot(from, hit->normal) > 0 ? turned : plain;
}

#endif

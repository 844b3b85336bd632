/*
 * Textures: normals turned by functions (texfunc), by values on grids (texdata), or by what a mesh
 * says of its corners. What a function gives is added to the normal, in its own coordinates without
 * their scale; several add up. The sum's direction is the normal that light meets, turned about
 * where it would look away from who asks.
 *
 * It is for what is mirrored and for lobes wherever they are met, with directions kept above the
 * true surface: what a turned normal would mirror below is mirrored by the surface itself, what a
 * lobe would send there is lost. Of evenly scattered light it turns what views see: direct light by
 * its cosine, the rest by the gradient of irradiance, or folded at the surface. To what goes on
 * from there, and to photons, such surfaces are flat, so that no reflection gains or loses by a
 * texture.
 *
 * Reference: "The RADIANCE Synthetic Imaging System", section 2.1.3; on what turned normals do to
 * energy, Veach 1997, section 5.3.
 */
#ifndef ORL_SCENE_MATERIAL_TEXTURE_H
#define ORL_SCENE_MATERIAL_TEXTURE_H

#include "scene/geometry/geometry.h"

struct orl_pattern;

/* The turned normal, unit, on the side of from; the true one at a hit that is anywhere. */
struct orl_vec3 orl_texture_normal(const struct orl_pattern *texture, const struct orl_hit *hit,
                                   struct orl_vec3 from);

/* On the side of from, turned where the material has a texture. */
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

/* To the turned normal; its sign is that of the true one. */
static inline double orl_cosine_at(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 from)
{
    const double plain = orl_dot(from, hit->normal);
    if (!material->texture)
        return plain;
    return copysign(orl_dot(from, orl_texture_normal(material->texture, hit, from)), plain);
}

/* Where the surface mirrors light from there to, above it. */
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

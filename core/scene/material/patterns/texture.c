#include "scene/material/patterns/texture.h"

#include "scene/geometry/instances.h"
#include "scene/material/patterns/pattern.h"

/* Difference of the mesh's interpolated normal from the facet's; 0 before there are facets. */
static struct orl_vec3 smoothed(const struct orl_pattern *texture, const struct orl_hit *hit)
{
    const struct orl_surface *const s = orl_pattern_surface(texture, hit);
    const struct orl_vec3 *const normals = s ? orl_surface_normals(s) : NULL;
    double b, c;
    if (!normals)
        return orl_v3(0, 0, 0);
    orl_pattern_corners(texture, hit, &b, &c);
    const struct orl_vec3 sum =
        orl_madd(orl_madd(orl_scale(normals[0], 1 - b - c), normals[1], b), normals[2], c);
    const double length = orl_length(sum);
    return length > 0 ? orl_sub(orl_scale(sum, 1 / length), hit->normal) : orl_v3(0, 0, 0);
}

/* Perturbation that one texture adds to the front normal. */
static struct orl_vec3 turn_of(const struct orl_pattern *texture, const struct orl_hit *hit,
                               struct orl_vec3 from)
{
    double values[3];
    struct orl_vec3 sum = {0, 0, 0};
    if (texture->source == ORL_PATTERN_MESH_NORMALS)
        return smoothed(texture, hit);
    if (!orl_pattern_values(texture, hit, from, values))
        return sum;
    for (int i = 0; i < 3; i++)
        sum = orl_madd(sum, texture->row[i], values[i] * texture->scale);
    return isfinite(sum.x) && isfinite(sum.y) && isfinite(sum.z) ? sum : orl_v3(0, 0, 0);
}

/* The perturbed normal in the frame in which the surface was read. */
static struct orl_vec3 turned_normal(const struct orl_pattern *texture, const struct orl_hit *hit,
                                     struct orl_vec3 from)
{
    const bool front = orl_dot(from, hit->normal) >= 0;
    const struct orl_vec3 plain = front ? hit->normal : orl_neg(hit->normal);
    struct orl_vec3 sum = hit->normal;
    if (orl_hit_is_surface_mean(hit))
        return plain;
    for (const struct orl_pattern *t = texture; t; t = t->under)
        sum = orl_add(sum, turn_of(t, hit, from));
    const double length = orl_length(sum);
    if (!(length > 0) || !isfinite(length))
        return plain;
    sum = orl_scale(sum, (front ? 1 : -1) / length);
    const double cosine = orl_dot(sum, from);
    return cosine >= 0 ? sum : orl_normalize(orl_madd(sum, from, -2 * cosine));
}

struct orl_vec3 orl_texture_normal(const struct orl_pattern *texture, const struct orl_hit *hit,
                                   struct orl_vec3 from)
{
    const struct orl_geometry *const g = texture->geometry;
    if (hit->instance == 0 || !g || !orl_hit_is_instanced(g, hit))
        return turned_normal(texture, hit, from);
    const struct orl_hit read = orl_instance_to_prototype(g, hit);
    const struct orl_vec3 there = orl_instance_direction_in(g, hit, from);
    return orl_instance_direction_out(g, hit, turned_normal(texture, &read, there));
}

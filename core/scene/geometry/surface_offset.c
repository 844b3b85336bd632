#include "scene/geometry/geometry.h"

enum { MOST_SURFACES = 8, TOUCH_RAYS = 64 };

/*
 * Depth below a surface at which a sensor still counts as lying on it: rtrace -I starts rays as far
 * ahead, and coordinates written with six digits lie that low by rounding. In small scenes it is
 * limited to a small part of the size.
 */
static double sunk_in(const struct orl_geometry *g)
{
    return fmin(1.1e-4, g->radius * 0x1p-16);
}

/* Returns the rounding of a ray's origin to floats: some ulps of it, and one of the whole scene. */
static double rounding(const struct orl_geometry *g, struct orl_vec3 point)
{
    const double largest = fmax(fabs(point.x), fmax(fabs(point.y), fabs(point.z)));
    return largest * 0x1p-20 + g->radius * 0x1p-24;
}

struct orl_vec3 orl_offset_from_surface(const struct orl_geometry *g, struct orl_vec3 point,
                                        struct orl_vec3 normal)
{
    /* No facet's offset exceeds 2^-20 of the radius, so surfaces further away do not matter. */
    const double sunk = sunk_in(g), span = fmax(orl_geometry_resolution(g), 2 * sunk);
    struct orl_vec3 from = orl_madd(point, normal, span);
    double lift = rounding(g, point);
    for (int i = 0; i < MOST_SURFACES; i++) {
        struct orl_hit hit;
        const double left = orl_dot(orl_sub(from, point), normal) + span;
        if (!(left > 0) || !orl_geometry_intersect(g, from, orl_neg(normal), left, &hit))
            break;
        const double clear = 2 * orl_facet_offset(g, hit.facet);
        const double slope = fmax(0.25, fabs(orl_dot(hit.normal, normal)));
        const double height = orl_dot(orl_sub(hit.point, point), normal);
        if (fabs(height) * slope <= clear || (height > 0 && height * slope <= sunk))
            lift = fmax(lift, height + clear / slope);
        from = orl_hit_ray_origin(g, &hit, orl_neg(normal));
    }
    return orl_madd(point, normal, lift);
}

bool orl_find_surface_contact(const struct orl_geometry *g, struct orl_vec3 point,
                              struct orl_surface_contact *ret_touch)
{
    const double golden_angle = 2.399963229728653;
    bool touches = false;
    for (int i = 0; i < TOUCH_RAYS; i++) {
        const double z = 1 - (2 * i + 1.0) / TOUCH_RAYS, s = sqrt(1 - z * z);
        const struct orl_vec3 way = orl_v3(s * cos(golden_angle * i), s * sin(golden_angle * i), z);
        struct orl_hit hit;
        if (!orl_geometry_intersect(g, point, way, orl_geometry_resolution(g), &hit))
            continue;
        const double height = fabs(orl_dot(orl_sub(hit.point, point), hit.normal));
        if (!touches || height < ret_touch->distance)
            *ret_touch = (struct orl_surface_contact){hit.facet, height};
        touches = true;
    }
    return touches;
}

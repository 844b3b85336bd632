#include "scene/built/escape.h"

#include "scene/material/hemisphere.h"

enum { AT_ONCE = 64 };
static const double least_seen = 1e-3;  /* minimum share of escaping rays for an outside face */
static const double least_contrast = 4; /* minimum ratio of its share to the other face's */

/* Returns how many of n rays (at most AT_ONCE) leave from a side. */
static uint32_t count_leaving(const struct orl_geometry *g, uint32_t facet, bool front, uint32_t n,
                              struct orl_random *random)
{
    const struct orl_vec3 normal = orl_facet_normal(g, facet);
    const struct orl_frame frame = orl_frame_about(front ? normal : orl_neg(normal));
    uint32_t left = 0;
    double u[AT_ONCE][2];
    struct orl_vec3 points[AT_ONCE], directions[AT_ONCE];
    for (uint32_t k = 0; k < n; k++) {
        u[k][0] = orl_random_uniform(random);
        u[k][1] = orl_random_uniform(random);
        const double x = orl_random_uniform(random), y = orl_random_uniform(random);
        directions[k] = orl_to_world(&frame, orl_hemisphere_point(x, y));
    }
    orl_facet_sample_many(g, facet, (const double(*)[2])u, n, points);
    for (uint32_t k = 0; k < n; k++) {
        const struct orl_vec3 start = orl_facet_ray_origin(g, facet, points[k], normal, frame.n);
        left += !orl_geometry_occluded(g, start, directions[k], INFINITY);
    }
    return left;
}

void orl_escape_shares(const struct orl_geometry *geometry, uint32_t facet, uint32_t rays,
                       struct orl_random *random, double ret_shares[2])
{
    uint32_t left[2] = {0, 0}, sent = 0;
    while (sent < rays && !orl_escape_is_decided(left, sent)) {
        const uint32_t n = rays - sent < AT_ONCE ? rays - sent : AT_ONCE;
        for (int side = 0; side < 2; side++)
            left[side] += count_leaving(geometry, facet, side == 0, n, random);
        sent += n;
    }
    for (int side = 0; side < 2; side++)
        ret_shares[side] = (double)left[side] / sent;
}

bool orl_escape_shows_outside(const double shares[2])
{
    const double more = fmax(shares[0], shares[1]), less = fmin(shares[0], shares[1]);
    return more >= least_seen && more >= least_contrast * less;
}

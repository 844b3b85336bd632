#include "light/escape.h"

#include "scene/material/hemisphere.h"

enum { AT_ONCE = 64 };
static const double least_seen =
    1e-3; /* share of escaping rays that makes a face an outside face */
static const double least_contrast = 4; /* and how many times the other face's it must be */

double orl_escape_share(const struct orl_geometry *g, uint32_t facet, bool front, uint32_t rays,
                        struct orl_random *random)
{
    const struct orl_vec3 normal = orl_facet_normal(g, facet);
    const struct orl_frame frame = orl_frame_about(front ? normal : orl_neg(normal));
    uint32_t escaped = 0;
    for (uint32_t i = 0; i < rays; i += AT_ONCE) {
        const uint32_t n = rays - i < AT_ONCE ? rays - i : AT_ONCE;
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
            const struct orl_vec3 start = orl_facet_leave(g, facet, points[k], normal, frame.n);
            escaped += !orl_geometry_occluded(g, start, directions[k], INFINITY);
        }
    }
    return (double)escaped / rays;
}

bool orl_escape_tells(const double shares[2])
{
    const double more = fmax(shares[0], shares[1]), less = fmin(shares[0], shares[1]);
    return more >= least_seen && more >= least_contrast * less;
}

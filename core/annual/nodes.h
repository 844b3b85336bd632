/*
 * Nodes of the sun: where it is followed for light that comes by way of surfaces, with what lies
 * between interpolated. They lie on circles of declination, from the lowest that the sun has in the
 * hours given to the highest; on each evenly in hour angle from where it rises to where it sets, so
 * that no node is below the horizon, and low suns are not mixed with suns that are not there.
 *
 * Directions are of the sky: x east, y north, z up.
 */
#ifndef ORL_ANNUAL_NODES_H
#define ORL_ANNUAL_NODES_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/vec.h>

struct orl_sun_nodes {
    struct orl_vec3 *at; /* unit; circle by circle */
    size_t count;
    uint32_t circles, a_circle;             /* the latter odd */
    double latitude_rad, low_rad, high_rad; /* declinations of the first and the last circle */
};

/*
 * What of which nodes makes the light of a sun in between: a cubic in each of the two coordinates
 * (Catmull and Rom 1974); beside it what lies linearly between the nearest, and between those next
 * to them, by which it is told how rough the light is. Weights of each sum to 1; a cubic's may be
 * negative.
 */
enum { ORL_SUN_CORNERS = 16 };
struct orl_sun_between {
    uint32_t nodes[ORL_SUN_CORNERS];
    float weights[ORL_SUN_CORNERS], plain[ORL_SUN_CORNERS], wide[ORL_SUN_CORNERS];
};

/* For the suns given: count may be 0. steps: about how far nodes are to be apart. Returns 0 or
 * ORL_ERR_NOMEM; orl_sun_nodes_done in either case. */
struct orl_sun_spacing {
    double declination_deg, hour_angle_deg;
};
/* Where the sun does not set on some days, hour angles of setting change much from circle to
 * circle: then circles are denser. */
static inline struct orl_sun_spacing orl_sun_spacing_at(double latitude_deg,
                                                        struct orl_sun_spacing steps)
{
    if (fabs(latitude_deg) > 58)
        steps.declination_deg = fmin(steps.declination_deg, 1.5);
    return steps;
}
int orl_sun_nodes_init(struct orl_sun_nodes *nodes, double latitude_deg,
                       const struct orl_vec3 *suns, size_t count, struct orl_sun_spacing steps);
void orl_sun_nodes_done(struct orl_sun_nodes *nodes);

struct orl_sun_between orl_sun_nodes_between(const struct orl_sun_nodes *nodes,
                                             struct orl_vec3 sun);

#endif

/* Interpolation of the sun: its nodes, and the weights of each sun over nodes and beams. */
#ifndef ORL_ANNUAL_SUN_SUN_WEIGHTS_H
#define ORL_ANNUAL_SUN_SUN_WEIGHTS_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

#include "annual/sky/hours.h"
#include "annual/sun_map/sun_map.h"
#include "base/memory/memory.h"

/*
 * Nodes of the sun: the directions for which light by way of surfaces is computed. Suns between
 * them are interpolated. Nodes lie on circles of declination, from the lowest to the highest
 * declination of the given hours. On each circle they are spaced evenly in hour angle from sunrise
 * to sunset. Thus no node is below the horizon, and low suns are not mixed with suns that have set.
 *
 * Directions are in sky axes: x east, y north, z up.
 */

struct orl_sun_grid {
    struct orl_vec3 *at; /* unit vectors, circle by circle */
    size_t count;
    uint32_t circles, nodes_per_circle;     /* number of circles, and nodes per circle (odd) */
    double latitude_rad, low_rad, high_rad; /* declinations of the first and the last circle */
};

/*
 * Interpolation weights of the nodes for a sun between them. weights is cubic in both coordinates
 * (Catmull and Rom 1974). plain is linear between the nearest nodes, wide linear between the next
 * ones; their differences estimate the roughness of the light. Each set of weights sums to 1; cubic
 * weights may be negative.
 */
enum { ORL_SUN_CORNERS = 16 };
struct orl_sun_interpolation {
    uint32_t nodes[ORL_SUN_CORNERS];
    float weights[ORL_SUN_CORNERS], plain[ORL_SUN_CORNERS], wide[ORL_SUN_CORNERS];
};

/* Approximate distance between nodes. */
struct orl_sun_spacing {
    double declination_deg, hour_angle_deg;
};
/* Returns the spacing for a latitude. Where the sun does not set on some days, hour angles of
 * sunset change quickly with declination, so circles are denser. */
static inline struct orl_sun_spacing orl_sun_spacing_at(double latitude_deg,
                                                        struct orl_sun_spacing steps)
{
    if (fabs(latitude_deg) > 58)
        steps.declination_deg = fmin(steps.declination_deg, 1.5);
    return steps;
}
/* Builds the nodes for the given suns; count may be 0. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_sun_grid_done in either case. */
int orl_sun_grid_init(struct orl_sun_grid *nodes, double latitude_deg, const struct orl_vec3 *suns,
                      size_t count, struct orl_sun_spacing steps);
void orl_sun_grid_done(struct orl_sun_grid *nodes);

struct orl_sun_interpolation orl_sun_grid_interpolate(const struct orl_sun_grid *nodes,
                                                      struct orl_vec3 sun);

/*
 * Interpolation weights of each sun (hours.h) over nodes and over beams (sun_map.h). Weights of
 * beams also contain the ratio of the flux that the ports let in from the sun to that of the nodes.
 * Thus the cosine at a window, the transmittance of its pane, and shadows from outside
 * (sun_beams.h) are those of the hour.
 *
 * Immutable once made.
 */

struct orl_sun_weights {
    struct orl_arrays arrays; /* the four below */
    uint32_t n_window_groups; /* window groups (annual_scene.h) */
    size_t n_lost;            /* suns that light ports which no node lights; that light is lost */
    /* Indices into the next three: [sun][0] is the first weight of nodes, [sun][1 + window group]
     * the first of beams of a window group. One more index ends the list. */
    uint32_t *first;
    uint32_t *which; /* node or beam */
    float *weights;
    float *difference; /* difference of weights from the wide interpolation's */
};

/* Weights from first to end. */
struct orl_sun_weight_range {
    uint32_t first, end;
};
static inline struct orl_sun_weight_range
orl_sun_weights_of_nodes(const struct orl_sun_weights *sun_weights, size_t sun)
{
    const uint32_t *first = sun_weights->first + sun * (1 + sun_weights->n_window_groups);
    return (struct orl_sun_weight_range){first[0], first[1]};
}
static inline struct orl_sun_weight_range
orl_sun_weights_of_beams(const struct orl_sun_weights *sun_weights, size_t sun,
                         uint32_t window_group)
{
    const uint32_t *first =
        sun_weights->first + sun * (1 + sun_weights->n_window_groups) + 1 + window_group;
    return (struct orl_sun_weight_range){first[0], first[1]};
}

/* map may be NULL. n_window_groups: window groups of the map's beams. Returns 0, ORL_ERR_NOMEM or
 * _CANCELLED; the caller calls orl_sun_weights_done in either case. */
int orl_sun_weights_init(struct orl_sun_weights *sun_weights, const struct orl_year_suns *suns,
                         const struct orl_sun_grid *nodes, const struct orl_frame *node_frames,
                         const struct orl_sun_map *map, const struct orl_sobol *sobol,
                         uint32_t n_window_groups, struct orl_thread_pool *pool);
/* Allocates the arrays, without `first` if it is there already; arrays.failed is true when out of
 * memory. */
void orl_sun_weights_allocate(struct orl_sun_weights *sun_weights, size_t n_firsts,
                              size_t n_weights);
static inline void orl_sun_weights_done(struct orl_sun_weights *sun_weights)
{
    orl_arrays_free(&sun_weights->arrays);
}

#endif

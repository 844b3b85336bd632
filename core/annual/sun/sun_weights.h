/*
 * Interpolation weights of each sun (hours.h) over nodes and over beams (sun_map.h). Weights of
 * beams also contain the ratio of the flux that the ports let in from the sun to that of the nodes.
 * Thus the cosine at a window, the transmittance of its pane, and shadows from outside
 * (port_shadows.h) are those of the hour.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_SUN_WEIGHTS_H
#define ORL_ANNUAL_SUN_SUN_WEIGHTS_H

#include "annual/sky/hours.h"
#include "annual/sun/sun_grid.h"
#include "annual/sun_map/sun_map.h"

struct orl_sun_weights {
    uint32_t n_window_groups; /* window groups (window_group_ports.h) */
    size_t n_lost;            /* suns that light ports which no node lights; that light is lost */
    /* Indices into the next three: [sun][0] is the first weight of nodes, [sun][1 + window group]
     * the first of beams of a window group. One more index ends the list. */
    uint32_t *first;
    uint32_t *which; /* node or beam */
    float *weights;
    float *difference; /* difference of weights from the wide interpolation's (sun_grid.h) */
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

/* map may be NULL. n_parts: window groups of the map's beams. Returns 0, ORL_ERR_NOMEM or
 * _CANCELLED; the caller calls orl_sun_weights_done in either case. */
int orl_sun_weights_init(struct orl_sun_weights *sun_weights, const struct orl_year_suns *suns,
                         const struct orl_sun_grid *nodes, const struct orl_frame *node_frames,
                         const struct orl_sun_map *map, const struct orl_sobol *sobol,
                         uint32_t n_window_groups, struct orl_thread_pool *pool);
void orl_sun_weights_done(struct orl_sun_weights *sun_weights);

#endif

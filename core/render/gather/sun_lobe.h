/*
 * Beams: where the lobes of a kind of pane send a sun, as a table over the directions on the far
 * side, for importance sampling. From a place only the directions towards the pane count. A
 * direction is drawn by descending the table: at each level one of four quarters is chosen by its
 * light, without the quarters that cannot come from the pane.
 *
 * The table may be inexact and incomplete: another strategy reaches every direction
 * (direction_sampling.h), and a ray is weighed by the densities of both. Constant once made.
 */
#ifndef ORL_RENDER_GATHER_SUN_LOBE_H
#define ORL_RENDER_GATHER_SUN_LOBE_H

#include <oriel/base/thread_pool.h>

#include "base/sampling/sobol.h"
#include "light/lit_scene.h"

enum { ORL_SUN_LOBE_LEVELS = 7, ORL_SUN_LOBE_SIDE = 1 << (ORL_SUN_LOBE_LEVELS - 1) };
enum {
    ORL_SUN_LOBE_CELLS = ((1 << 2 * ORL_SUN_LOBE_LEVELS) - 1) / 3
}; /* cells of all levels, coarsest first */

/* Directions of all cells, in a pane's frame; z points away from the pane on the far side. */
struct orl_sun_lobe_cells {
    float direction[ORL_SUN_LOBE_CELLS][3], radius[ORL_SUN_LOBE_CELLS];
};

/* A sun in a kind of pane. Panes of one material that face alike share a sun lobe. */
struct orl_sun_lobe {
    const struct orl_material *material; /* borrowed from the world */
    struct orl_vec3 normal;
    const struct orl_sun *sun;       /* borrowed from the world */
    struct orl_frame frame;          /* n points to the far side */
    float light[ORL_SUN_LOBE_CELLS]; /* share of the total */
};

/* The bounding rectangle of a pane, in a sun lobe's frame. */
struct orl_window_lobe {
    uint32_t sun_lobe, facet;
    struct orl_vec3 center;
    double half_u, half_v;
};

void orl_sun_lobe_cells_init(struct orl_sun_lobe_cells *cells);

/* Fills in all fields but material, normal and sun, which the caller sets. The result does not
 * depend on the crew. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_sun_lobe_init(struct orl_sun_lobe *sun_lobe, const struct orl_sobol *sobol,
                      struct orl_thread_pool *pool);

struct orl_window_lobe orl_window_lobe_make(const struct orl_geometry *geometry,
                                            const struct orl_sun_lobe *sun_lobe, uint32_t index,
                                            uint32_t facet);

/* Draws a direction from a place towards the pane, against its sun lobe. Returns false if no light
 * from the pane reaches the place. u: two numbers in [0,1). */
bool orl_window_lobe_sample(const struct orl_window_lobe *window_lobe,
                            const struct orl_sun_lobe *sun_lobe,
                            const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                            const double u[2], struct orl_vec3 *ret_direction);

/* Returns the density, per steradian, of orl_window_lobe_sample. */
double orl_window_lobe_pdf(const struct orl_window_lobe *window_lobe,
                           const struct orl_sun_lobe *sun_lobe,
                           const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                           struct orl_vec3 direction);

#endif

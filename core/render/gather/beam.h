/*
 * Beams: where the lobes of a kind of pane send a sun, as a table over the directions on the far
 * side, for importance sampling. From a place only the directions towards the pane count. A
 * direction is drawn by descending the table: at each level one of four quarters is chosen by its
 * light, without the quarters that cannot come from the pane.
 *
 * The table may be inexact and incomplete: another strategy reaches every direction (aim.h), and a
 * ray is weighed by the densities of both. Constant once made.
 */
#ifndef ORL_RENDER_GATHER_BEAM_H
#define ORL_RENDER_GATHER_BEAM_H

#include <oriel/crew.h>

#include "base/sobol.h"
#include "light/world.h"

enum { ORL_BEAM_LEVELS = 7, ORL_BEAM_SIDE = 1 << (ORL_BEAM_LEVELS - 1) };
enum {
    ORL_BEAM_CELLS = ((1 << 2 * ORL_BEAM_LEVELS) - 1) / 3
}; /* cells of all levels, coarsest first */

/* Directions of all cells, in a pane's frame; z points away from the pane on the far side. */
struct orl_beam_cells {
    float direction[ORL_BEAM_CELLS][3], radius[ORL_BEAM_CELLS];
};

/* A sun in a kind of pane. Panes of one material that face alike share a beam. */
struct orl_beam {
    const struct orl_material *material; /* borrowed from the world */
    struct orl_vec3 normal;
    const struct orl_sun *sun;   /* borrowed from the world */
    struct orl_frame frame;      /* n points to the far side */
    float light[ORL_BEAM_CELLS]; /* share of the total */
};

/* The bounding rectangle of a pane, in a beam's frame. */
struct orl_shaft {
    uint32_t beam, facet;
    struct orl_vec3 center;
    double half_u, half_v;
};

void orl_beam_cells_init(struct orl_beam_cells *cells);

/* Fills in all fields but material, normal and sun, which the caller sets. The result does not
 * depend on the crew. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_beam_init(struct orl_beam *beam, const struct orl_sobol *sobol, struct orl_crew *crew);

struct orl_shaft orl_shaft_of(const struct orl_geometry *geometry, const struct orl_beam *beam,
                              uint32_t index, uint32_t facet);

/* Draws a direction from a place towards the pane, against its beam. Returns false if no light from
 * the pane reaches the place. u: two numbers in [0,1). */
bool orl_shaft_draw(const struct orl_shaft *shaft, const struct orl_beam *beam,
                    const struct orl_beam_cells *cells, struct orl_vec3 point, const double u[2],
                    struct orl_vec3 *ret_direction);

/* Returns the density, per steradian, of orl_shaft_draw. */
double orl_shaft_density(const struct orl_shaft *shaft, const struct orl_beam *beam,
                         const struct orl_beam_cells *cells, struct orl_vec3 point,
                         struct orl_vec3 direction);

#endif

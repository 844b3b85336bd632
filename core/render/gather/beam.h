/*
 * Beams: where the lobes of a kind of pane send a sun, as a table over the directions on the far
 * side, for rays to be aimed by. From a place only those directions count that come from the pane:
 * a direction is drawn by going down the table, halving it both ways at each step, by how much
 * light each quarter holds, quarters that cannot come from the pane left out.
 *
 * The table need not be right, nor what is left out: another way of aiming reaches every direction
 * (aim.h), and a ray weighs by the densities of both. Constant once made.
 */
#ifndef ORL_RENDER_GATHER_BEAM_H
#define ORL_RENDER_GATHER_BEAM_H

#include <oriel/crew.h>

#include "base/sobol.h"
#include "light/world.h"

enum { ORL_BEAM_LEVELS = 7, ORL_BEAM_SIDE = 1 << (ORL_BEAM_LEVELS - 1) };
enum { ORL_BEAM_CELLS = ((1 << 2 * ORL_BEAM_LEVELS) - 1) / 3 }; /* of all levels, coarsest first */

/* The directions of all cells, in a pane's frame, z away from it on the far side. */
struct orl_beam_cells {
    float direction[ORL_BEAM_CELLS][3], radius[ORL_BEAM_CELLS];
};

/* A sun in a kind of pane: panes of one material that face alike send it the same ways. */
struct orl_beam {
    const struct orl_material *material; /* borrowed from the world */
    struct orl_vec3 normal;
    const struct orl_sun *sun;   /* borrowed from the world */
    struct orl_frame frame;      /* n: to the far side */
    float light[ORL_BEAM_CELLS]; /* share of all */
};

/* A pane as a rectangle about it, in a beam's frame. */
struct orl_shaft {
    uint32_t beam, facet;
    struct orl_vec3 center;
    double half_u, half_v;
};

void orl_beam_cells_init(struct orl_beam_cells *cells);

/*
 * Fills in all but what the caller has: material, normal, sun. The same
 * for any crew. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_beam_init(struct orl_beam *beam, const struct orl_sobol *sobol, struct orl_crew *crew);

struct orl_shaft orl_shaft_of(const struct orl_geometry *geometry, const struct orl_beam *beam,
                              uint32_t index, uint32_t facet);

/*
 * A direction from a place towards the pane, against its beam; false when no light of the pane's
 * comes there. u: two numbers in [0,1).
 */
bool orl_shaft_draw(const struct orl_shaft *shaft, const struct orl_beam *beam,
                    const struct orl_beam_cells *cells, struct orl_vec3 point, const double u[2],
                    struct orl_vec3 *ret_direction);

/* The density, per steradian, with which that is drawn. */
double orl_shaft_density(const struct orl_shaft *shaft, const struct orl_beam *beam,
                         const struct orl_beam_cells *cells, struct orl_vec3 point,
                         struct orl_vec3 direction);

#endif

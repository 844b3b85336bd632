/*
 * The cell that stands for an endless panel: rays that leave it by a side come in by the opposite
 * one. Nothing is copied, and nothing outside the cell is met.
 *
 * What lies in a side itself belongs to the cell, too: rays go beyond a side by a margin, and come
 * in by as much in front of the opposite one, so that walls in either are met, one after the other.
 * The margin is a few times what rays start clear of surfaces by (orl_hit_leave), and is all by
 * which the panel's period is too long.
 *
 * Moved coordinates (scene/geometry/geometry.h). Immutable.
 */
#ifndef ORL_GONIOMETER_CELL_H
#define ORL_GONIOMETER_CELL_H

#include "light/path.h"

struct orl_gonio_cell {
    struct orl_vec3 low, high; /* margins included */
    double margin;
};

/* With these sides in x and y (from, to, from, to), around the geometry in z. */
struct orl_gonio_cell orl_gonio_cell_around(const struct orl_geometry *geometry,
                                            const double sides[4]);

/* A place beside the panel, on its front or back; u in [0,1)^2. */
struct orl_vec3 orl_gonio_cell_place(const struct orl_gonio_cell *cell, bool front,
                                     const double u[2]);

enum orl_gonio_meeting {
    ORL_GONIO_SURFACE,
    ORL_GONIO_BACK,  /* it left, towards z < 0 */
    ORL_GONIO_FRONT, /* or z > 0 */
    ORL_GONIO_LOST   /* it went on from side to side for too long */
};

/* What the path comes to; its origin becomes where it last came in. */
enum orl_gonio_meeting orl_gonio_meet(const struct orl_gonio_cell *cell,
                                      const struct orl_world *world, struct orl_path *path,
                                      struct orl_hit *ret_hit);

#endif

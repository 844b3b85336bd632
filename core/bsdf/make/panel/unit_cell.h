/*
 * The unit cell of an endless panel with periodic boundaries: rays that leave by a side come in by
 * the opposite one. Nothing is copied, and nothing outside the cell is hit.
 *
 * Surfaces in a side belong to the cell. Rays go beyond a side by a margin, and come in by as much
 * in front of the opposite one. Walls in either side are thus hit, one after the other. The margin
 * is a few times the offset of ray origins from surfaces (orl_hit_ray_origin). The panel's period
 * is too long by the margins only.
 *
 * Moved coordinates (scene/geometry/geometry.h). Immutable.
 */
#ifndef ORL_BSDF_MAKE_PANEL_UNIT_CELL_H
#define ORL_BSDF_MAKE_PANEL_UNIT_CELL_H

#include "light/path.h"

struct orl_gonio_unit_cell {
    struct orl_vec3 low, high; /* bounds, including margins */
    double margin;
};

/* Makes the cell with these sides in x and y (from, to, from, to), around the geometry in z. */
struct orl_gonio_unit_cell orl_gonio_unit_cell_around(const struct orl_geometry *geometry,
                                                      const double sides[4]);

/* Returns a place beside the panel, on its front or back; u in [0,1)^2. */
struct orl_vec3 orl_gonio_unit_cell_entry(const struct orl_gonio_unit_cell *cell, bool front,
                                          const double u[2]);

enum orl_gonio_crossing {
    ORL_GONIO_HIT_SURFACE,
    ORL_GONIO_LEFT_BACK,     /* left towards z < 0 */
    ORL_GONIO_LEFT_FRONT,    /* left towards z > 0 */
    ORL_GONIO_MANY_CROSSINGS /* crossed too many sides */
};

/* Follows the path to the next surface or out of the panel. Its origin becomes the place where it
 * last came in. */
enum orl_gonio_crossing orl_gonio_unit_cell_intersect(const struct orl_gonio_unit_cell *cell,
                                                      const struct orl_lit_scene *lit_scene,
                                                      struct orl_path *path,
                                                      struct orl_hit *ret_hit);

#endif

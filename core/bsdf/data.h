/* Kinds of data in a file, and the coordinates of a direction for each kind. */
#ifndef ORL_BSDF_DATA_H
#define ORL_BSDF_DATA_H

#include "bsdf/matrix/basis.h"
#include "bsdf/tree/iso.h"
#include "bsdf/tree/shirley.h"

enum orl_structure {
    ORL_STRUCTURE_NONE,
    ORL_STRUCTURE_TREE3,
    ORL_STRUCTURE_TREE4,
    ORL_STRUCTURE_MATRIX
};

/* Computed once for a direction and used for all components. */
struct orl_coords {
    union {
        struct orl_square square;   /* TREE4 */
        struct orl_disk_polar disk; /* TREE3 */
        struct orl_polar polar;     /* MATRIX */
    };
};

static inline struct orl_coords orl_coords_of(enum orl_structure structure,
                                              struct orl_vec3 direction)
{
    struct orl_coords coords;
    if (structure == ORL_STRUCTURE_TREE4)
        coords.square = orl_disk_to_square(direction.x, direction.y);
    else if (structure == ORL_STRUCTURE_TREE3)
        coords.disk = orl_disk_polar_of(direction);
    else
        coords.polar = orl_polar_of(direction);
    return coords;
}

#endif

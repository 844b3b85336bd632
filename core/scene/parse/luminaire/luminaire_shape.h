/* Shape of a luminaire's luminous opening, from the sizes in its IES file. */
#ifndef ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRE_SHAPE_H
#define ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRE_SHAPE_H

#include "scene/generate/generate.h"
#include "scene/grid/ies.h"

/* Lower bound of sizes. */
#define ORL_LUMINAIRE_MIN_M 1e-3

enum orl_luminaire_body { ORL_LUMINAIRE_BOX, ORL_LUMINAIRE_DISC, ORL_LUMINAIRE_BALL };

/* In metres: along x, along y, height. For round shapes length and width are the diameter. */
struct orl_luminaire_shape {
    enum orl_luminaire_body body;
    double length, width, height;
};

/* Interprets the signs of the sizes by the edition of LM-63: before 1995, of 1995, since 2002.
 * Returns false if they mean no shape. Adds a warning to text if a shape is approximated. */
bool orl_luminaire_shape_of(const struct orl_ies *ies, struct orl_text *text,
                            struct orl_luminaire_shape *ret);

#endif

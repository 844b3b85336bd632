/* What shines of a luminaire: its opening's shape, by the sizes that its IES file gives. */
#ifndef ORL_SCENE_PARSE_LUMINAIRE_SHAPE_H
#define ORL_SCENE_PARSE_LUMINAIRE_SHAPE_H

#include "scene/generate/generate.h"
#include "scene/grid/ies.h"

/* Nothing is smaller. */
#define ORL_LUMINAIRE_LEAST_M 1e-3

enum orl_luminaire_body { ORL_LUMINAIRE_BOX, ORL_LUMINAIRE_DISC, ORL_LUMINAIRE_BALL };

/* In metres: along x, along y, height; of round ones both are the width. */
struct orl_luminaire_shape {
    enum orl_luminaire_body body;
    double length, width, height;
};

/* What LM-63 means by negative sizes, before 1995, of then, and since 2002. False: nothing. Warns
 * in text of what is put in place of others. */
bool orl_luminaire_shape_of(const struct orl_ies *ies, struct orl_text *text,
                            struct orl_luminaire_shape *ret);

#endif

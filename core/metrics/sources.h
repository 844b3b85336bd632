/*
 * Glare sources in a picture: pixels brighter than a threshold, put together where no more than
 * half the search radius lies between them (evalglare's -r is an opening angle, whatever its manual
 * says); if asked for, pixels around which a source fills more than a fifth of a disc; and peaks,
 * pixels above a second threshold, taken out of their source and put together likewise.
 *
 * A source's place is the mean of its pixels' by luminance and solid angle, in the picture; its
 * position index is that of the direction there. Sources come by what they add to DGP, the most
 * first; equal ones in the order of their first pixels.
 *
 * The disc for smoothing is the same over the whole picture: of the radius's pixels about the
 * picture's middle, by 1.75, as evalglare has it. A pixel that two sources claim goes to the one
 * with more of the disc.
 *
 * Reference for the behaviour: Wienold, evalglare's manual (Radiance), versions 2.10 and 3.06.
 */
#ifndef ORL_METRICS_SOURCES_H
#define ORL_METRICS_SOURCES_H

#include <stdatomic.h>

#include <oriel/glare.h>

#include "metrics/field.h"

/* Luminances in cd/m2, as many as the field has pixels. */
struct orl_luminances {
    const struct orl_field *field;
    const float *cd_m2;
    const atomic_bool *cancel; /* borrowed; NULL: never */
};

struct orl_source_rule {
    double threshold_cd_m2;
    double radius_rad;
    bool smooth, at_whole_pixels;
    double peak_cd_m2; /* INFINITY: none */
};

/* Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; *ret_sources is owned. */
int orl_find_sources(const struct orl_luminances *picture, const struct orl_source_rule *rule,
                     struct orl_glare_source **ret_sources, size_t *ret_count,
                     struct orl_error *err);

#endif

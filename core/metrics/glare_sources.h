/*
 * Finds glare sources in a picture. Pixels above a threshold are grouped if the gap between them is
 * at most half the search radius (evalglare's -r is an opening angle, in spite of its manual). With
 * `smooth`, pixels are added if a source fills more than a fifth of a disc around them. Peaks,
 * pixels above a second threshold, are removed from their source and grouped in the same way.
 *
 * A source's position in the picture is the mean of its pixels' positions, weighted by luminance
 * and solid angle. Its position index is that of the direction there. Sources are sorted by their
 * contribution to DGP, largest first; equal ones by their first pixels.
 *
 * The disc for smoothing has the same size in the whole picture: the radius in pixels at the
 * picture's middle, divided by 1.75, as in evalglare. A pixel that two sources claim goes to the
 * one with the larger part of the disc.
 *
 * Reference for the behaviour: Wienold, evalglare's manual (Radiance), versions 2.10 and 3.06.
 */
#ifndef ORL_METRICS_GLARE_SOURCES_H
#define ORL_METRICS_GLARE_SOURCES_H

#include <stdatomic.h>

#include <oriel/job/glare.h>

#include "metrics/view_field.h"

/* Luminances in cd/m2, one for each pixel of the field. */
struct orl_luminances {
    const struct orl_view_field *field;
    const float *cd_m2;
    const atomic_bool *cancel; /* borrowed; may be NULL */
};

struct orl_glare_source_rule {
    double threshold_cd_m2;
    double radius_rad;
    bool smooth, at_whole_pixels;
    double peak_cd_m2; /* INFINITY: none */
};

/* Finds the sources. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; *ret_sources is owned. */
int orl_glare_sources_find(const struct orl_luminances *picture,
                           const struct orl_glare_source_rule *rule,
                           struct orl_glare_source **ret_sources, size_t *ret_count,
                           struct orl_error *err);

#endif

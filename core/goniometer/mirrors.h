/*
 * Mirrors that a panel has, by its looks: rays from all over the cell come to the same as their
 * images in its middle do, at the same distance, of the same material, from the same side. What so
 * many rays all miss is less than one in several thousand of the light comes to.
 */
#ifndef ORL_GONIOMETER_MIRRORS_H
#define ORL_GONIOMETER_MIRRORS_H

#include "goniometer/sample.h"

/* What the request says; where that is auto, of trees of rank 4 the mirrors found, else none. */
enum orl_bsdf_symmetry orl_gonio_mirrors_of(const struct orl_bsdf_make_request *request,
                                            const struct orl_gonio_sample *sample);

#endif

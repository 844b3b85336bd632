/*
 * Detects mirror symmetries of a panel. Random rays in the cell, and their mirror images, must hit
 * the same material on the same side at the same distance. An asymmetry that all rays miss affects
 * less than one in several thousand of the light.
 */
#ifndef ORL_BSDF_MAKE_PANEL_PANEL_MIRRORS_H
#define ORL_BSDF_MAKE_PANEL_PANEL_MIRRORS_H

#include "bsdf/make/panel/panel_sample.h"

/* Returns the request's symmetry. If it is auto: for trees of rank 4 the mirrors found, otherwise
 * none. */
enum orl_bsdf_symmetry orl_gonio_mirrors_of(const struct orl_bsdf_make_request *request,
                                            const struct orl_gonio_sample *sample);

#endif

/*
 * One view from photon maps: with a final gather, irradiance records in rounds from coarse to fine;
 * then pixels, each from a few rays on a regular grid.
 *
 * A pixel's standard error holds the photons' noise, by way of records or densities, and how far
 * its rays lie apart, which counts edges as if rays fell by chance. It does not hold what records
 * miss between them, nor the bias of densities, nor what branches left out would add.
 */
#ifndef ORL_RENDER_IMAGE_H
#define ORL_RENDER_IMAGE_H

#include "render/gather.h"
#include "render/paint.h"

/* Renders into the painting's film. ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err);

#endif

/*
 * One view from photon maps: with a final gather, irradiance records in rounds from coarse to fine;
 * then pixels, each from a few rays on a regular grid.
 */
#ifndef ORL_RENDER_IMAGE_H
#define ORL_RENDER_IMAGE_H

#include "render/gather.h"
#include "render/paint.h"

/* Renders into the painting's film. ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err);

#endif

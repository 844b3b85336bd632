/*
 * One view from photon maps: with a final gather, irradiance records in rounds from coarse to fine;
 * then tiles (mosaic.h).
 *
 * A pixel's standard error holds the photons' noise, by way of records or densities, that of the
 * rays there are for lobes and lamps, and, where it has several, how far its own rays lie apart,
 * which counts edges as if rays fell by chance. It does not hold what lies between records, or
 * between pixels worked out, nor the bias of densities, nor what branches left out would add.
 */
#ifndef ORL_RENDER_IMAGE_IMAGE_H
#define ORL_RENDER_IMAGE_IMAGE_H

#include "render/gather/gather.h"
#include "render/image/paint.h"

/* Renders into the painting's film. ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err);

#endif

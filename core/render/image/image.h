/*
 * One view from photon maps. With a final gather, irradiance records are made first, in rounds from
 * coarse to fine; then tiles are painted (adaptive_tile.h).
 *
 * A pixel's standard error contains the photons' noise, through records or densities, and the noise
 * of the rays for lobes and lamps. If the pixel has several rays it also contains their spread,
 * which counts edges as if rays were random. It does not contain errors of interpolation between
 * records or pixels, the bias of densities, or the light of omitted branches.
 */
#ifndef ORL_RENDER_IMAGE_IMAGE_H
#define ORL_RENDER_IMAGE_IMAGE_H

#include "render/gather/gather.h"
#include "render/image/paint.h"

/* Renders into the painting's film. Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err);

#endif

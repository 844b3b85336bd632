/*
 * OpenEXR, by OpenEXRCore: scan lines from the top, ZIP, channels B, G and R as half or float,
 * W/sr/m2 each, no exposure. What halves cannot hold is their largest, ORL_EXR_LARGEST_HALF.
 *
 * Attributes: chromaticities (Radiance's primaries, white at 1/3, 1/3), whiteLuminance (179 cd/m2
 * of RGB 1, 1, 1), worldToCamera (scene units; rows times matrix; camera looks along -z, x to the
 * right, y up), pixelAspectRatio, screenWindowWidth of perspective views, and "radianceView", the
 * VIEW line.
 */
#ifndef ORL_RENDER_FILM_EXR_H
#define ORL_RENDER_FILM_EXR_H

#include <stdbool.h>

#include "render/film/film.h"

#define ORL_EXR_LARGEST_HALF 65504

/* Whether a pixel is brighter than that, a sun, say. */
bool orl_exr_exceeds_halves(const struct orl_film *film);

/* To path.part, then sync and rename. Returns 0, ORL_ERR_IO, ORL_ERR_FULL or ORL_ERR_NOMEM. */
int orl_exr_write(const struct orl_film *film, const struct orl_view *view, bool halves,
                  const char *path, struct orl_error *err);

#endif

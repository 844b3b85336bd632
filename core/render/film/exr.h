/*
 * OpenEXR files, by OpenEXRCore: scan lines from the top, ZIP, channels B, G and R as half or
 * float, W/sr/m2 each, no exposure. Values beyond the range of halves become ORL_EXR_LARGEST_HALF.
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

/* Returns true if a pixel exceeds that, such as a sun. */
bool orl_exr_exceeds_halves(const struct orl_film *film);

/* Writes to path.part, then sync and rename. Returns 0, ORL_ERR_IO, ORL_ERR_FULL or
 * ORL_ERR_NOMEM. */
int orl_exr_write(const struct orl_film *film, const struct orl_view *view, bool halves,
                  const char *path, struct orl_error *err);

#endif

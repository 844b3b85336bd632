/*
 * Error maps: the estimated errors of an image.
 *
 * The map shows each pixel's standard error of its luma: the expected distance from the result of
 * the same job with unlimited samples and photons. It contains the noise of photons and rays, as
 * the technique estimates it (backward.h, image.h). It does not contain light that a technique
 * leaves out or blurs for any seed.
 *
 * As HDR: gray, W/sr/m2, the same view and format as the image. As PNG: in false colours, relative
 * to the pixel or to a tenth of the image's mean, if that is more. (A dark pixel's error is
 * invisible next to bright ones; oriel/job/study.h uses the same measure.) Colours go in even steps
 * of lightness from 0.1 % to 100 %, the same for all images. A legend below shows them with the
 * median and 95th percentile of this image. Pixels without any error get the darkest colour.
 */
#ifndef ORL_RENDER_PICTURE_ERROR_MAP_H
#define ORL_RENDER_PICTURE_ERROR_MAP_H

#include <stddef.h>

#include "render/film/film.h"

/*
 * Smooths errors estimated from few samples: a pixel's squared error becomes the mean of those of
 * the 3 x 3 pixels about it. Neighbours that differ by more than two standard errors show another
 * object and are left out. A rare bright sample in one pixel could also occur in its neighbours.
 * With n groups of samples a single estimate of the variance is off by sqrt(2 / (n - 1)). The mean
 * of nine is off by a third of that. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_film_smooth_errors(struct orl_film *film);

/* Returns the relative error of a pixel, as above. mean: orl_film_mean. */
double orl_film_relative_error(const struct orl_film *film, size_t pixel, double mean);
double orl_film_mean(const struct orl_film *film); /* mean luma of the pixels */

/* Write the map like orl_film_write_hdr and orl_png_write. The errors must be known. */
int orl_film_write_error_hdr(const struct orl_film *film, const struct orl_view *view,
                             const char *path, struct orl_error *err);
int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err);

#endif

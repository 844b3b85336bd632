/*
 * Error maps: what an image says of its own errors.
 *
 * Of each pixel, the standard error of its luma: how far it would lie from where the same job with
 * endless samples and photons puts it. It holds the noise of photons and rays, as the technique
 * knows it (backward.h, image.h); not what a technique leaves out or blurs whatever the seed.
 *
 * As HDR: gray, W/sr/m2, the same view and form as the image. As PNG: in false colours, relative to
 * the pixel or, where that is more, to a tenth of the image's mean (a dark pixel's error is not
 * seen next to bright ones; oriel/study.h counts it so too), with a legend below: colours in even
 * steps of lightness from 0.1 % to 100 %, the same for all images, and the median and 95th
 * percentile of this one. Pixels without any error get the darkest colour.
 */
#ifndef ORL_RENDER_PICTURE_ERROR_MAP_H
#define ORL_RENDER_PICTURE_ERROR_MAP_H

#include <stddef.h>

#include "render/film/film.h"

/*
 * For errors that come of few samples: a pixel's squared error becomes the mean of those of the 3 x
 * 3 pixels about it, but for neighbours that differ by more than two standard errors: what is seen
 * there is something else. The rare bright sample that one pixel has met, its neighbours might
 * have; and with n groups of samples a single estimate of the variance is off by sqrt(2 / (n - 1)),
 * the mean of nine by a third of that. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_film_smooth_errors(struct orl_film *film);

/* Relative error of a pixel, as above. mean: orl_film_mean. */
double orl_film_relative_error(const struct orl_film *film, size_t pixel, double mean);
double orl_film_mean(const struct orl_film *film); /* of the pixels' luma */

/* As orl_film_write_hdr and _png; the errors are known. */
int orl_film_write_error_hdr(const struct orl_film *film, const struct orl_view *view,
                             const char *path, struct orl_error *err);
int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err);

#endif

/*
 * Foveal samples of a film: averages over a degree, the size of the fovea. They give the adaptation
 * luminance and the veiling luminance by light scattered in the eye.
 *
 * Ward Larson, Rushmeier and Piatko 1997, "A visibility matching tone reproduction operator for
 * high dynamic range scenes" (IEEE TVCG 3, 4), sections 3.1 and 4.2; the weight of scattered light
 * is that of Moon and Spencer 1945.
 *
 * In views wider than ORL_FOVEA_SIDE degrees a sample covers more than one degree.
 */
#ifndef ORL_RENDER_PICTURE_FOVEA_H
#define ORL_RENDER_PICTURE_FOVEA_H

#include "render/film/film.h"

enum { ORL_FOVEA_SIDE = 120 };

struct orl_fovea {
    uint32_t width, height;
    float (*pixels)[3];  /* from the top left, row by row, W/sr/m2; owned */
    float (*veiling)[3]; /* veiling luminance, W/sr/m2; NULL: not requested; owned */
};

/* Makes the samples. Returns 0 or ORL_ERR_NOMEM; call orl_fovea_done in either case. */
int orl_fovea_init(struct orl_fovea *fovea, const struct orl_film *film,
                   const struct orl_view *view);
void orl_fovea_done(struct orl_fovea *fovea);

/* Computes the veil and mixes it into the samples as orl_fovea_mix_veiling does. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_fovea_add_veiling(struct orl_fovea *fovea, const struct orl_view *view);

/* Adds the veil to a pixel of the film; x and y as shares of the picture, 0..1 from the top
 * left. */
void orl_fovea_mix_veiling(const struct orl_fovea *fovea, double x, double y, float rgb[3]);

/* Interpolates the samples at a place. */
void orl_fovea_at(const struct orl_fovea *fovea, double x, double y, float ret_rgb[3]);

/* Returns a view's width and height in degrees, at its centre. A parallel one counts as 40 degrees
 * wide. */
void orl_view_degrees(const struct orl_view *view, double *ret_width, double *ret_height);

#endif

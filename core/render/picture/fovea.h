/*
 * A film as an eye that wanders over it takes it in: averages over a degree, the size of the fovea.
 * What the eye adapts to, and the light that it scatters.
 *
 * Ward Larson, Rushmeier and Piatko 1997, "A visibility matching tone reproduction operator for
 * high dynamic range scenes" (IEEE TVCG 3, 4), sections 3.1 and 4.2; the weight of scattered light
 * is that of Moon and Spencer 1945.
 *
 * Of views wider than ORL_FOVEA_SIDE degrees a sample is of more than one.
 */
#ifndef ORL_RENDER_PICTURE_FOVEA_H
#define ORL_RENDER_PICTURE_FOVEA_H

#include "render/film/film.h"

enum { ORL_FOVEA_SIDE = 120 };

struct orl_fovea {
    uint32_t width, height;
    float (*pixels)[3]; /* from the top left, row by row, W/sr/m2; owned */
    float (*veil)[3];   /* what eyes scatter there; NULL: not asked for; owned */
};

/* Returns 0 or ORL_ERR_NOMEM; orl_fovea_done in either case. */
int orl_fovea_init(struct orl_fovea *fovea, const struct orl_film *film,
                   const struct orl_view *view);
void orl_fovea_done(struct orl_fovea *fovea);

/* Works out the veil, and mixes it into the pixels as orl_fovea_veil does. 0 or ORL_ERR_NOMEM. */
int orl_fovea_add_veil(struct orl_fovea *fovea, const struct orl_view *view);

/* A film's pixel with its veil, x and y as parts of the picture, 0..1 from the top left. */
void orl_fovea_veil(const struct orl_fovea *fovea, double x, double y, float rgb[3]);

/* What is about a place, between samples. */
void orl_fovea_at(const struct orl_fovea *fovea, double x, double y, float ret_rgb[3]);

/* Degrees that a view is wide and high, in its middle. A parallel one counts as 40 degrees. */
void orl_view_degrees(const struct orl_view *view, double *ret_width, double *ret_height);

#endif

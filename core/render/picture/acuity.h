/*
 * Blurs a film to visual acuity, which falls with luminance (Ward Larson, Rushmeier and Piatko
 * 1997, section 4.4). Each pixel is interpolated between averages over 1, 2, 4 ... pixels: the two
 * sizes next to the acuity of eyes adapted to the light about it.
 */
#ifndef ORL_RENDER_PICTURE_ACUITY_H
#define ORL_RENDER_PICTURE_ACUITY_H

#include "render/picture/fovea.h"

enum { ORL_ACUITY_LEVELS = 8 };

struct orl_blur {
    const struct orl_film *film; /* borrowed */
    double pixels_a_degree;
    struct {
        uint32_t width, height;
        float (*pixels)[3]; /* level 0: the film's own; others: owned */
    } levels[ORL_ACUITY_LEVELS];
    int n_levels;
};

/* Builds the levels. Returns 0 or ORL_ERR_NOMEM; call orl_blur_done in either case. */
int orl_blur_init(struct orl_blur *blur, const struct orl_film *film, const struct orl_view *view);
void orl_blur_done(struct orl_blur *blur);

/* Returns a blurred pixel, for the adaptation luminance about it. */
void orl_blur_at(const struct orl_blur *blur, const struct orl_fovea *fovea, uint32_t x, uint32_t y,
                 float ret_rgb[3]);

#endif

/*
 * A film as blurred as eyes see it: the darker, the coarser (Ward Larson, Rushmeier and Piatko
 * 1997, section 4.4). Each pixel is read from averages of 1, 2, 4 ... pixels about it, between the
 * two sizes next to what eyes used to the light about it tell apart.
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
        float (*pixels)[3]; /* of the first the film's own; of others owned */
    } levels[ORL_ACUITY_LEVELS];
    int n_levels;
};

/* Returns 0 or ORL_ERR_NOMEM; orl_blur_done in either case. */
int orl_blur_init(struct orl_blur *blur, const struct orl_film *film, const struct orl_view *view);
void orl_blur_done(struct orl_blur *blur);

/* A pixel, by what is about it. */
void orl_blur_at(const struct orl_blur *blur, const struct orl_fovea *fovea, uint32_t x, uint32_t y,
                 float ret_rgb[3]);

#endif

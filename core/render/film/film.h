/*
 * Images and the files they go to.
 *
 * HDR is Radiance's: RGBE, run-length encoded by component, scanlines from the top, the whole VIEW
 * line, so that its tools (and evalglare) read it. Values are W/sr/m2 per channel, no exposure.
 * Pictures to look at are render/picture's.
 *
 * Beside its value a pixel has the standard error of its luma; error_map.h says of what, and writes
 * these.
 */
#ifndef ORL_RENDER_FILM_FILM_H
#define ORL_RENDER_FILM_FILM_H

#include <stdint.h>

#include <oriel/error.h>
#include <oriel/health.h>
#include <oriel/vec.h>

#include "render/film/view.h"

struct orl_film {
    uint32_t width, height;
    float (*pixels)[3]; /* from the top left, row by row; owned */
    float *errors;      /* standard errors of their luma, W/sr/m2; NaN: not known; owned */
};

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err);
void orl_film_done(struct orl_film *film);

/* What a technique says of a pixel. */
struct orl_pixel {
    struct orl_rgb value;
    double standard_error; /* of its luma; NaN: not known */
};

/* Sets a pixel. A colour that is no finite float becomes black, and is counted. */
void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, const struct orl_pixel *pixel,
                  struct orl_health *health);

/* Whether the errors of all pixels are known. */
bool orl_film_knows_errors(const struct orl_film *film);

/* Writes to path.part, sync and rename, so that a file is whole or absent. */
int orl_film_write_hdr(const struct orl_film *film, const struct orl_view *view, const char *path,
                       struct orl_error *err);

/* One pixel as RGBE; non-finite and negative parts become zero. */
void orl_rgbe_encode(const float rgb[3], unsigned char ret_rgbe[4]);

#endif

/*
 * Images and their files.
 *
 * HDR files are Radiance's: RGBE, run-length encoded by component, scanlines from the top, the
 * whole VIEW line, so that its tools (and evalglare) read them. Values are W/sr/m2 per channel, no
 * exposure. render/picture makes tone-mapped pictures.
 *
 * A pixel also has the standard error of its luma; error_map.h defines and writes it.
 */
#ifndef ORL_RENDER_FILM_FILM_H
#define ORL_RENDER_FILM_FILM_H

#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/health.h>
#include <oriel/base/vec.h>

#include "render/film/view.h"

struct orl_film {
    uint32_t width, height;
    float (*pixels)[3]; /* from the top left, row by row; owned */
    float *errors;      /* standard errors of their luma, W/sr/m2; NaN: unknown; owned */
};

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err);
void orl_film_done(struct orl_film *film);

/* A technique's result for a pixel. */
struct orl_pixel {
    struct orl_rgb value;
    double standard_error; /* standard error of its luma; NaN: unknown */
};

/* Sets a pixel. A colour that is no finite float becomes black and is counted. */
void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, const struct orl_pixel *pixel,
                  struct orl_health *health);

/* Returns true if the errors of all pixels are known. */
bool orl_film_has_errors(const struct orl_film *film);

/* Writes to path.part, then sync and rename, so that the file is complete or absent. */
int orl_film_write_hdr(const struct orl_film *film, const struct orl_view *view, const char *path,
                       struct orl_error *err);

/* Encodes one pixel as RGBE; non-finite and negative parts become zero. */
void orl_rgbe_encode(const float rgb[3], unsigned char ret_rgbe[4]);

#endif

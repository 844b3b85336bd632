#include "render/film/film.h"

#include <stdlib.h>

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err)
{
    film->width = width;
    film->height = height;
    film->pixels = calloc((size_t)width * height, sizeof *film->pixels);
    film->errors = calloc((size_t)width * height, sizeof *film->errors);
    if (!film->pixels || !film->errors)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for an image of %u x %u", width,
                             height);
    return 0;
}

void orl_film_done(struct orl_film *film)
{
    free(film->pixels);
    free(film->errors);
    film->pixels = NULL;
    film->errors = NULL;
}

void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, const struct orl_pixel *pixel,
                  struct orl_health *health)
{
    const size_t at = (size_t)y * film->width + x;
    const struct orl_rgb color = pixel->value;
    float *rgb = film->pixels[at];
    /* A value beyond the range of floats becomes infinite before it is tested. */
    const struct orl_rgb held =
        orl_health_filter(health, (struct orl_rgb){(float)color.r, (float)color.g, (float)color.b});
    rgb[0] = (float)held.r;
    rgb[1] = (float)held.g;
    rgb[2] = (float)held.b;
    film->errors[at] = (float)pixel->standard_error;
}

bool orl_film_has_errors(const struct orl_film *film)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        if (!isfinite(film->errors[i]))
            return false;
    return true;
}

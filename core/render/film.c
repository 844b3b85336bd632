#include "render/film.h"

#include <stdlib.h>

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err)
{
    film->width = width;
    film->height = height;
    film->pixels = calloc((size_t)width * height, sizeof *film->pixels);
    if (!film->pixels)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for an image of %u x %u", width,
                             height);
    return 0;
}

void orl_film_done(struct orl_film *film)
{
    free(film->pixels);
    film->pixels = NULL;
}

void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, struct orl_rgb color,
                  struct orl_health *health)
{
    float *pixel = film->pixels[(size_t)y * film->width + x];
    /* What a float cannot hold becomes infinite before it is looked at. */
    const struct orl_rgb held =
        orl_health_keep(health, (struct orl_rgb){(float)color.r, (float)color.g, (float)color.b});
    pixel[0] = (float)held.r;
    pixel[1] = (float)held.g;
    pixel[2] = (float)held.b;
}

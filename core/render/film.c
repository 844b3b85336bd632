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

#include "render/image/discs.h"

#include <string.h>

#include "base/random.h"

/* Rays to a disc, to a side of the square that it is drawn from; they are few and cheap. */
enum { SIDE = 32 };
/* A sun that covers more pixels than this is seen well enough by their rays. */
static const double most_pixels = 8;

/* Where the view has that direction: in pixels from the upper left. */
static bool place_of(const struct orl_painting *painting, struct orl_vec3 direction, double *ret_x,
                     double *ret_y)
{
    double x, y;
    if (!orl_view_place(painting->view, direction, &x, &y))
        return false;
    *ret_x = x * painting->film->width;
    *ret_y = (1 - y) * painting->film->height;
    return *ret_x >= 0 && *ret_x < painting->film->width && *ret_y >= 0 &&
           *ret_y < painting->film->height;
}

static double pixel_sr(const struct orl_painting *painting, double x, double y)
{
    const struct orl_film *film = painting->film;
    return orl_view_solid_angle(painting->view, floor(x) / film->width,
                                1 - (floor(y) + 1) / film->height, 1.0 / film->width,
                                1.0 / film->height);
}

static bool is_small(const struct orl_painting *painting, const struct orl_sun *sun)
{
    double x, y;
    if (!strchr("vha", painting->view->type) || painting->view->aft > 0)
        return false;
    const double sr = 2 * ORL_PI * (1 - sun->cos_half_angle);
    /* One beside the picture, or half in it, is as good as small: what is of it is put in. */
    return !place_of(painting, sun->frame.n, &x, &y) || sr < most_pixels * pixel_sr(painting, x, y);
}

enum orl_suns orl_discs_suns(const struct orl_world *world, const struct orl_painting *painting)
{
    /* What is not shown is not put in. */
    if (painting->irradiance)
        return ORL_SUNS_SEEN;
    for (size_t i = 0; i < world->n_suns; i++)
        if (!is_small(painting, &world->suns[i]))
            return ORL_SUNS_SEEN;
    return world->n_suns > 0 ? ORL_SUNS_APART : ORL_SUNS_SEEN;
}

/* One ray to the disc. */
static void put_ray(const struct orl_shader *shader, const struct orl_painting *painting,
                    const struct orl_sun *sun, const double u[2], bool outside,
                    struct orl_random *random)
{
    const struct orl_vec3 direction = orl_sun_sample(sun, u);
    struct orl_search *search = &painting->env->searches[0];
    struct orl_vec3 origin, along;
    struct orl_shaded shaded;
    double x, y;
    if (!place_of(painting, direction, &x, &y) || !orl_paint_ray(painting, x, y, &origin, &along))
        return;
    const double sr = pixel_sr(painting, x, y);
    const double share = 2 * ORL_PI * (1 - sun->cos_half_angle) / (SIDE * SIDE * sr);
    orl_shade_ray(shader, origin, direction, outside, false, random, search, &shaded);
    const struct orl_rgb light =
        orl_rgb_scale(orl_health_keep(&search->health, shaded.rest), share);
    float *pixel = painting->film->pixels[(size_t)y * painting->film->width + (size_t)x];
    if (!(sr > 0))
        return;
    pixel[0] = (float)((double)pixel[0] + light.r);
    pixel[1] = (float)((double)pixel[1] + light.g);
    pixel[2] = (float)((double)pixel[2] + light.b);
}

void orl_discs_paint(const struct orl_shader *shader, const struct orl_painting *painting,
                     bool outside)
{
    const struct orl_world *world = shader->world;
    struct orl_shader alone = *shader;
    alone.suns = ORL_SUNS_ALONE;
    if (orl_discs_suns(world, painting) != ORL_SUNS_APART)
        return;
    for (size_t i = 0; i < world->n_suns; i++)
        for (uint32_t k = 0; k < SIDE * SIDE; k++) {
            struct orl_random random = orl_random_stream(i, ORL_PURPOSE_PIXEL, k);
            const uint32_t column = k % SIDE, row = k / SIDE;
            const double u[2] = {(column + 0.5) / SIDE, (row + 0.5) / SIDE};
            put_ray(&alone, painting, &world->suns[i], u, outside, &random);
        }
}

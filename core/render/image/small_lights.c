#include "render/image/image.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "light/direct.h"

/* Rays of a disc, per side of the square that its points come from. They are few and cheap. With
 * many lamps each has fewer; with more than MOST_LAMPS none has any. */
enum { SIDE = 32, LEAST_SIDE = 4, MOST_LAMPS = 1 << 14, RAYS_OF_LAMPS = 1 << 18 };
/* A sun or lamp that covers more pixels than this is left to pixel rays. */
static const double most_pixels = 8;

/* Projects a direction to the picture, in pixels from the upper left. Returns false if it is
 * outside. */
static bool place_of(const struct orl_painting *painting, struct orl_vec3 direction, double *ret_x,
                     double *ret_y)
{
    double x, y;
    if (!orl_view_project(painting->view, direction, &x, &y))
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

/* Returns true if all rays start at one point and have no aft clipping plane. */
static bool is_of_a_point(const struct orl_view *view)
{
    return strchr("vha", view->type) && !(view->aft > 0);
}

static bool is_small(const struct orl_painting *painting, const struct orl_sun *sun)
{
    double x, y;
    if (!is_of_a_point(painting->view))
        return false;
    const double sr = 2 * ORL_PI * (1 - sun->cos_half_angle);
    /* A sun outside the picture, or at its border, also counts as small: only its visible rays are
     * added. */
    return !place_of(painting, sun->frame.n, &x, &y) || sr < most_pixels * pixel_sr(painting, x, y);
}

static enum orl_sun_visibility suns_of(const struct orl_lit_scene *lit_scene,
                                       const struct orl_painting *painting)
{
    /* An irradiance picture shows no suns. */
    if (painting->irradiance)
        return ORL_SUNS_VISIBLE;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        if (!is_small(painting, &lit_scene->suns[i]))
            return ORL_SUNS_VISIBLE;
    return lit_scene->n_suns > 0 ? ORL_SUNS_EXCLUDED : ORL_SUNS_VISIBLE;
}

static struct orl_vec3 eye_of(const struct orl_painting *painting)
{
    return orl_sub(painting->view->point, painting->geometry->center);
}

/* Sets the k-th point of a regular grid over the unit square. */
static void place_in_square(uint32_t k, uint32_t side, double ret_u[2])
{
    const uint32_t column = k % side, row = k / side;
    ret_u[0] = (column + 0.5) / side;
    ret_u[1] = (row + 0.5) / side;
}

/* Returns true if a lamp is visible in the picture and small, from a few of its points. */
static bool is_small_lamp(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter,
                          const struct orl_painting *painting)
{
    enum { POINTS = LEAST_SIDE * LEAST_SIDE };
    const uint32_t material = orl_facet_material(lit_scene->geometry, emitter->facet);
    double sr = 0, least_pixel_sr = INFINITY;
    if (lit_scene->materials[material].kind == ORL_MATERIAL_ILLUM)
        return false; /* views see another material there */
    for (uint32_t k = 0; k < POINTS; k++) {
        struct orl_light_sample light_sample;
        double u[2], x, y;
        place_in_square(k, LEAST_SIDE, u);
        if (!orl_light_sample(lit_scene, emitter, eye_of(painting), u, &light_sample))
            continue;
        sr += light_sample.measure_sr / POINTS;
        if (place_of(painting, light_sample.light, &x, &y))
            least_pixel_sr = fmin(least_pixel_sr, pixel_sr(painting, x, y));
    }
    return isfinite(least_pixel_sr) && sr < most_pixels * least_pixel_sr;
}

int orl_small_lights_init(struct orl_small_lights *small_lights,
                          const struct orl_lit_scene *lit_scene,
                          const struct orl_painting *painting)
{
    *small_lights = (struct orl_small_lights){.suns = suns_of(lit_scene, painting)};
    if (painting->irradiance || !is_of_a_point(painting->view) || painting->view->fore > 0 ||
        lit_scene->n_emitters == 0 || lit_scene->n_emitters > MOST_LAMPS)
        return 0;
    small_lights->lamps = calloc(lit_scene->geometry->n_facets, sizeof *small_lights->lamps);
    if (!small_lights->lamps)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        small_lights->lamps[lit_scene->emitters[i].facet] =
            is_small_lamp(lit_scene, &lit_scene->emitters[i], painting);
    return 0;
}

void orl_small_lights_done(struct orl_small_lights *small_lights)
{
    free(small_lights->lamps);
    *small_lights = (struct orl_small_lights){.lamps = NULL};
}

/* A picture, and a shader that shows only the light being added. */
struct alone {
    const struct orl_painting *painting;
    struct orl_shader shader;
    bool outside;
};

/* Adds one ray that stands for a solid angle, in steradians. */
static void put_ray(const struct alone *alone, struct orl_vec3 direction, double sr,
                    struct orl_random *random)
{
    const struct orl_painting *painting = alone->painting;
    struct orl_search *search = &painting->env->searches[0];
    struct orl_vec3 origin, along;
    struct orl_shaded_ray shaded;
    double x, y;
    if (!place_of(painting, direction, &x, &y) || !orl_paint_ray(painting, x, y, &origin, &along))
        return;
    const double of_pixel = pixel_sr(painting, x, y);
    orl_shade_ray(&alone->shader, origin, direction, alone->outside, false, random, search,
                  &shaded);
    const struct orl_rgb light =
        orl_rgb_scale(orl_health_filter(&search->health, shaded.rest), sr / of_pixel);
    float *pixel = painting->film->pixels[(size_t)y * painting->film->width + (size_t)x];
    if (!(of_pixel > 0))
        return;
    pixel[0] = (float)((double)pixel[0] + light.r);
    pixel[1] = (float)((double)pixel[1] + light.g);
    pixel[2] = (float)((double)pixel[2] + light.b);
}

static void paint_suns(struct alone *alone)
{
    const struct orl_lit_scene *lit_scene = alone->shader.lit_scene;
    alone->shader.suns = ORL_SUNS_ONLY;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        for (uint32_t k = 0; k < SIDE * SIDE; k++) {
            const struct orl_sun *sun = &lit_scene->suns[i];
            struct orl_random random = orl_random_stream(i, ORL_PURPOSE_PIXEL, k);
            const double sr = 2 * ORL_PI * (1 - sun->cos_half_angle) / (SIDE * SIDE);
            double u[2];
            place_in_square(k, SIDE, u);
            put_ray(alone, orl_sun_sample(sun, u), sr, &random);
        }
}

static void paint_lamps(struct alone *alone, const bool *lamps)
{
    const struct orl_lit_scene *lit_scene = alone->shader.lit_scene;
    const double each = sqrt((double)RAYS_OF_LAMPS / (double)lit_scene->n_emitters);
    const uint32_t side = (uint32_t)fmin(fmax(each, LEAST_SIDE), SIDE), points = side * side;
    alone->shader.suns = ORL_LAMP_ONLY;
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        const struct orl_emitter *emitter = &lit_scene->emitters[i];
        alone->shader.lamp = emitter->facet;
        for (uint32_t k = 0; k < points && lamps[emitter->facet]; k++) {
            struct orl_random random = orl_random_stream(i, ORL_PURPOSE_PIXEL, k);
            struct orl_light_sample light_sample;
            double u[2];
            place_in_square(k, side, u);
            if (orl_light_sample(lit_scene, emitter, eye_of(alone->painting), u, &light_sample))
                put_ray(alone, light_sample.light, light_sample.measure_sr / points, &random);
        }
    }
}

void orl_small_lights_paint(const struct orl_small_lights *small_lights,
                            const struct orl_shader *shader, const struct orl_painting *painting,
                            bool outside)
{
    struct alone alone = {painting, *shader, outside};
    if (small_lights->suns == ORL_SUNS_EXCLUDED)
        paint_suns(&alone);
    if (small_lights->lamps)
        paint_lamps(&alone, small_lights->lamps);
}

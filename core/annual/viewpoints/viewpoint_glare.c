#include "annual/viewpoints/viewpoints.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "light/direct.h"
#include "metrics/glare_sources.h"
#include "metrics/indices.h"

/* Columns of a tile are rated in strips; memory holds the pictures of one strip. */
enum { TILE = ORL_HOURS_TILE, STRIP = 16, STRIPS = TILE / STRIP, MOST_IMAGES = 8 };
enum { ROOM = ORL_VIEWPOINT_PIXELS * (STRIP + 1) };

/* The default rule of glare pictures. */
static const struct orl_glare_source_rule rule = {
    .threshold_cd_m2 = 2000, .radius_rad = 0.2, .peak_cd_m2 = 50000};

struct glare_context {
    const struct orl_viewpoint_image *view;
    const struct orl_viewpoint_light *light;
    const struct orl_viewpoint_hours *ret;
    const struct orl_thread_pool *pool;
    float *room; /* by thread, ROOM each: luminances of a strip, and of one hour */
    atomic_bool failed;
};

/* ---- Luminances ------------------------------------------------------------------------------ */

static void add_light(float *pixel, const float *light, float weight, uint32_t n)
{
    for (uint32_t j = 0; j < n; j++)
        pixel[j] += weight * light[j];
}

static void paint_strip(const struct glare_context *r, size_t strip, uint32_t n,
                        float (*pixels)[STRIP])
{
    const struct orl_hours *hours = &r->light->year->hours;
    const size_t tile = strip / STRIPS;
    const float *sky = hours->fine + tile * ORL_BINS * TILE + strip % STRIPS * STRIP;
    const float *visible_points = r->light->visible_points + strip * STRIP;
    memset(pixels, 0, ORL_VIEWPOINT_PIXELS * sizeof *pixels);
    for (uint32_t i = 0; i < ORL_VIEWPOINT_PIXELS; i++)
        for (uint32_t k = r->view->first[i]; k < r->view->first[i + 1]; k++) {
            const struct orl_pixel_term *t = &r->view->terms[k];
            if (t->which < ORL_BINS)
                add_light(pixels[i], sky + (size_t)t->which * TILE,
                          (float)ORL_EFFICACY_LM_PER_W * t->weight, n);
            else
                add_light(pixels[i], visible_points + (t->which - ORL_BINS) * hours->n_columns,
                          t->weight, n);
        }
}

/* Returns a random point of the disc, a different one for every spot and hour. */
static struct orl_vec3 somewhere_on(const struct orl_hour_sun *sun, const struct orl_frame *frame,
                                    uint64_t name)
{
    const uint64_t bits = orl_mix64(name);
    const double far = tan(0.5 * sun->angle_rad) * sqrt((double)(uint32_t)bits * 0x1p-32);
    const struct orl_sincos circle = orl_sincos_turn((double)(bits >> 32) * 0x1p-32);
    return orl_normalize(
        orl_madd(orl_madd(frame->n, frame->u, far * circle.cosine), frame->v, far * circle.sine));
}

/* Returns the radiance that a spot sends to the eye, unoccluded, for a sun with a normal irradiance
 * of 1. */
static struct orl_rgb spot_response(const struct orl_viewpoint_spot *spot, struct orl_vec3 towards)
{
    const double cosine = orl_dot(towards, spot->place.normal);
    if (!(cosine > 0))
        return orl_gray(0);
    const struct orl_rgb sent =
        spot->material ? orl_material_eval_lobes(spot->material, &spot->hit, towards, spot->eye)
                       : orl_gray(1);
    return orl_rgb_scale(orl_rgb_mul(spot->weight, sent), cosine);
}

/* Adds direct sunlight on visible surfaces to the pictures. */
static void add_sunlight(const struct glare_context *r, size_t column, uint32_t j,
                         float (*pixels)[STRIP])
{
    static const double faintest_cd_m2 = 1;
    enum { SPOTS_A_POLL = 256 };
    const struct orl_year *y = r->light->year;
    const struct orl_column_sun *of = &y->hours.sun_of_column[column];
    if (!(of->normal_lx > 0))
        return;
    const struct orl_hour_sun *sun = &y->hours.suns.at[of->sun];
    const struct orl_frame frame = orl_frame_about(sun->towards);
    for (size_t i = 0; i < r->view->n_spots; i++) {
        if (i % SPOTS_A_POLL == 0 && orl_thread_pool_cancelled(r->pool))
            return;
        const struct orl_viewpoint_spot *spot = &r->view->spots[i];
        const struct orl_shading_point *place = &spot->place;
        if (!(orl_dot(sun->towards, place->normal) > -0.01) ||
            (!place->outside &&
             !orl_port_rects_passed(&y->scene.ports, place->point, sun->towards, 0.005, INFINITY)))
            continue;
        const struct orl_vec3 towards =
            somewhere_on(sun, &frame, (uint64_t)i * ORL_HOURS_MOST + of->sun);
        const struct orl_rgb sent = spot_response(spot, towards);
        if (!(of->normal_lx * orl_rgb_max(sent) > faintest_cd_m2))
            continue;
        const struct orl_rgb lit =
            orl_transmittance(y->lit_scene, place->point, towards, INFINITY, true);
        pixels[spot->pixel][j] += (float)(of->normal_lx * orl_luma(orl_rgb_mul(sent, lit)));
    }
}

/* ---- The sun itself -------------------------------------------------------------------------- */

/* Returns a glare source with the size of the disc, that causes this illuminance at the eye. */
static struct orl_glare_source disc_of(const struct orl_viewpoint_image *view,
                                       struct orl_vec3 towards, double angle_rad, double eye_lx)
{
    const struct orl_vec3 to = orl_to_local(&view->field.eye, towards);
    const double sr = 2 * ORL_PI * (1 - cos(0.5 * angle_rad));
    return (struct orl_glare_source){.luminance_cd_m2 = eye_lx / (fmax(to.z, 1e-3) * sr),
                                     .solid_angle_sr = sr,
                                     .position_index = orl_position_index(to)};
}

/* Query of mirrors: only mirror number `wanted` responds, and records the direction of the sun's
 * image. */
struct image {
    const struct orl_shading_point *eye;
    int wanted, queried;
    struct orl_vec3 towards;
};

static struct orl_rgb image_response(const void *ctx, struct orl_vec3 light)
{
    struct image *image = *(struct image *const *)ctx;
    if (image->queried++ != image->wanted)
        return orl_gray(0);
    image->towards = light;
    return orl_gray(fmax(orl_dot(light, image->eye->normal), 0));
}

/* Lists the sun's disc and its mirror images as glare sources. Returns their number. */
static size_t list_sun_images(const struct glare_context *r, size_t column,
                              struct orl_glare_source *ret_sources)
{
    const struct orl_year *y = r->light->year;
    const struct orl_column_sun *of = &y->hours.sun_of_column[column];
    size_t n = 0;
    if (!(of->normal_lx > 0))
        return 0;
    const struct orl_hour_sun *sun = &y->hours.suns.at[of->sun];
    if (r->light->eye_direct[column] > 0)
        ret_sources[n++] =
            disc_of(r->view, sun->towards, sun->angle_rad, (double)r->light->eye_direct[column]);
    for (int i = 0; y->scene.mirrors.n_planes > 0 && i < MOST_IMAGES; i++) {
        struct image image = {.eye = &r->view->eye, .wanted = i};
        struct image *ctx = &image;
        const double lit =
            of->normal_lx * orl_luma(orl_mirrors_light(&y->scene.mirrors, &r->view->eye,
                                                       sun->towards, false, image_response, &ctx));
        if (lit > 0)
            ret_sources[n++] = disc_of(r->view, image.towards, sun->angle_rad, lit);
        if (image.queried <= i + 1)
            break;
    }
    return n;
}

/* ---- Hours ----------------------------------------------------------------------------------- */

static double dgp_of(double eye_lx, const struct orl_glare_source *sources, size_t n)
{
    static const struct orl_dgp_options options = {.constants = ORL_DGP_EVALGLARE};
    double dgp = NAN;
    orl_dgp(fmax(eye_lx, 0), sources, n, &options, &dgp, NULL);
    return dgp;
}

/* Sets DGP and its interval, from the error of the light at the eye alone. DGP may fall as this
 * light grows, because contrast falls. */
static void set_hour(const struct glare_context *r, size_t column,
                     const struct orl_glare_source *sources, size_t n)
{
    static const double z = 1.96;
    const double eye_lx = (double)r->light->eye[column];
    const double off = z * (double)r->light->eye_error[column];
    const double here = dgp_of(eye_lx, sources, n);
    const double less = dgp_of(eye_lx - off, sources, n), more = dgp_of(eye_lx + off, sources, n);
    r->ret->dgp[column] = (float)here;
    r->ret->low[column] = (float)fmin(here, fmin(less, more));
    r->ret->high[column] = (float)fmax(here, fmax(less, more));
    r->ret->eye_lx[column] = (float)eye_lx;
}

static int rate_hour(const struct glare_context *r, size_t column, const float *picture)
{
    const struct orl_luminances seen = {.field = &r->view->field, .cd_m2 = picture};
    struct orl_glare_source *sources = NULL;
    size_t n = 0;
    int code = orl_glare_sources_find(&seen, &rule, &sources, &n, NULL);
    if (code < 0)
        return code;
    struct orl_glare_source *grown = realloc(sources, (n + 1 + MOST_IMAGES) * sizeof *grown);
    if (grown) {
        n += list_sun_images(r, column, grown + n);
        set_hour(r, column, grown, n);
    }
    free(grown ? grown : sources);
    return grown ? 0 : ORL_ERR_NOMEM;
}

static void rate_strip(void *arg, size_t strip, uint32_t member)
{
    struct glare_context *r = arg;
    const struct orl_hours *hours = &r->light->year->hours;
    const size_t first = strip * STRIP;
    float *room = r->room + member * (size_t)ROOM;
    float(*pixels)[STRIP] = (float(*)[STRIP])(void *)room;
    float *picture = room + (size_t)ORL_VIEWPOINT_PIXELS * STRIP;
    uint32_t n = 0, wanted = 0;
    for (; n < STRIP && first + n < hours->n_columns; n++)
        wanted += r->light->wanted[first + n];
    if (wanted == 0 || atomic_load(&r->failed))
        return;
    paint_strip(r, strip, n, pixels);
    for (uint32_t j = 0; j < n && !orl_thread_pool_cancelled(r->pool); j++) {
        if (!r->light->wanted[first + j])
            continue;
        add_sunlight(r, first + j, j, pixels);
        for (uint32_t i = 0; i < ORL_VIEWPOINT_PIXELS; i++)
            picture[i] = pixels[i][j];
        if (rate_hour(r, first + j, picture) < 0)
            atomic_store(&r->failed, true);
    }
}

int orl_viewpoint_glare_compute(const struct orl_viewpoint_image *view,
                                const struct orl_viewpoint_light *light,
                                const struct orl_viewpoint_hours *ret)
{
    struct orl_thread_pool *pool = light->year->env->run->pool;
    struct glare_context r = {.view = view, .light = light, .ret = ret, .pool = pool};
    r.room = malloc(orl_thread_pool_size(pool) * (size_t)ROOM * sizeof *r.room);
    int code = r.room ? orl_parallel_try(pool, light->year->hours.n_tiles * STRIPS, rate_strip, &r)
                      : ORL_ERR_NOMEM;
    if (code == 0 && atomic_load(&r.failed))
        code = ORL_ERR_NOMEM;
    free(r.room);
    return code;
}

/* Views by the backward technique: every pixel is the mean of a number of rays through it. */
#include "render/backward/backward.h"
#include "render/image/image.h"
#include "render/picture/false_color.h"

/* Samples per ray: for pictures, and for sums over many pixels. */
static const struct samples_per_ray {
    uint32_t lamps, pane_samples, gloss_samples;
    struct orl_strategy_counts at_surfaces;
} efforts[] = {{8, 4, 2, {{1, 2, 1}}}, {2, 1, 1, {{1, 1, 1}}}};
static const double least_weight =
    0.1; /* branches below this share of a ray undergo Russian roulette */

struct painter {
    const struct orl_backward *backward;
    const struct orl_painting *painting;
    const struct samples_per_ray *of_rays;
    struct orl_strategy_counts ray_counts;
    uint32_t samples;
    bool outside;
    struct orl_small_lights small_lights;
};

/* Returns the radiance of a lobe's ray. It has its own random stream, so that the view ray
 * continues with its own. */
static struct orl_rgb lobe_radiance(const void *ctx, const struct orl_lobe_ray *ray,
                                    struct orl_random *random, struct orl_search *search)
{
    const uint64_t name = orl_random_bits(random);
    struct orl_tracer tracer = {.backward = ctx,
                                .group = (uint32_t)(name % ORL_MAP_BATCHES),
                                .random = {name},
                                .health = &search->health};
    return orl_health_filter(
        &search->health,
        orl_backward_radiance(&tracer, ray->origin, ray->direction, ray->outside, ray->mis_pdf));
}

/* Returns the light that all diffuse surfaces met by a ray send along it. */
static struct orl_rgb lit_surfaces(const struct orl_shaded_ray *shaded,
                                   struct orl_sample_params params, struct orl_tracer *tracer)
{
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t v = 0; v < shaded->n_vertices; v++) {
        const struct orl_vertex *vertex = &shaded->vertices[v];
        const struct orl_rgb light =
            orl_backward_sample_irradiance(tracer, &vertex->place, &params);
        sum =
            orl_rgb_add(sum, orl_health_filter(tracer->health, orl_rgb_mul(vertex->weight, light)));
        params.sequence += 0x632be59bU;
    }
    return sum;
}

static struct orl_rgb ray_radiance(const struct painter *p, const struct orl_shader *shader,
                                   const double place[2], struct orl_sample_params params,
                                   struct orl_tracer *tracer, struct orl_search *search)
{
    struct orl_vec3 origin, direction;
    struct orl_shaded_ray shaded;
    if (!orl_paint_ray(p->painting, place[0], place[1], &origin, &direction))
        return orl_gray(0);
    orl_shade_ray(shader, origin, direction, p->outside, true, &tracer->random, search, &shaded);
    return orl_rgb_add(orl_health_filter(tracer->health, orl_rgb_add(shaded.rest, shaded.lobes)),
                       lit_surfaces(&shaded, params, tracer));
}

/* Sums over groups of samples, and the number of samples in each. */
struct groups {
    double sums[ORL_MAP_BATCHES];
    uint32_t counts[ORL_MAP_BATCHES];
};

/* Returns the standard error of the overall mean, from the spread of the groups' means. */
static double error_of(const struct groups *groups, uint32_t n, double mean)
{
    double square = 0;
    for (uint32_t g = 0; g < n; g++) {
        const double off = groups->sums[g] / groups->counts[g] - mean;
        square += off * off;
    }
    return n > 1 ? sqrt(square / ((double)n * (n - 1))) : NAN;
}

static struct orl_shader shader_of(const struct painter *p)
{
    return (struct orl_shader){.lit_scene = p->backward->lit_scene,
                               .backs_unseen = p->painting->view->backs_unseen,
                               .irradiance = p->painting->irradiance,
                               .sobol = &p->backward->sobol,
                               .pane_samples = p->of_rays->pane_samples,
                               .gloss_samples = p->of_rays->gloss_samples,
                               .least_weight = least_weight,
                               .roulette = true,
                               .suns = p->small_lights.suns,
                               .excluded_lamps = p->small_lights.lamps,
                               .radiance = lobe_radiance,
                               .ctx = p->backward};
}

static struct orl_pixel compute_pixel(void *ctx, uint32_t x, uint32_t y, struct orl_search *search)
{
    const struct painter *p = ctx;
    const struct orl_backward *b = p->backward;
    const uint64_t index = p->painting->env->index;
    const uint64_t pixel = (uint64_t)y * p->painting->film->width + x;
    const uint64_t name = orl_mix64(b->seed * 5 + index * 7 + orl_mix64(pixel));
    const struct orl_shader shader = shader_of(p);
    struct orl_sample_params params = {.sequence = (uint32_t)(name >> 8) + 1,
                                       .ray_counts = p->ray_counts,
                                       .lamps = p->of_rays->lamps};
    const uint32_t n_groups = p->samples < ORL_MAP_BATCHES ? p->samples : ORL_MAP_BATCHES;
    struct groups groups = {.sums = {0}};
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < p->samples && !orl_paint_cancelled(p->painting->env); i++) {
        const uint32_t group = (uint32_t)((uint64_t)i * n_groups / p->samples);
        struct orl_tracer tracer = {
            .backward = b,
            .group = (uint32_t)((name + group) % ORL_MAP_BATCHES),
            .random = orl_random_stream(b->seed + index, ORL_PURPOSE_PIXEL, (pixel << 24) + i),
            .health = &search->health};
        double u[2];
        orl_sobol_point(&b->sobol, i, (uint32_t)(name >> 8), 2, u);
        params.index = i;
        const double place[2] = {x + u[0], y + u[1]};
        const struct orl_rgb c = ray_radiance(p, &shader, place, params, &tracer, search);
        sum = orl_rgb_add(sum, c);
        groups.sums[group] += orl_luma(c);
        groups.counts[group]++;
    }
    const struct orl_rgb mean = orl_rgb_scale(sum, 1.0 / p->samples);
    return (struct orl_pixel){mean, error_of(&groups, n_groups, orl_luma(mean))};
}

int orl_backward_render(const struct orl_backward *backward, const struct orl_painting *painting,
                        uint32_t samples, bool of_sums, struct orl_error *err)
{
    const struct orl_vec3 eye = orl_sub(painting->view->point, painting->geometry->center);
    struct painter painter = {.backward = backward,
                              .painting = painting,
                              .of_rays = &efforts[of_sums],
                              .ray_counts = orl_direction_sampler_counts(
                                  &backward->sampler, efforts[of_sums].at_surfaces),
                              .samples = samples,
                              .outside = orl_lit_scene_is_outside(backward->lit_scene, eye)};
    int code = orl_small_lights_init(&painter.small_lights, backward->lit_scene, painting);
    if (code == 0)
        code = orl_paint(painting, compute_pixel, &painter, 0);
    const struct orl_shader shader = shader_of(&painter);
    if (code == 0)
        orl_small_lights_paint(&painter.small_lights, &shader, painting, painter.outside);
    orl_small_lights_done(&painter.small_lights);
    if (code == ORL_ERR_CANCELLED)
        return orl_error_set(err, code, "cancelled while rendering a view");
    if (code < 0)
        return orl_error_set(err, code, "out of memory rendering a view");
    if (orl_film_smooth_errors(painting->film) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory rendering a view");
    return 0;
}

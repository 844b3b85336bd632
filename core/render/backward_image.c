/* Views by the backward technique: every pixel the mean of paths through it. */
#include "render/backward.h"

struct painter {
    const struct orl_backward *backward;
    const struct orl_painting *painting;
    uint32_t samples;
    bool outside;
};

static struct orl_rgb pixel_radiance(void *ctx, uint32_t x, uint32_t y, struct orl_search *search)
{
    const struct painter *p = ctx;
    const uint64_t index = p->painting->env->index;
    const uint64_t pixel = (uint64_t)y * p->painting->film->width + x;
    const uint32_t sequence =
        (uint32_t)orl_mix64(p->backward->seed * 5 + index * 7 + orl_mix64(pixel));
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < p->samples; i++) {
        struct orl_random random =
            orl_random_stream(p->backward->seed + index, ORL_PURPOSE_PIXEL, (pixel << 24) + i);
        struct orl_vec3 origin, direction;
        double u[2];
        orl_sobol_point(&p->backward->sobol, i, sequence, 2, u);
        if (orl_paint_ray(p->painting, x + u[0], y + u[1], &origin, &direction))
            sum = orl_rgb_add(sum,
                              orl_backward_radiance(p->backward, origin, direction, p->outside,
                                                    i % ORL_MAP_BATCHES, &random, &search->health));
    }
    return orl_rgb_scale(sum, 1.0 / p->samples);
}

int orl_backward_render(const struct orl_backward *backward, const struct orl_painting *painting,
                        uint32_t samples, struct orl_error *err)
{
    const struct orl_vec3 eye = orl_sub(painting->view->point, painting->geometry->center);
    struct painter painter = {.backward = backward,
                              .painting = painting,
                              .samples = samples,
                              .outside = orl_world_is_outside(backward->world, eye)};
    const int code = orl_paint(painting, pixel_radiance, &painter, 0);
    return code == 0 ? 0 : orl_error_set(err, code, "cancelled while rendering a view");
}

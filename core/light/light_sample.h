/*
 * Sampling of points on lamps for shadow rays: uniform over the cone that a sphere fills, uniform
 * by area on any other surface. Directions are unit, points in moved coordinates.
 */
#ifndef ORL_LIGHT_LIGHT_SAMPLE_H
#define ORL_LIGHT_LIGHT_SAMPLE_H

#include "light/lit_scene.h"

/* A sampled point of an emitter as seen from a point, and the solid angle that it stands for (1
 * / pdf). */
struct orl_light_sample {
    struct orl_vec3 light;  /* unit, towards the point */
    struct orl_vec3 normal; /* unit, at the point */
    double distance, measure_sr;
};
/* Samples a point of an emitter; u: two numbers in [0,1). Returns false if the point is seen
 * from its back, or a sphere from inside. */
bool orl_light_sample(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter,
                      struct orl_vec3 from, const double u[2], struct orl_light_sample *ret_sample);

/* Returns the pdf of the sampled direction, 1/sr. */
static inline double orl_light_sample_pdf(const struct orl_light_sample *light_sample)
{
    return 1 / light_sample->measure_sr;
}

/* Returns the pdf, 1/sr, with which orl_light_sample at `from` samples the direction to that hit of
 * the lamp. */
double orl_light_pdf_of_hit(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                            struct orl_vec3 from);

#endif

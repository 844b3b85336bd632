#include "photon/strata/first_reflection.h"

#include "light/path.h"

enum { EMISSIONS = 1 << 15, MOST_EMISSIONS = 1 << 10, LEAST_EMISSIONS = 64, MOST_BOUNCES = 16 };

/* Lower bound, so that the few bright surfaces of a dark scene are not lit by a handful of heavy
 * photons. */
static const double least_reflected = 0.1;

struct pilot {
    struct orl_emission *emission;
    uint64_t seed;
    uint32_t emissions;
};

/* Finds the flux that lands on a diffuse surface first, and that surface's albedo. Returns false
 * if the photon never hits one. */
static bool find_first_diffuse_hit(const struct orl_lit_scene *lit_scene,
                                   const struct orl_photon_ray *photon_ray,
                                   struct orl_random *random, double *ret_flux, double *ret_albedo)
{
    struct orl_path path = orl_path_from(photon_ray->origin, photon_ray->direction);
    path.weight = photon_ray->flux;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return false;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        *ret_albedo = fmin(orl_luma(orl_material_diffuse(m, &hit)), 1);
        *ret_flux = orl_luma(path.weight);
        if (*ret_albedo > 0)
            return isfinite(*ret_flux);
        const struct orl_surface_sample s = orl_material_sample(
            m, &hit, orl_path_back(&path), ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return false;
        path.weight = orl_rgb_mul(path.weight, s.weight);
        orl_path_spawn_ray(&path, lit_scene, &hit, &s);
    }
    return false;
}

static void estimate_reflected(void *arg, size_t index, uint32_t member)
{
    const struct pilot *pilot = arg;
    const struct orl_emission *e = pilot->emission;
    struct orl_stratum *stratum = &e->strata[index];
    struct orl_health ignored = {0}; /* counters of pilot emissions are discarded */
    double reflected = 0, squares = 0;
    (void)member;
    for (uint32_t i = 0; i < pilot->emissions && orl_stratum_is_direct(e, stratum); i++) {
        double point[5], flux, albedo;
        struct orl_photon_ray photon_ray;
        struct orl_random random =
            orl_random_stream(pilot->seed, ORL_PURPOSE_FIRST, (uint64_t)index << 32 | i);
        orl_sobol_point(&e->sobol, i, (uint32_t)(pilot->seed + index), 5, point);
        if (!orl_emission_sample_stratum(e, stratum, false, point, &random, &ignored,
                                         &photon_ray) ||
            !find_first_diffuse_hit(e->lit_scene, &photon_ray, &random, &flux, &albedo))
            continue;
        reflected += flux * albedo;
        squares += flux * albedo * albedo;
    }
    if (reflected > 0 && isfinite(squares))
        stratum->reflected = fmin(fmax(squares / reflected, least_reflected), 1);
}

int orl_first_reflection_prepare(struct orl_emission *emission, uint64_t seed,
                                 struct orl_thread_pool *pool)
{
    const size_t each = EMISSIONS / (emission->n_strata + 1);
    struct pilot pilot = {.emission = emission,
                          .seed = seed,
                          .emissions = (uint32_t)(each > MOST_EMISSIONS    ? MOST_EMISSIONS
                                                  : each < LEAST_EMISSIONS ? LEAST_EMISSIONS
                                                                           : each)};
    for (size_t i = 0; i < emission->n_strata; i++)
        emission->strata[i].reflected = 1;
    return emission->lit_scene->omit.counted_light
               ? orl_parallel_try(pool, emission->n_strata, estimate_reflected, &pilot)
               : 0;
}

#include "support/brute.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "light/path.h"

enum { SURFACES_MOST = 4096, ROULETTE_FROM = 1 };

static const uint64_t brute_seed = 0x6272757465; /* separate random streams */

/* Returns the radiance of suns and domes along a direction that hits nothing. */
static struct orl_rgb distant_radiance(const struct orl_lit_scene *lit_scene,
                                       struct orl_vec3 direction)
{
    return orl_rgb_add(orl_lit_scene_dome_radiance(lit_scene, direction),
                       orl_lit_scene_sun_radiance(lit_scene, direction));
}

/* Returns the radiance along a ray: one path; Russian roulette uses only its weight. */
static struct orl_rgb radiance(const struct orl_lit_scene *lit_scene, struct orl_path path,
                               struct orl_random *random)
{
    struct orl_rgb sum = orl_gray(0);
    for (int i = 0; i < SURFACES_MOST; i++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit)) {
            orl_path_escape(&path);
            return orl_rgb_add(
                sum, orl_rgb_mul(path.weight, distant_radiance(lit_scene, path.direction)));
        }
        const struct orl_material *material = orl_lit_scene_material(lit_scene, &hit);
        orl_path_attenuate(&path, material, &hit);
        sum = orl_rgb_add(sum, orl_rgb_mul(path.weight, orl_material_emission(
                                                            material, &hit, orl_path_back(&path))));
        const struct orl_surface_sample sample = orl_material_sample(
            material, &hit, orl_path_back(&path), ORL_TRANSPORT_EYE, ORL_LOBE_ALL, random);
        if (sample.event == ORL_EVENT_ABSORBED)
            return sum;
        path.weight = orl_rgb_mul(path.weight, sample.weight);
        const double survival = i < ROULETTE_FROM ? 1 : fmin(orl_rgb_max(path.weight), 0.95);
        if (!orl_path_roulette(&path, survival, random))
            return sum;
        orl_path_spawn_ray(&path, lit_scene, &hit, &sample);
    }
    return sum;
}

struct brute_run {
    const struct orl_lit_scene *lit_scene;
    struct orl_vec3 position; /* moved coordinates */
    struct orl_frame frame;   /* n: the sensor's normal */
    uint64_t paths, sensor;   /* paths per block */
    double sums[BRUTE_BLOCKS], squares[BRUTE_BLOCKS];
};

/* Traces a block of paths with its own stream of random numbers. */
static void trace_block(void *arg, size_t block, uint32_t member)
{
    struct brute_run *run = arg;
    struct orl_random random = orl_random_stream(brute_seed, ORL_PURPOSE_BENCH,
                                                 run->sensor * BRUTE_BLOCKS + (uint64_t)block);
    double sum = 0, squares = 0;
    (void)member;
    for (uint64_t i = 0; i < run->paths; i++) {
        const double u = orl_random_uniform(&random),
                     phi = 2 * ORL_PI * orl_random_uniform(&random);
        const struct orl_vec3 local = {sqrt(u) * cos(phi), sqrt(u) * sin(phi), sqrt(1 - u)};
        const struct orl_path path = orl_path_from(run->position, orl_to_world(&run->frame, local));
        const double value = orl_luma(radiance(run->lit_scene, path, &random));
        sum += value;
        squares += value * value;
    }
    run->sums[block] = sum;
    run->squares[block] = squares;
}

/* Returns the mean of all blocks and its standard error, times pi and the luminous efficacy. */
static struct brute_value brute_value_of(const struct brute_run *run)
{
    const double n = (double)run->paths * BRUTE_BLOCKS, scale = ORL_PI * ORL_EFFICACY_LM_PER_W;
    double sum = 0, squares = 0;
    for (int i = 0; i < BRUTE_BLOCKS; i++) {
        sum += run->sums[i];
        squares += run->squares[i];
    }
    const double mean = sum / n;
    return (struct brute_value){mean * scale,
                                sqrt(fmax(squares / n - mean * mean, 0) / (n - 1)) * scale};
}

void brute_sensors(const struct orl_lit_scene *lit_scene, const struct orl_sensor *sensors,
                   size_t n, uint64_t paths, struct orl_thread_pool *pool,
                   struct brute_value *ret_values)
{
    for (size_t i = 0; i < n; i++) {
        struct brute_run run = {.lit_scene = lit_scene,
                                .position =
                                    orl_sub(sensors[i].position, lit_scene->geometry->center),
                                .frame = orl_frame_about(orl_normalize(sensors[i].direction)),
                                .paths = paths / BRUTE_BLOCKS,
                                .sensor = i};
        orl_parallel_for(pool, BRUTE_BLOCKS, trace_block, &run);
        ret_values[i] = brute_value_of(&run);
    }
}

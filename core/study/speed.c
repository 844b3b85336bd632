#include "study/speed.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

#include "base/sampling/sampling.h"
#include "base/statistics/numeric.h"
#include "scene/geometry/intersect.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"

struct ray {
    struct orl_vec3 origin, direction;
};

/* Adds the rays of a path of a few bounces from the scene's centre; returns the new number
 * of rays. */
static size_t add_path(const struct orl_geometry *g, struct orl_random *random, struct ray *rays,
                       size_t n, size_t most)
{
    const double z = 2 * orl_random_uniform(random) - 1;
    const double phi = 2 * ORL_PI * orl_random_uniform(random), s = sqrt(fmax(0, 1 - z * z));
    struct orl_vec3 point = orl_v3(0, 0, 0), direction = orl_v3(s * cos(phi), s * sin(phi), z);
    struct orl_hit hit;
    for (int bounce = 0; bounce < 8 && n < most; bounce++) {
        const double u = orl_random_uniform(random), v = orl_random_uniform(random);
        if (!orl_geometry_intersect(g, point, direction, INFINITY, &hit))
            break;
        const struct orl_vec3 normal = orl_hit_facing(&hit);
        direction = orl_hemisphere_about(normal, u, v);
        point = orl_hit_ray_origin(g, &hit, direction);
        rays[n++] = (struct ray){point, direction};
    }
    return n;
}

/* Shuffles the rays, because neighbours in the array are neighbours on a path. */
static void shuffle(struct ray *rays, size_t n, struct orl_random *random)
{
    for (size_t i = n; i > 1; i--) {
        const size_t j = orl_random_bits(random) % i;
        const struct ray swap = rays[i - 1];
        rays[i - 1] = rays[j];
        rays[j] = swap;
    }
}

static size_t make_rays(const struct orl_geometry *g, struct ray *rays, size_t most,
                        const atomic_bool *cancel)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    size_t n = 0;
    for (size_t path = 0; path < most && n < most && !orl_is_cancelled(cancel); path++)
        n = add_path(g, &random, rays, n, most);
    shuffle(rays, n, &random);
    return n;
}

double orl_ray_rate(const struct orl_geometry *geometry, size_t n_rays, int runs,
                    const atomic_bool *cancel, double (*now_s)(void *ctx), void *ctx)
{
    struct ray *rays = malloc(n_rays * sizeof *rays);
    const size_t n = rays ? make_rays(geometry, rays, n_rays, cancel) : 0;
    double rates[ORL_SPEED_MOST_RUNS];
    size_t hits = 0;
    for (int run = 0; run < runs; run++) {
        const double started = now_s(ctx);
        for (size_t i = 0; i < n && !orl_is_cancelled(cancel); i++) {
            struct orl_embree_hit hit;
            hits +=
                orl_embree_intersect(geometry, rays[i].origin, rays[i].direction, INFINITY, &hit);
        }
        rates[run] = (double)n / (now_s(ctx) - started);
    }
    free(rays);
    return hits > 0 ? orl_nth_element(rates, (size_t)runs, (size_t)runs / 2) : NAN;
}

int orl_study_measure_speed(const struct orl_study_request *request,
                            const struct orl_study_env *env, double *ret_rays_per_s,
                            struct orl_error *err)
{
    const struct orl_bsdf_loader loader = {.cancel = env->cancel};
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_geometry *geometry = NULL;
    int code =
        orl_scene_parse_with((const char *const *)request->job.scene_files,
                             request->job.n_scene_files, env->files, &loader, &parsed_scene, err);
    parsed_scene.cancel = env->cancel;
    if (code == 0)
        code = orl_geometry_new(&parsed_scene, &geometry, err);
    if (code == 0)
        *ret_rays_per_s = orl_ray_rate(geometry, 1 << 18, 3, env->cancel, env->now_s, env->ctx);
    if (code == 0 && orl_is_cancelled(env->cancel))
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while measuring the machine");
    orl_geometry_free(geometry);
    orl_parsed_scene_done(&parsed_scene);
    return code;
}

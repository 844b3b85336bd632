/* Pilot of caustic photons: their yield and cost, and their contrast where they land. */
#include "photon/shooting/shoot.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "photon/map/quantization.h"
#include "photon/tracing/trace.h"

/* ---- Contrast -------------------------------------------------------------------------------- */

/* Levels of cubes, from the scene's own to 1/16384 of its width; minimum number of photons in a
 * cube. */
enum { LEVELS = 15, LEAST_IN_CUBE = 8 };
/* Hash table of cubes: more slots than photons. */
enum { MOST_PHOTONS = 1 << 15, SLOTS = 1 << 17 };
_Static_assert((int)SLOTS >= 4 * (int)MOST_PHOTONS, "no long searches");

struct cube {
    uint64_t key; /* hash of a cube and a bin of normals; 0: free */
    uint32_t caustic, rest;
    double caustic_w, rest_w;
};

/* Every step-th photon of an array. */
struct photon_subset {
    const struct orl_photon *photons;
    size_t count, step;
    double scale;
};

static struct photon_subset select_photons(const struct orl_photon *photons, size_t count,
                                           double scale)
{
    const size_t step = (count + MOST_PHOTONS / 2 - 1) / (MOST_PHOTONS / 2);
    return (struct photon_subset){photons, count, step > 0 ? step : 1,
                                  scale * (double)(step > 0 ? step : 1)};
}

static uint64_t key_of(const struct orl_photon *p, const struct orl_geometry *g, int level)
{
    const double cubes = ldexp(1, level), width = 2 * g->radius * (1 + 1e-6);
    uint64_t key = orl_normal_bin(p->normal) + 1;
    for (int i = 0; i < 3; i++) {
        const double at = cubes * (0.5 + p->position[i] / width);
        key = orl_mix64(key) + (uint64_t)fmin(fmax(at, 0), cubes);
    }
    return orl_mix64(key) | 1;
}

static struct cube *find_cube(struct cube *cubes, uint64_t key)
{
    size_t at = key >> 17 & (SLOTS - 1);
    while (cubes[at].key != 0 && cubes[at].key != key)
        at = (at + 1) & (SLOTS - 1);
    cubes[at].key = key;
    return &cubes[at];
}

static void fill_cubes(struct cube *cubes, const struct photon_subset *caustic,
                       const struct photon_subset *rest, const struct orl_geometry *g, int level)
{
    memset(cubes, 0, SLOTS * sizeof *cubes);
    for (size_t i = 0; i < caustic->count; i += caustic->step) {
        struct cube *c = find_cube(cubes, key_of(&caustic->photons[i], g, level));
        c->caustic++;
        c->caustic_w += caustic->scale * orl_photon_luma(&caustic->photons[i]);
    }
    for (size_t i = 0; i < rest->count; i += rest->step) {
        const struct orl_photon *p = &rest->photons[i];
        if (p->tag == ORL_PHOTON_CAUSTIC)
            continue;
        struct cube *c = find_cube(cubes, key_of(p, g, level));
        c->rest++;
        c->rest_w += rest->scale * orl_photon_luma(p);
    }
}

/* Flux over area, of both kinds, around each caustic photon. */
struct local_flux {
    double caustic, rest;
};

int orl_photon_pilot_contrast(const struct orl_photon *caustic, size_t n_caustic,
                              double caustic_scale, const struct orl_photon *rest, size_t n_rest,
                              double rest_scale, const struct orl_geometry *geometry,
                              double *ret_contrast)
{
    const struct photon_subset c = select_photons(caustic, n_caustic, caustic_scale),
                               r = select_photons(rest, n_rest, rest_scale);
    struct cube *cubes = malloc(SLOTS * sizeof *cubes);
    struct local_flux *local_flux = calloc(n_caustic + 1, sizeof *local_flux);
    double sum = 0, all = 0;
    for (int level = 0; level < LEVELS && cubes && local_flux; level++) {
        const double per_area = ldexp(1, 2 * level);
        fill_cubes(cubes, &c, &r, geometry, level);
        for (size_t i = 0; i < n_caustic; i += c.step) {
            const struct cube *cube = find_cube(cubes, key_of(&caustic[i], geometry, level));
            if (level == 0 || cube->caustic >= LEAST_IN_CUBE)
                local_flux[i].caustic = per_area * cube->caustic_w;
            if (level == 0 || cube->rest >= LEAST_IN_CUBE)
                local_flux[i].rest = per_area * cube->rest_w;
        }
    }
    for (size_t i = 0; i < n_caustic && cubes && local_flux; i += c.step) {
        const double flux = orl_photon_luma(&caustic[i]),
                     both = local_flux[i].caustic + local_flux[i].rest;
        sum += both > 0 ? flux * local_flux[i].caustic / both : 0;
        all += flux;
    }
    const bool failed = !cubes || !local_flux;
    free(cubes);
    free(local_flux);
    if (failed)
        return ORL_ERR_NOMEM;
    *ret_contrast = all > 0 ? sum / all : 1;
    return 0;
}

/* ---- Yield and cost -------------------------------------------------------------------------- */

/*
 * Emissions are divided into chunks, and chunks into rounds: one round of global photons, as many
 * rounds of caustic ones as are needed to find enough. A chunk ends early if one emission leaves
 * thousands of photons.
 */
enum { CHUNK = 1024, FIRST_OF_CHUNK = 32, RAYS_A_CHUNK = 1 << 15, MOST_CHUNKS = 16 };
enum { GLOBAL_CHUNKS = 16, CAUSTIC_CHUNKS = 16, MOST_ROUNDS = 16, ENOUGH_CAUSTIC = 2048 };
enum {
    LEAST_CONCLUSIVE = 32
}; /* photons needed for a result: their flux is known within a fifth */
static const uint64_t another_seed = 0x63617573;
_Static_assert((int)FIRST_OF_CHUNK % (int)ORL_MAP_BATCHES == 0, "whole blocks");
_Static_assert((int)GLOBAL_CHUNKS <= (int)MOST_CHUNKS && (int)CAUSTIC_CHUNKS <= (int)MOST_CHUNKS,
               "room");

/* A round of one kind. */
struct pilot_round {
    struct orl_shoot_env env;
    enum orl_map_kind kind;
    size_t first; /* first chunk */
    struct orl_deposits deposits[MOST_CHUNKS];
    uint64_t emitted[MOST_CHUNKS];
};

/* Results of all rounds of a kind. */
struct pilot_result {
    struct orl_photon *photons;
    size_t count;
    uint64_t emitted, rays;
    double seconds, flux;
};

static void shoot_chunk(void *arg, size_t index, uint32_t member)
{
    struct pilot_round *s = arg;
    struct orl_deposits *deposits = &s->deposits[index];
    const uint64_t first = (s->first + index) * CHUNK;
    uint64_t done = 0;
    (void)member;
    while (done < CHUNK && deposits->health.rays < RAYS_A_CHUNK) {
        const uint64_t most = done == 0 ? FIRST_OF_CHUNK : CHUNK - done;
        if (atomic_load_explicit(s->env.cancel, memory_order_relaxed))
            break;
        done += orl_shoot_chunk(&s->env, s->kind, first + done, most, deposits);
    }
    s->emitted[index] = done;
}

/* Adds the results of a round. Returns 0 or ORL_ERR_NOMEM. */
static int add_round(struct pilot_result *pilot_result, struct pilot_round *s, size_t chunks)
{
    size_t more = 0;
    for (size_t i = 0; i < chunks; i++) {
        if (s->deposits[i].out_of_memory)
            return ORL_ERR_NOMEM;
        more += s->deposits[i].count;
    }
    struct orl_photon *grown =
        realloc(pilot_result->photons, (pilot_result->count + more + 1) * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    pilot_result->photons = grown;
    for (size_t i = 0; i < chunks; i++) {
        const struct orl_deposits *d = &s->deposits[i];
        if (d->count > 0)
            memcpy(pilot_result->photons + pilot_result->count, d->photons,
                   d->count * sizeof *d->photons);
        pilot_result->count += d->count;
        pilot_result->emitted += s->emitted[i];
        pilot_result->rays += d->health.rays;
    }
    return 0;
}

static int run_round(const struct orl_shoot_env *env, enum orl_map_kind kind, size_t first,
                     size_t chunks, struct pilot_result *pilot_result)
{
    struct pilot_round s = {.env = *env, .kind = kind, .first = first};
    s.env.seed = orl_mix64(env->seed ^ another_seed);
    for (size_t i = 0; i < chunks; i++)
        s.deposits[i].unsampled_only = env->unsampled_only;
    orl_parallel_for(env->pool, chunks, shoot_chunk, &s);
    int code = atomic_load(env->cancel) ? ORL_ERR_CANCELLED : add_round(pilot_result, &s, chunks);
    for (size_t i = 0; i < chunks; i++)
        free(s.deposits[i].photons);
    return code;
}

static int run_caustic_rounds(const struct orl_shoot_env *env, struct pilot_result *pilot_result)
{
    int code = 0;
    for (size_t round = 0; round < MOST_ROUNDS && code == 0 &&
                           pilot_result->count < ENOUGH_CAUSTIC && pilot_result->rays < 1 << 20;
         round++)
        code =
            run_round(env, ORL_MAP_CAUSTIC, round * CAUSTIC_CHUNKS, CAUSTIC_CHUNKS, pilot_result);
    return code;
}

static double flux_of(const struct pilot_result *pilot_result, bool caustics_too)
{
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < pilot_result->count; i++) {
        const struct orl_photon *p = &pilot_result->photons[i];
        if (caustics_too || p->tag != ORL_PHOTON_CAUSTIC)
            orl_sum_add(&sum, orl_photon_luma(p));
    }
    return pilot_result->emitted > 0 ? orl_sum_value(&sum) / (double)pilot_result->emitted : 0;
}

static void fill_pilot(const struct pilot_result pilot_results[ORL_SHOT_KINDS],
                       struct orl_photon_pilot *pilot)
{
    const double caustic = flux_of(&pilot_results[ORL_MAP_CAUSTIC], true),
                 rest = flux_of(&pilot_results[ORL_MAP_GLOBAL], false);
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        const double emitted = fmax((double)pilot_results[k].emitted, 1);
        pilot->emitted[k] = pilot_results[k].emitted;
        pilot->stored[k] = pilot_results[k].count;
        pilot->yield[k] = (double)pilot_results[k].count / emitted;
        pilot->rays[k] = (double)pilot_results[k].rays / emitted;
        pilot->emission_s[k] = pilot_results[k].seconds / emitted;
    }
    pilot->share = caustic + rest > 0 ? caustic / (caustic + rest) : 0;
    pilot->known = pilot_results[ORL_MAP_CAUSTIC].count >= LEAST_CONCLUSIVE;
}

int orl_photon_pilot_run(const struct orl_shoot_env *env, double (*now_s)(void *ctx), void *ctx,
                         struct orl_photon_pilot *ret_pilot, struct orl_error *err)
{
    struct pilot_result pilot_results[ORL_SHOT_KINDS] = {{0}, {0}};
    struct orl_photon_pilot pilot = {.contrast = 1};
    int code = 0;
    for (int k = 0; k < ORL_SHOT_KINDS && code == 0; k++) {
        const double started = now_s ? now_s(ctx) : NAN;
        if (k == ORL_MAP_GLOBAL)
            code = run_round(env, ORL_MAP_GLOBAL, 0, GLOBAL_CHUNKS, &pilot_results[k]);
        else if (env->emission->has_caustics)
            code = run_caustic_rounds(env, &pilot_results[k]);
        pilot_results[k].seconds = (now_s ? now_s(ctx) : NAN) - started;
    }
    if (code == 0)
        fill_pilot(pilot_results, &pilot);
    if (code == 0 && pilot.known) {
        const struct pilot_result *c = &pilot_results[ORL_MAP_CAUSTIC],
                                  *g = &pilot_results[ORL_MAP_GLOBAL];
        code = orl_photon_pilot_contrast(c->photons, c->count, 1 / (double)c->emitted, g->photons,
                                         g->count, 1 / (double)g->emitted,
                                         env->emission->lit_scene->geometry, &pilot.contrast);
    }
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        free(pilot_results[k].photons);
    if (code < 0)
        return orl_error_set(err, code, "%s looking for caustics",
                             code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    *ret_pilot = pilot;
    return 0;
}

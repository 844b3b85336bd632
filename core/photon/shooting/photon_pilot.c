/* Pilot of caustic photons: their yield and cost, and their contrast where they land. */
#include "photon/shooting/shoot.h"

#include <stdlib.h>
#include <string.h>

#include "base/morton.h"
#include "base/sampling/sampling.h"
#include "photon/map/quantization.h"
#include "photon/tracing/trace.h"

/* ---- Contrast -------------------------------------------------------------------------------- */

/* Levels of cubes, from the scene's own to 1/16384 of its width; minimum number of photons in a
 * cube; maximum number of photons of each kind that are looked at. */
enum { LEVELS = 15, LEAST_IN_CUBE = 8, MOST_PHOTONS = 1 << 14 };

/* A photon in the finest cubes, with the flux over area around it if it is caustic. */
struct landed_photon {
    uint64_t code; /* bin of normals, and Morton code of the finest cube */
    bool caustic;
    double flux_w;
    double caustic_around, rest_around;
};

static uint64_t code_of(const struct orl_photon *p, const struct orl_geometry *g)
{
    const double most = ldexp(1, LEVELS - 1), width = 2 * g->radius * (1 + 1e-6);
    uint64_t cube[3];
    for (int i = 0; i < 3; i++)
        cube[i] = (uint64_t)fmin(fmax(most * (0.5 + p->position[i] / width), 0), most - 1);
    return (uint64_t)orl_normal_bin(p->normal) << 3 * (LEVELS - 1) |
           orl_morton_code(cube[0], cube[1], cube[2]);
}

/* Appends every n-th photon, so that there are at most MOST_PHOTONS. Returns the new length. */
static size_t append_photons(const struct orl_photon *photons, size_t count, double scale,
                             bool caustic, const struct orl_geometry *g, struct landed_photon *list,
                             size_t length)
{
    const size_t step = count / MOST_PHOTONS + (count % MOST_PHOTONS != 0);
    for (size_t i = 0; i < count; i += step) {
        const struct orl_photon *p = &photons[i];
        if (!caustic && p->tag == ORL_PHOTON_CAUSTIC)
            continue;
        list[length++] =
            (struct landed_photon){.code = code_of(p, g),
                                   .caustic = caustic,
                                   .flux_w = scale * (double)step * orl_photon_luma(p)};
    }
    return length;
}

static int compare_codes(const void *a, const void *b)
{
    const uint64_t x = ((const struct landed_photon *)a)->code,
                   y = ((const struct landed_photon *)b)->code;
    return (x > y) - (x < y);
}

/* Sets the flux around the caustic photons of a cube, of the kinds with enough photons in it. */
static void spread_in_cube(struct landed_photon *photons, size_t count, int level)
{
    size_t n_caustic = 0;
    double caustic_w = 0, rest_w = 0;
    for (size_t i = 0; i < count; i++) {
        n_caustic += photons[i].caustic;
        caustic_w += photons[i].caustic ? photons[i].flux_w : 0;
        rest_w += photons[i].caustic ? 0 : photons[i].flux_w;
    }
    const double per_area = ldexp(1, 2 * level);
    for (size_t i = 0; i < count && n_caustic > 0; i++) {
        if (level == 0 || n_caustic >= LEAST_IN_CUBE)
            photons[i].caustic_around = per_area * caustic_w;
        if (level == 0 || count - n_caustic >= LEAST_IN_CUBE)
            photons[i].rest_around = per_area * rest_w;
    }
}

/* Photons of a cube follow each other in the list, which is sorted by code. */
static void spread_in_cubes(struct landed_photon *list, size_t length, int level)
{
    const int finer = 3 * (LEVELS - 1 - level);
    for (size_t first = 0, end; first < length; first = end) {
        for (end = first + 1; end < length && list[end].code >> finer == list[first].code >> finer;)
            end++;
        if (level == 0 || end - first >= LEAST_IN_CUBE)
            spread_in_cube(list + first, end - first, level);
    }
}

int orl_photon_pilot_contrast(const struct orl_photon *caustic, size_t n_caustic,
                              double caustic_scale, const struct orl_photon *rest, size_t n_rest,
                              double rest_scale, const struct orl_geometry *geometry,
                              double *ret_contrast)
{
    struct landed_photon *list = malloc(2 * (size_t)MOST_PHOTONS * sizeof *list);
    size_t length = 0;
    double sum = 0, all = 0;
    if (!list)
        return ORL_ERR_NOMEM;
    length = append_photons(caustic, n_caustic, caustic_scale, true, geometry, list, length);
    length = append_photons(rest, n_rest, rest_scale, false, geometry, list, length);
    qsort(list, length, sizeof *list, compare_codes);
    for (int level = 0; level < LEVELS; level++)
        spread_in_cubes(list, length, level);
    for (size_t i = 0; i < length; i++) {
        const struct landed_photon *p = &list[i];
        const double both = p->caustic_around + p->rest_around;
        if (!p->caustic)
            continue;
        sum += both > 0 ? p->flux_w * p->caustic_around / both : 0;
        all += p->flux_w;
    }
    free(list);
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

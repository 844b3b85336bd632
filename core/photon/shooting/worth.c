#include "photon/shooting/worth.h"

#include <stdlib.h>
#include <string.h>

#include "photon/flight/trace.h"

/*
 * Emissions are divided into chunks, and chunks into rounds: one round of global photons, as many
 * rounds of caustic ones as are needed to find enough. A chunk ends early if one emission leaves
 * thousands of photons.
 */
enum { CHUNK = 1024, FIRST_OF_CHUNK = 32, RAYS_A_CHUNK = 1 << 15, MOST_AT_ONCE = 16 };
enum { GLOBAL_CHUNKS = 16, CAUSTIC_CHUNKS = 16, MOST_ROUNDS = 16, ENOUGH_CAUSTIC = 2048 };
enum { LEAST_TO_TELL = 32 }; /* photons needed for a result: their flux is known within a fifth */
static const uint64_t another_seed = 0x63617573;
_Static_assert((int)FIRST_OF_CHUNK % (int)ORL_MAP_BATCHES == 0, "whole blocks");
_Static_assert((int)GLOBAL_CHUNKS <= (int)MOST_AT_ONCE && (int)CAUSTIC_CHUNKS <= (int)MOST_AT_ONCE,
               "room");

/* A round of one kind. */
struct sortie {
    struct orl_shoot_env env;
    enum orl_map_kind kind;
    size_t first; /* first chunk */
    struct orl_deposits deposits[MOST_AT_ONCE];
    uint64_t emitted[MOST_AT_ONCE];
};

/* Results of all rounds of a kind. */
struct find {
    struct orl_photon *photons;
    size_t count;
    uint64_t emitted, rays;
    double seconds, flux;
};

static void shoot_chunk(void *arg, size_t index, uint32_t member)
{
    struct sortie *s = arg;
    struct orl_deposits *deposits = &s->deposits[index];
    const uint64_t first = (s->first + index) * CHUNK;
    uint64_t done = 0;
    (void)member;
    while (done < CHUNK && deposits->health.rays < RAYS_A_CHUNK) {
        const uint64_t most = done == 0 ? FIRST_OF_CHUNK : CHUNK - done;
        if (atomic_load_explicit(s->env.cancel, memory_order_relaxed))
            break;
        done += orl_shoot_some(&s->env, s->kind, first + done, most, deposits);
    }
    s->emitted[index] = done;
}

/* Adds the results of a round. Returns 0 or ORL_ERR_NOMEM. */
static int add_round(struct find *find, struct sortie *s, size_t chunks)
{
    size_t more = 0;
    for (size_t i = 0; i < chunks; i++) {
        if (s->deposits[i].out_of_memory)
            return ORL_ERR_NOMEM;
        more += s->deposits[i].count;
    }
    struct orl_photon *grown = realloc(find->photons, (find->count + more + 1) * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    find->photons = grown;
    for (size_t i = 0; i < chunks; i++) {
        const struct orl_deposits *d = &s->deposits[i];
        if (d->count > 0)
            memcpy(find->photons + find->count, d->photons, d->count * sizeof *d->photons);
        find->count += d->count;
        find->emitted += s->emitted[i];
        find->rays += d->health.rays;
    }
    return 0;
}

static int run_round(const struct orl_shoot_env *env, enum orl_map_kind kind, size_t first,
                     size_t chunks, struct find *find)
{
    struct sortie s = {.env = *env, .kind = kind, .first = first};
    s.env.seed = orl_mix64(env->seed ^ another_seed);
    for (size_t i = 0; i < chunks; i++)
        s.deposits[i].by_chance = env->by_chance;
    orl_crew_for(env->crew, chunks, shoot_chunk, &s);
    int code = atomic_load(env->cancel) ? ORL_ERR_CANCELLED : add_round(find, &s, chunks);
    for (size_t i = 0; i < chunks; i++)
        free(s.deposits[i].photons);
    return code;
}

static int find_caustics(const struct orl_shoot_env *env, struct find *find)
{
    int code = 0;
    for (size_t round = 0;
         round < MOST_ROUNDS && code == 0 && find->count < ENOUGH_CAUSTIC && find->rays < 1 << 20;
         round++)
        code = run_round(env, ORL_MAP_CAUSTIC, round * CAUSTIC_CHUNKS, CAUSTIC_CHUNKS, find);
    return code;
}

static double flux_of(const struct find *find, bool caustics_too)
{
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < find->count; i++) {
        const struct orl_photon *p = &find->photons[i];
        if (caustics_too || p->tag != ORL_PHOTON_CAUSTIC)
            orl_sum_add(&sum, orl_luma((struct orl_rgb){p->flux[0], p->flux[1], p->flux[2]}));
    }
    return find->emitted > 0 ? orl_sum_value(&sum) / (double)find->emitted : 0;
}

static void fill_worth(const struct find finds[ORL_SHOT_KINDS], struct orl_worth *worth)
{
    const double caustic = flux_of(&finds[ORL_MAP_CAUSTIC], true),
                 rest = flux_of(&finds[ORL_MAP_GLOBAL], false);
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        const double emitted = fmax((double)finds[k].emitted, 1);
        worth->emitted[k] = finds[k].emitted;
        worth->stored[k] = finds[k].count;
        worth->yield[k] = (double)finds[k].count / emitted;
        worth->rays[k] = (double)finds[k].rays / emitted;
        worth->emission_s[k] = finds[k].seconds / emitted;
    }
    worth->share = caustic + rest > 0 ? caustic / (caustic + rest) : 0;
    worth->known = finds[ORL_MAP_CAUSTIC].count >= LEAST_TO_TELL;
}

int orl_worth_measure(const struct orl_shoot_env *env, double (*now_s)(void *ctx), void *ctx,
                      struct orl_worth *ret_worth, struct orl_error *err)
{
    struct find finds[ORL_SHOT_KINDS] = {{0}, {0}};
    struct orl_worth worth = {.contrast = 1};
    int code = 0;
    for (int k = 0; k < ORL_SHOT_KINDS && code == 0; k++) {
        const double started = now_s ? now_s(ctx) : NAN;
        if (k == ORL_MAP_GLOBAL)
            code = run_round(env, ORL_MAP_GLOBAL, 0, GLOBAL_CHUNKS, &finds[k]);
        else if (env->emission->has_caustics)
            code = find_caustics(env, &finds[k]);
        finds[k].seconds = (now_s ? now_s(ctx) : NAN) - started;
    }
    if (code == 0)
        fill_worth(finds, &worth);
    if (code == 0 && worth.known) {
        const struct find *c = &finds[ORL_MAP_CAUSTIC], *g = &finds[ORL_MAP_GLOBAL];
        code = orl_worth_contrast(c->photons, c->count, 1 / (double)c->emitted, g->photons,
                                  g->count, 1 / (double)g->emitted, env->emission->world->geometry,
                                  &worth.contrast);
    }
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        free(finds[k].photons);
    if (code < 0)
        return orl_error_set(err, code, "%s looking for caustics",
                             code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    *ret_worth = worth;
    return 0;
}

#include "photon/shooting/shoot.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"

enum { SMALL_BATCH = 64, DOUBLINGS = 7, BATCH = SMALL_BATCH << DOUBLINGS };
enum { BATCHES_A_MEMBER = 32 }; /* maximum batches of each kind in a round */
_Static_assert((int)SMALL_BATCH % (int)ORL_MAP_BATCHES == 0, "whole blocks");
enum { MOST_GROWTH = 15 }; /* maximum emissions of a round, as a multiple of those before */
/* Emissions, or rays, without a photon after which the search for light ends. */
enum { DRY_EMISSIONS = 64 * BATCH, DRY_RAYS = 1 << 24 };
/* Limit of emissions per photon, beyond which a map stops with fewer photons than its target. */
static const double most_emitted_per_photon = 64, emitted_anyway = 2e6;

/*
 * Batches of one kind. Before the next round the photons of a round's batches are moved to one
 * array. The next round's batches then reuse the same memory, so its pages are touched once and
 * remain in the cache.
 */
struct batch_queue {
    struct orl_deposits *batches; /* batches of a round */
    size_t *offsets;              /* offsets of the batches' photons in `photons` */
    size_t allocated;             /* allocated length of batches and offsets */
    /* batches stored so far, with those of an earlier shot; batches being traced */
    size_t n_done, n_round;
    struct orl_photon *photons; /* photons of this shot's stored batches, in order */
    size_t count, capacity;
    struct orl_health health;
    uint64_t stored, rays;
    bool finished;
};

struct shoot_state {
    const struct orl_shoot_env *env;
    struct batch_queue queues[ORL_SHOT_KINDS];
};

const char *orl_map_kind_name(enum orl_map_kind kind)
{
    static const char *const names[ORL_MAP_KINDS] = {"global", "caustic", "precomputed"};
    return kind < ORL_MAP_KINDS ? names[kind] : "unknown";
}

/*
 * Returns the number of emissions before a batch. The first two batches are small, each one after
 * them is as large as all before it, until they have the full size.
 */
static uint64_t emitted_before(size_t batch)
{
    if (batch > DOUBLINGS)
        return (uint64_t)(batch - DOUBLINGS) * BATCH;
    return batch == 0 ? 0 : (uint64_t)SMALL_BATCH << (batch - 1);
}

/* Computes the number of batches in a shot of that many emissions. Returns false if no shot
 * stops there. */
static bool find_batches(uint64_t emitted, size_t *ret_batches)
{
    size_t batches = emitted / BATCH;
    batches = batches > 0 ? batches + DOUBLINGS : 0;
    while (emitted_before(batches) < emitted && batches <= DOUBLINGS)
        batches++;
    *ret_batches = batches;
    return emitted_before(batches) == emitted;
}

size_t orl_shoot_chunk(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                       uint64_t n, struct orl_deposits *deposits)
{
    const bool caustic = kind == ORL_MAP_CAUSTIC;
    const size_t count = n < ORL_EMISSIONS_AT_ONCE ? n : ORL_EMISSIONS_AT_ONCE;
    double points[ORL_EMISSIONS_AT_ONCE][ORL_SOBOL_DIMENSIONS];
    struct orl_random randoms[ORL_EMISSIONS_AT_ONCE];
    struct orl_photon_ray photon_rays[ORL_EMISSIONS_AT_ONCE];
    bool is_emitted[ORL_EMISSIONS_AT_ONCE];
    for (size_t at = 0; at < count; at += ORL_MAP_BATCHES) {
        struct orl_sobol_block block;
        orl_emission_points(env->emission, env->seed, first + at, caustic, &block);
        for (size_t i = 0; i < ORL_MAP_BATCHES; i++) {
            for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++)
                points[at + i][d] = block.at[d][i];
            randoms[at + i] = orl_random_stream(env->seed, ORL_PURPOSE_PHOTON,
                                                (first + at + i) * ORL_SHOT_KINDS + kind);
        }
    }
    orl_emission_sample_many(env->emission, (const double(*)[ORL_SOBOL_DIMENSIONS])points, count,
                             caustic, randoms, &deposits->health, photon_rays, is_emitted);
    orl_trace_many(env->emission->lit_scene, photon_rays, is_emitted, count, caustic, randoms,
                   deposits);
    return count;
}

static void shoot_batch(void *arg, size_t index, uint32_t member)
{
    struct shoot_state *shoot_state = arg;
    const struct orl_shoot_env *env = shoot_state->env;
    const size_t n_global = shoot_state->queues[ORL_MAP_GLOBAL].n_round;
    const enum orl_map_kind kind = index < n_global ? ORL_MAP_GLOBAL : ORL_MAP_CAUSTIC;
    struct batch_queue *batch_queue = &shoot_state->queues[kind];
    const size_t batch = batch_queue->n_done + (kind == ORL_MAP_GLOBAL ? index : index - n_global);
    struct orl_deposits *deposits = &batch_queue->batches[batch - batch_queue->n_done];
    const uint64_t first = emitted_before(batch), end = emitted_before(batch + 1);
    (void)member;
    for (uint64_t photon = first; photon < end;) {
        if (atomic_load_explicit(env->cancel, memory_order_relaxed))
            return;
        photon += orl_shoot_chunk(env, kind, photon, end - photon, deposits);
    }
}

/* Returns the number of batches that the next round needs, from the yield so far. */
static size_t plan_round(const struct batch_queue *batch_queue, uint64_t target, size_t most)
{
    size_t batches = 1;
    if (batch_queue->finished)
        return 0;
    if (batch_queue->n_done == 0)
        return batches;
    const double emitted = (double)emitted_before(batch_queue->n_done);
    const double yield = (double)batch_queue->stored / emitted;
    double need = MOST_GROWTH * emitted;
    if (yield > 0)
        need = fmin(need, ((double)target - (double)batch_queue->stored) / yield);
    /* No photon yet: no more emissions than are needed to show that there is no light. */
    else
        need = fmin(fmin(need, DRY_EMISSIONS - emitted),
                    DRY_RAYS * emitted / fmax((double)batch_queue->rays, 1) - emitted);
    while (batches < most && (double)emitted_before(batch_queue->n_done + batches) < emitted + need)
        batches++;
    return batches;
}

/* Allocates and clears the round's batches. Returns 0 or ORL_ERR_NOMEM. */
static int prepare_batches(struct batch_queue *batch_queue)
{
    if (batch_queue->n_round > batch_queue->allocated) {
        struct orl_deposits *grown =
            realloc(batch_queue->batches, batch_queue->n_round * sizeof *batch_queue->batches);
        if (!grown)
            return ORL_ERR_NOMEM;
        memset(grown + batch_queue->allocated, 0,
               (batch_queue->n_round - batch_queue->allocated) * sizeof *grown);
        batch_queue->batches = grown;
        size_t *offsets = realloc(batch_queue->offsets, batch_queue->n_round * sizeof *offsets);
        if (!offsets)
            return ORL_ERR_NOMEM;
        batch_queue->offsets = offsets;
        batch_queue->allocated = batch_queue->n_round;
    }
    for (size_t i = 0; i < batch_queue->n_round; i++) {
        struct orl_deposits *batch = &batch_queue->batches[i];
        *batch = (struct orl_deposits){.photons = batch->photons, .capacity = batch->capacity};
    }
    return 0;
}

/* Reserves memory for a batch's photons. Returns 0 or ORL_ERR_NOMEM. */
static int reserve_batch(struct batch_queue *batch_queue, size_t count)
{
    if (count <= batch_queue->capacity - batch_queue->count)
        return 0;
    const size_t least = batch_queue->count + count, capacity = least + least / 2;
    struct orl_photon *grown = realloc(batch_queue->photons, capacity * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    batch_queue->photons = grown;
    batch_queue->capacity = capacity;
    return 0;
}

/* Moves a batch's photons to their offset in the array of photons. */
static void move_batch(void *arg, size_t index, uint32_t member)
{
    const struct batch_queue *batch_queue = arg;
    const struct orl_deposits *batch = &batch_queue->batches[index];
    (void)member;
    if (batch->count > 0)
        memcpy(batch_queue->photons + batch_queue->offsets[index], batch->photons,
               batch->count * sizeof *batch->photons);
}

/* Returns true if the stored batches are enough. Called batch by batch, so that the result does not
 * depend on rounds. */
static bool is_finished(const struct batch_queue *batch_queue, uint64_t target)
{
    const uint64_t emitted = emitted_before(batch_queue->n_done);
    return batch_queue->stored >= target ||
           (batch_queue->stored == 0 &&
            (emitted >= DRY_EMISSIONS || batch_queue->rays >= DRY_RAYS)) ||
           (double)emitted > most_emitted_per_photon * (double)target + emitted_anyway;
}

/* Stores the round's batches up to the one that finishes, and drops the rest. Returns 0 or
 * ORL_ERR_NOMEM. */
static int keep_round(struct batch_queue *batch_queue, uint64_t target,
                      struct orl_thread_pool *pool)
{
    size_t kept = 0;
    int code = 0;
    while (kept < batch_queue->n_round && !batch_queue->finished && code == 0) {
        const struct orl_deposits *batch = &batch_queue->batches[kept];
        const struct orl_health health = orl_deposits_health(batch);
        code = batch->out_of_memory ? ORL_ERR_NOMEM : reserve_batch(batch_queue, batch->count);
        batch_queue->offsets[kept++] = batch_queue->count;
        batch_queue->count += batch->count;
        orl_health_add(&batch_queue->health, &health);
        batch_queue->stored += batch->count;
        batch_queue->rays += batch->health.rays;
        batch_queue->n_done++;
        batch_queue->finished = is_finished(batch_queue, target);
    }
    if (code == 0)
        orl_parallel_for(pool, kept, move_batch, batch_queue);
    batch_queue->n_round = 0;
    return code;
}

/* Drops the photons of a cancelled round, but not its counters. */
static void drop_round(struct batch_queue *batch_queue)
{
    for (size_t i = 0; i < batch_queue->n_round; i++) {
        const struct orl_health health = orl_deposits_health(&batch_queue->batches[i]);
        orl_health_add(&batch_queue->health, &health);
    }
}

/* Moves the photons to the shot. */
static void collect_photons(struct batch_queue *batch_queue, struct orl_shot *shot)
{
    shot->photons = batch_queue->photons;
    shot->count = batch_queue->count;
    batch_queue->photons = NULL;
    shot->emitted = batch_queue->n_done > 0 ? emitted_before(batch_queue->n_done) : 1;
}

/* Adds the counters to the shot, also on failure. */
static void collect_health(const struct batch_queue *batch_queue, struct orl_shot *shot)
{
    const double emitted = (double)(emitted_before(batch_queue->n_done) - shot->earlier_emitted);
    orl_health_add(&shot->health, &batch_queue->health);
    shot->health.flux_w /= fmax(emitted, 1);
    shot->health.flux_capped_w /= fmax(emitted, 1);
}

/* Estimates the rays that the remaining photons of a kind need, from those so far; without
 * photons, those until the search ends. */
static double remaining_rays(const struct batch_queue *batch_queue, const struct orl_shot *shot)
{
    const double emitted = (double)emitted_before(batch_queue->n_done);
    const double new_emitted = emitted - (double)shot->earlier_emitted,
                 rays = (double)batch_queue->rays;
    const double most = most_emitted_per_photon * (double)shot->target + emitted_anyway;
    const double needed =
        batch_queue->stored > 0
            ? fmin(emitted * (double)shot->target / (double)batch_queue->stored, most)
            : DRY_EMISSIONS;
    if (batch_queue->finished || !(new_emitted > 0))
        return 0;
    return rays * fmax(needed - emitted, 0) / new_emitted;
}

/* Reports progress by rays, because they take the time; the number of photons does not show how
 * many emissions the rest needs. */
static void report_progress(const struct shoot_state *shoot_state, const struct orl_shot *shots)
{
    double done = 0, left = 0;
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        done += (double)shoot_state->queues[k].rays;
        left += remaining_rays(&shoot_state->queues[k], &shots[k]);
    }
    if (shoot_state->env->progress)
        shoot_state->env->progress(shoot_state->env->ctx,
                                   done + left > 0 ? done / (done + left) : 1);
}

/* Runs rounds until every queue is finished. */
static int shoot_rounds(struct shoot_state *shoot_state, const struct orl_shot *shots)
{
    const size_t most = BATCHES_A_MEMBER * (size_t)orl_thread_pool_size(shoot_state->env->pool);
    for (;;) {
        size_t total = 0;
        for (int k = 0; k < ORL_SHOT_KINDS; k++) {
            struct batch_queue *batch_queue = &shoot_state->queues[k];
            batch_queue->n_round = plan_round(batch_queue, shots[k].target, most);
            total += batch_queue->n_round;
            if (prepare_batches(batch_queue) < 0) {
                batch_queue->n_round = 0;
                return ORL_ERR_NOMEM;
            }
        }
        if (total == 0)
            return 0;
        orl_parallel_for(shoot_state->env->pool, total, shoot_batch, shoot_state);
        if (atomic_load(shoot_state->env->cancel)) {
            for (int k = 0; k < ORL_SHOT_KINDS; k++)
                drop_round(&shoot_state->queues[k]);
            return ORL_ERR_CANCELLED;
        }
        for (int k = 0; k < ORL_SHOT_KINDS; k++)
            if (keep_round(&shoot_state->queues[k], shots[k].target, shoot_state->env->pool) < 0)
                return ORL_ERR_NOMEM;
        report_progress(shoot_state, shots);
    }
}

/*
 * Reserves memory for all photons wanted and the surplus of the last batch. Pages are not used
 * before they are filled, while an array that grows is copied. If this fails, the array grows.
 */
static void reserve_photons(struct batch_queue *batch_queue, const struct orl_shot *shot)
{
    const uint64_t wanted = shot->target - batch_queue->stored, spare = UINT64_C(2) * BATCH;
    if (batch_queue->finished || wanted > ORL_LIMIT_PHOTONS)
        return;
    batch_queue->photons = orl_memory_new((wanted + spare) * sizeof *batch_queue->photons);
    batch_queue->capacity = batch_queue->photons ? wanted + spare : 0;
}

/* Sets the start of each kind. Returns 0 or ORL_ERR_CORRUPT. */
static int set_up_queues(struct shoot_state *shoot_state, const struct orl_shot *shots)
{
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        struct batch_queue *batch_queue = &shoot_state->queues[k];
        if (!find_batches(shots[k].earlier_emitted, &batch_queue->n_done))
            return ORL_ERR_CORRUPT;
        batch_queue->stored = shots[k].earlier_count;
        batch_queue->finished = shots[k].target == 0 || is_finished(batch_queue, shots[k].target) ||
                                (k == ORL_MAP_CAUSTIC && !shoot_state->env->emission->has_caustics);
        reserve_photons(batch_queue, &shots[k]);
    }
    return 0;
}

static void free_queues(struct shoot_state *shoot_state)
{
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        struct batch_queue *batch_queue = &shoot_state->queues[k];
        for (size_t i = 0; i < batch_queue->allocated; i++)
            free(batch_queue->batches[i].photons);
        free(batch_queue->batches);
        free(batch_queue->offsets);
        free(batch_queue->photons);
    }
}

int orl_shoot(const struct orl_shoot_env *env, struct orl_shot shots[ORL_SHOT_KINDS],
              struct orl_error *err)
{
    struct shoot_state shoot_state = {.env = env};
    int code = set_up_queues(&shoot_state, shots);
    if (code == 0)
        code = shoot_rounds(&shoot_state, shots);
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        if (code == 0)
            collect_photons(&shoot_state.queues[k], &shots[k]);
        collect_health(&shoot_state.queues[k], &shots[k]);
    }
    free_queues(&shoot_state);
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while tracing photons");
    else if (code == ORL_ERR_CORRUPT)
        orl_error_set(err, code, "the photon map to extend ends at an impossible point");
    else if (code < 0)
        orl_error_set(err, code, "out of memory for photons");
    return code;
}

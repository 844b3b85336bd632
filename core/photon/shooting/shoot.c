#include "photon/shooting/shoot.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "base/memory.h"

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
struct queue {
    struct orl_deposits *batches; /* batches of a round */
    size_t *places;               /* offsets of the batches' photons in `photons` */
    size_t room;                  /* allocated length of batches and places */
    /* batches kept so far, with those of an earlier shot; batches being traced */
    size_t n_done, n_round;
    struct orl_photon *photons; /* photons of this shot's batches that are kept, in order */
    size_t count, capacity;
    struct orl_health health;
    uint64_t stored, rays;
    bool finished;
};

struct shooting {
    const struct orl_shoot_env *env;
    struct queue queues[ORL_SHOT_KINDS];
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

size_t orl_shoot_some(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                      uint64_t n, struct orl_deposits *deposits)
{
    const bool caustic = kind == ORL_MAP_CAUSTIC;
    const size_t count = n < ORL_EMISSIONS_AT_ONCE ? n : ORL_EMISSIONS_AT_ONCE;
    double points[ORL_EMISSIONS_AT_ONCE][ORL_SOBOL_DIMENSIONS];
    struct orl_random randoms[ORL_EMISSIONS_AT_ONCE];
    struct orl_flight flights[ORL_EMISSIONS_AT_ONCE];
    bool flies[ORL_EMISSIONS_AT_ONCE];
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
                             caustic, randoms, &deposits->health, flights, flies);
    orl_trace_many(env->emission->world, flights, flies, count, caustic, randoms, deposits);
    return count;
}

static void shoot_batch(void *arg, size_t index, uint32_t member)
{
    struct shooting *shooting = arg;
    const struct orl_shoot_env *env = shooting->env;
    const size_t n_global = shooting->queues[ORL_MAP_GLOBAL].n_round;
    const enum orl_map_kind kind = index < n_global ? ORL_MAP_GLOBAL : ORL_MAP_CAUSTIC;
    struct queue *queue = &shooting->queues[kind];
    const size_t batch = queue->n_done + (kind == ORL_MAP_GLOBAL ? index : index - n_global);
    struct orl_deposits *deposits = &queue->batches[batch - queue->n_done];
    const uint64_t first = emitted_before(batch), end = emitted_before(batch + 1);
    (void)member;
    for (uint64_t photon = first; photon < end;) {
        if (atomic_load_explicit(env->cancel, memory_order_relaxed))
            return;
        photon += orl_shoot_some(env, kind, photon, end - photon, deposits);
    }
}

/* Returns the number of batches that the next round needs, from the yield so far. */
static size_t plan_round(const struct queue *queue, uint64_t target, size_t most)
{
    size_t batches = 1;
    if (queue->finished)
        return 0;
    if (queue->n_done == 0)
        return batches;
    const double emitted = (double)emitted_before(queue->n_done);
    const double yield = (double)queue->stored / emitted;
    double need = MOST_GROWTH * emitted;
    if (yield > 0)
        need = fmin(need, ((double)target - (double)queue->stored) / yield);
    /* No photon yet: no more emissions than are needed to show that there is no light. */
    else
        need = fmin(fmin(need, DRY_EMISSIONS - emitted),
                    DRY_RAYS * emitted / fmax((double)queue->rays, 1) - emitted);
    while (batches < most && (double)emitted_before(queue->n_done + batches) < emitted + need)
        batches++;
    return batches;
}

/* Allocates and clears the round's batches. Returns 0 or ORL_ERR_NOMEM. */
static int prepare_batches(struct queue *queue)
{
    if (queue->n_round > queue->room) {
        struct orl_deposits *grown =
            realloc(queue->batches, queue->n_round * sizeof *queue->batches);
        if (!grown)
            return ORL_ERR_NOMEM;
        memset(grown + queue->room, 0, (queue->n_round - queue->room) * sizeof *grown);
        queue->batches = grown;
        size_t *places = realloc(queue->places, queue->n_round * sizeof *places);
        if (!places)
            return ORL_ERR_NOMEM;
        queue->places = places;
        queue->room = queue->n_round;
    }
    for (size_t i = 0; i < queue->n_round; i++) {
        struct orl_deposits *batch = &queue->batches[i];
        *batch = (struct orl_deposits){.photons = batch->photons, .capacity = batch->capacity};
    }
    return 0;
}

/* Reserves memory for a batch's photons. Returns 0 or ORL_ERR_NOMEM. */
static int reserve_batch(struct queue *queue, size_t count)
{
    if (count <= queue->capacity - queue->count)
        return 0;
    const size_t least = queue->count + count, capacity = least + least / 2;
    struct orl_photon *grown = realloc(queue->photons, capacity * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    queue->photons = grown;
    queue->capacity = capacity;
    return 0;
}

/* Moves a batch's photons to their offset in the array of photons. */
static void move_batch(void *arg, size_t index, uint32_t member)
{
    const struct queue *queue = arg;
    const struct orl_deposits *batch = &queue->batches[index];
    (void)member;
    if (batch->count > 0)
        memcpy(queue->photons + queue->places[index], batch->photons,
               batch->count * sizeof *batch->photons);
}

/* Returns true if the batches kept are enough. Called batch by batch, so that the result does
 * not depend on rounds. */
static bool is_finished(const struct queue *queue, uint64_t target)
{
    const uint64_t emitted = emitted_before(queue->n_done);
    return queue->stored >= target ||
           (queue->stored == 0 && (emitted >= DRY_EMISSIONS || queue->rays >= DRY_RAYS)) ||
           (double)emitted > most_emitted_per_photon * (double)target + emitted_anyway;
}

/* Keeps the round's batches up to the one that finishes, and drops the rest. Returns 0 or
 * ORL_ERR_NOMEM. */
static int keep_round(struct queue *queue, uint64_t target, struct orl_crew *crew)
{
    size_t kept = 0;
    int code = 0;
    while (kept < queue->n_round && !queue->finished && code == 0) {
        const struct orl_deposits *batch = &queue->batches[kept];
        const struct orl_health health = orl_deposits_health(batch);
        code = batch->out_of_memory ? ORL_ERR_NOMEM : reserve_batch(queue, batch->count);
        queue->places[kept++] = queue->count;
        queue->count += batch->count;
        orl_health_add(&queue->health, &health);
        queue->stored += batch->count;
        queue->rays += batch->health.rays;
        queue->n_done++;
        queue->finished = is_finished(queue, target);
    }
    if (code == 0)
        orl_crew_for(crew, kept, move_batch, queue);
    queue->n_round = 0;
    return code;
}

/* Drops the photons of a cancelled round, but keeps its counters. */
static void drop_round(struct queue *queue)
{
    for (size_t i = 0; i < queue->n_round; i++) {
        const struct orl_health health = orl_deposits_health(&queue->batches[i]);
        orl_health_add(&queue->health, &health);
    }
}

/* Moves the photons to the shot. */
static void collect_photons(struct queue *queue, struct orl_shot *shot)
{
    shot->photons = queue->photons;
    shot->count = queue->count;
    queue->photons = NULL;
    shot->emitted = queue->n_done > 0 ? emitted_before(queue->n_done) : 1;
}

/* Adds the counters to the shot, also on failure. */
static void collect_health(const struct queue *queue, struct orl_shot *shot)
{
    const double emitted = (double)(emitted_before(queue->n_done) - shot->had_emitted);
    orl_health_add(&shot->health, &queue->health);
    shot->health.flux_w /= fmax(emitted, 1);
    shot->health.flux_capped_w /= fmax(emitted, 1);
}

/* Estimates the rays that the remaining photons of a kind need, from those so far; without
 * photons, those until the search ends. */
static double rays_to_come(const struct queue *queue, const struct orl_shot *shot)
{
    const double emitted = (double)emitted_before(queue->n_done);
    const double new_emitted = emitted - (double)shot->had_emitted, rays = (double)queue->rays;
    const double most = most_emitted_per_photon * (double)shot->target + emitted_anyway;
    const double needed = queue->stored > 0
                              ? fmin(emitted * (double)shot->target / (double)queue->stored, most)
                              : DRY_EMISSIONS;
    if (queue->finished || !(new_emitted > 0))
        return 0;
    return rays * fmax(needed - emitted, 0) / new_emitted;
}

/* Reports progress by rays, because they take the time; the number of photons does not show how
 * many emissions the rest needs. */
static void report_progress(const struct shooting *shooting, const struct orl_shot *shots)
{
    double done = 0, left = 0;
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        done += (double)shooting->queues[k].rays;
        left += rays_to_come(&shooting->queues[k], &shots[k]);
    }
    if (shooting->env->progress)
        shooting->env->progress(shooting->env->ctx, done + left > 0 ? done / (done + left) : 1);
}

/* Runs rounds until every queue is finished. */
static int shoot_rounds(struct shooting *shooting, const struct orl_shot *shots)
{
    const size_t most = BATCHES_A_MEMBER * (size_t)orl_crew_size(shooting->env->crew);
    for (;;) {
        size_t total = 0;
        for (int k = 0; k < ORL_SHOT_KINDS; k++) {
            struct queue *queue = &shooting->queues[k];
            queue->n_round = plan_round(queue, shots[k].target, most);
            total += queue->n_round;
            if (prepare_batches(queue) < 0) {
                queue->n_round = 0;
                return ORL_ERR_NOMEM;
            }
        }
        if (total == 0)
            return 0;
        orl_crew_for(shooting->env->crew, total, shoot_batch, shooting);
        if (atomic_load(shooting->env->cancel)) {
            for (int k = 0; k < ORL_SHOT_KINDS; k++)
                drop_round(&shooting->queues[k]);
            return ORL_ERR_CANCELLED;
        }
        for (int k = 0; k < ORL_SHOT_KINDS; k++)
            if (keep_round(&shooting->queues[k], shots[k].target, shooting->env->crew) < 0)
                return ORL_ERR_NOMEM;
        report_progress(shooting, shots);
    }
}

/*
 * Reserves memory for all photons wanted and the surplus of the last batch. Pages are not used
 * before they are filled, while an array that grows is copied. If this fails, the array grows.
 */
static void reserve_photons(struct queue *queue, const struct orl_shot *shot)
{
    const uint64_t wanted = shot->target - queue->stored, spare = UINT64_C(2) * BATCH;
    if (queue->finished || wanted > ORL_LIMIT_PHOTONS)
        return;
    queue->photons = orl_memory_new((wanted + spare) * sizeof *queue->photons);
    queue->capacity = queue->photons ? wanted + spare : 0;
}

/* Sets the start of each kind. Returns 0 or ORL_ERR_CORRUPT. */
static int set_up_queues(struct shooting *shooting, const struct orl_shot *shots)
{
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        struct queue *queue = &shooting->queues[k];
        if (!find_batches(shots[k].had_emitted, &queue->n_done))
            return ORL_ERR_CORRUPT;
        queue->stored = shots[k].had;
        queue->finished = shots[k].target == 0 || is_finished(queue, shots[k].target) ||
                          (k == ORL_MAP_CAUSTIC && !shooting->env->emission->has_caustics);
        reserve_photons(queue, &shots[k]);
    }
    return 0;
}

static void free_queues(struct shooting *shooting)
{
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        struct queue *queue = &shooting->queues[k];
        for (size_t i = 0; i < queue->room; i++)
            free(queue->batches[i].photons);
        free(queue->batches);
        free(queue->places);
        free(queue->photons);
    }
}

int orl_shoot(const struct orl_shoot_env *env, struct orl_shot shots[ORL_SHOT_KINDS],
              struct orl_error *err)
{
    struct shooting shooting = {.env = env};
    int code = set_up_queues(&shooting, shots);
    if (code == 0)
        code = shoot_rounds(&shooting, shots);
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        if (code == 0)
            collect_photons(&shooting.queues[k], &shots[k]);
        collect_health(&shooting.queues[k], &shots[k]);
    }
    free_queues(&shooting);
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while tracing photons");
    else if (code == ORL_ERR_CORRUPT)
        orl_error_set(err, code, "a photon map stops where none does");
    else if (code < 0)
        orl_error_set(err, code, "out of memory for photons");
    return code;
}

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "photon/density/precomputed_irradiance.h"
#include "run/cache/emission_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/distributed/task_work.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

/* Warn if fewer than one photon per FEW_PHOTONS emissions is stored and there were more than
 * MANY_EMISSIONS. */
enum { FEW_PHOTONS = 16, MANY_EMISSIONS = 10000000 };

struct map_work {
    uint64_t target;
    bool hit;
    char path[4096];
    struct orl_map_name name;
    struct orl_map_info info;
    struct orl_photon_map *earlier; /* smaller map of the same family, which is extended; or NULL */
    struct orl_map_info earlier_info;
};

/* Returns the store, or NULL if maps stay with the run, as a pilot's do. */
static const struct orl_map_store *store_of(const struct orl_run_state *state)
{
    return state->pilot ? NULL : state->env->store;
}

/* Opens the stored map; without a store there is none. A damaged file is dropped and requested once
 * more; the store then asks this run to build it. */
static int acquire_map(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                       struct orl_error *err)
{
    const struct orl_map_store *store = store_of(state);
    const char *name = orl_map_kind_name(kind);
    work->name = orl_run_map_name(state, kind, work->target);
    memcpy(state->keys[kind], work->name.key, sizeof work->name.key);
    if (!store)
        return 0;
    for (int attempt = 0; attempt < 2; attempt++) {
        int code = store->acquire(store->ctx, name, state->keys[kind], state->env->cancel,
                                  work->path, &work->hit, &work->info, err);
        if (code < 0)
            return code;
        state->pinned[kind] = true;
        if (!work->hit)
            return 0;
        code = orl_photon_map_read(work->path, state->env->cancel, &state->maps[kind], err);
        if (code == 0) {
            const struct orl_map_header *h = orl_photon_map_header(state->maps[kind]);
            snprintf(work->info.kind, sizeof work->info.kind, "%s", name);
            snprintf(work->info.key, sizeof work->info.key, "%s", state->keys[kind]);
            work->info.stored = h->count;
            work->info.emitted = h->emitted;
            work->info.bytes = h->size;
            work->info.reused = 0;
            work->info.earlier_s = work->info.seconds;
            work->info.cached = true;
            return 0;
        }
        if (code != ORL_ERR_CORRUPT && code != ORL_ERR_VERSION)
            return code;
        orl_run_warn(state, "a cached %s photon map %s and is built again", name,
                     code == ORL_ERR_VERSION ? "is of another version of Oriel" : "was damaged");
        store->abandon(store->ctx, name, state->keys[kind]);
        state->pinned[kind] = false;
    }
    return orl_error_set(err, ORL_ERR_CORRUPT,
                         "the cached %s photon map was rebuilt, but is damaged again", name);
}

/* Looks for a smaller map to extend, the largest that is intact. A damaged one is left in place;
 * the job that requests its key drops it. */
static int find_earlier(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                        struct orl_error *err)
{
    const struct orl_map_store *store = store_of(state);
    const char *name = orl_map_kind_name(kind);
    uint64_t below = work->target;
    while (store && store->find_smaller) {
        char path[4096];
        bool found = false;
        struct orl_map_info *info = &work->earlier_info;
        int code = store->find_smaller(store->ctx, name, work->name.family, below, path, &found,
                                       info, err);
        if (code < 0 || !found)
            return code;
        code = orl_photon_map_read(path, state->env->cancel, &work->earlier, NULL);
        if (code == 0 && orl_photon_map_header(work->earlier)->count > 0)
            return 0;
        if (code < 0 && code != ORL_ERR_CANCELLED)
            orl_run_warn(state, "a smaller %s photon map %s and cannot be extended", name,
                         code == ORL_ERR_VERSION ? "is of another version of Oriel" : "is damaged");
        orl_photon_map_free(work->earlier);
        work->earlier = NULL;
        store->release(store->ctx, name, info->key);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled while reading a photon map");
        below = info->target;
    }
    return 0;
}

static void drop_earlier(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work)
{
    const struct orl_map_store *store = store_of(state);
    if (!work->earlier)
        return;
    orl_photon_map_free(work->earlier);
    work->earlier = NULL;
    store->release(store->ctx, orl_map_kind_name(kind), work->earlier_info.key);
}

static void stage_progress(void *ctx, double fraction)
{
    orl_run_report_progress(ctx, fraction);
}

/* Reports progress of the second half of the maps stage. */
static void records_progress(void *ctx, double fraction)
{
    orl_run_report_progress(ctx, 0.5 + 0.5 * fraction);
}

static int shoot_photons(struct orl_run_state *state, struct orl_shot shots[ORL_SHOT_KINDS],
                         struct orl_error *err)
{
    int code = orl_run_ensure_emission(state, err);
    if (code == 0) {
        orl_run_begin_work(state);
        const struct orl_shoot_env env = {.emission = state->emission,
                                          .seed = state->job->seed,
                                          .pool = state->env->pool,
                                          .cancel = state->env->cancel,
                                          .progress = stage_progress,
                                          .ctx = state};
        code = orl_shoot(&env, shots, err);
    }
    return code;
}

/* Photons or records to be written, and their cost. */
struct map_input {
    const struct orl_photon *photons; /* not used any more after writing */
    size_t count;
    uint64_t emitted;
    double seconds;
    const struct orl_precomputed_note *notes; /* additional data of records */
};

/* Writes one map and opens it; without a store the map stays in memory. */
static int make_map(struct orl_run_state *state, enum orl_map_kind kind,
                    const struct map_work *work, const struct map_input *map_input,
                    const struct orl_map_build *build, struct orl_error *err)
{
    struct orl_thread_pool *pool = state->env->pool;
    if (!store_of(state))
        return orl_photon_map_build(map_input->photons, map_input->count, build, pool,
                                    &state->maps[kind], err);
    const int code =
        orl_photon_map_write(work->path, map_input->photons, map_input->count, build, pool, err);
    return code < 0 ? code : orl_photon_map_open(work->path, false, &state->maps[kind], err);
}

/* Makes one map and commits it to the store. */
static int store_map(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                     const struct map_input *map_input, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    const struct orl_map_build build = {
        .kind = orl_map_kind_name(kind),
        .family = work->name.family,
        .target = work->target,
        .emitted = map_input->emitted,
        .seed = state->job->seed,
        .extent = state->lit_scene->geometry->radius,
        .earlier = work->earlier,
        .notes = map_input->notes,
        .note_bytes = map_input->notes ? (uint32_t)sizeof *map_input->notes : 0,
        .free_photons = true};
    const double started = env->now_s(env->ctx);
    const int code = make_map(state, kind, work, map_input, &build, err);
    if (code < 0)
        return code;
    const struct orl_map_header *h = orl_photon_map_header(state->maps[kind]);
    work->info = (struct orl_map_info){
        .target = work->target, .emitted = h->emitted, .stored = h->count, .bytes = h->size};
    work->info.seconds = map_input->seconds + env->now_s(env->ctx) - started;
    if (work->earlier) {
        work->info.reused = orl_photon_map_header(work->earlier)->count;
        work->info.earlier_s = work->earlier_info.seconds;
        work->info.seconds += work->info.earlier_s;
    }
    snprintf(work->info.kind, sizeof work->info.kind, "%s", build.kind);
    memcpy(work->info.key, work->name.key, sizeof work->info.key);
    memcpy(work->info.family, work->name.family, sizeof work->info.family);
    drop_earlier(state, kind, work);
    return store_of(state) ? env->store->commit(env->store->ctx, &work->info, err) : 0;
}

/* Warns once of too few photons in a map, made or found. */
static void warn_of_photons(struct orl_run_state *state, enum orl_map_kind kind, uint64_t target,
                            uint64_t stored, uint64_t emitted)
{
    const unsigned long long found = stored, wanted = target, sent = emitted;
    const bool by_plan = (kind == ORL_MAP_CAUSTIC ? state->job->photons_caustic
                                                  : state->job->photons_global) != target;
    if (found > 0 && found < wanted)
        orl_run_warn_once(
            state, "only %llu of the %llu %s photons %s were found, from %llu emitted", found,
            wanted, orl_map_kind_name(kind), by_plan ? "planned" : "asked for", sent);
    else if (kind == ORL_MAP_CAUSTIC && !by_plan && sent > MANY_EMISSIONS &&
             sent / FEW_PHOTONS > found)
        orl_run_warn_once(
            state,
            "%llu caustic photons took %llu emissions: caustic photons are rare here, so fewer may "
            "be enough; leave out photons.caustic to let the plan choose a number",
            found, sent);
}

/* Warns about the maps' photons and lights, for maps made here and maps found. */
static int warn_of_light(struct orl_run_state *state, const struct map_work *work,
                         struct orl_error *err)
{
    const size_t left_out = state->lit_scene->images.n_left_out;
    bool any = false, black = false;
    for (int k = 0; k < ORL_MAP_KINDS; k++) {
        const bool wanted = work[k].target > 0;
        any = any || wanted;
        black = black || (wanted && k != ORL_MAP_CAUSTIC && work[k].info.stored == 0);
        if (wanted && k < ORL_SHOT_KINDS)
            warn_of_photons(state, (enum orl_map_kind)k, work[k].target, work[k].info.stored,
                            work[k].info.emitted);
    }
    if (any && left_out > 0 && state->lit_scene->n_suns > 0)
        orl_run_warn(state,
                     "flat mirrors and panes face more than %d directions: the sun's reflections "
                     "in %zu of them are not simulated outdoors",
                     ORL_MOST_MIRRORS, left_out);
    if (!black)
        return 0;
    const int code = orl_run_ensure_emission(state, err);
    if (code == 0 && state->emission->n_strata == 0)
        orl_run_warn(state, "no light reaches the scene: everything is black");
    orl_run_warn(state, "no photons: no light reaches a diffuse surface");
    return code;
}

static int store_shot(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                      const struct orl_shot *shot, double seconds, struct orl_error *err)
{
    const struct map_input map_input = {shot->photons, shot->count, shot->emitted, seconds, NULL};
    warn_of_photons(state, kind, shot->target, shot->earlier_count + shot->count, shot->emitted);
    return store_map(state, kind, work, &map_input, err);
}

/* Precomputes irradiance from the global map, which is in state->maps already. */
static int precompute(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    const struct orl_precomputed_build_args making = {.global = state->maps[ORL_MAP_GLOBAL],
                                                      .lit_scene = state->lit_scene,
                                                      .pool = env->pool,
                                                      .searches = state->searches,
                                                      .cancel = env->cancel,
                                                      .progress = records_progress,
                                                      .ctx = state};
    const double started = env->now_s(env->ctx);
    struct map_input map_input = {.emitted = orl_photon_map_header(making.global)->emitted};
    struct orl_precomputed records = {0};
    int code = orl_precomputed_build(&making, &records, err);
    map_input.photons = records.photons;
    map_input.notes = records.notes;
    map_input.count = records.count;
    map_input.seconds = env->now_s(env->ctx) - started;
    if (code == 0)
        code = store_map(state, ORL_MAP_PRECOMPUTED, work, &map_input, err);
    orl_precomputed_done(&records);
    return code;
}

/* Returns one kind's share of the photon time. A single pass traces all kinds, so that the time is
 * divided by the rays of each. */
static double share_of_rays(const struct orl_shot *shots, int kind, double seconds)
{
    const double all =
        (double)(shots[ORL_MAP_GLOBAL].health.rays + shots[ORL_MAP_CAUSTIC].health.rays);
    return all > 0 ? seconds * (double)shots[kind].health.rays / all : 0;
}

static bool is_missing(const struct map_work *work)
{
    return work->target > 0 && !work->hit;
}

/* Sets up the photons to trace for one kind: all, or those that a smaller map lacks. */
static int plan_shot(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                     struct orl_shot *shot, struct orl_error *err)
{
    if (!is_missing(work))
        return 0;
    const int code = find_earlier(state, kind, work, err);
    shot->target = work->target;
    if (work->earlier) {
        shot->earlier_count = orl_photon_map_header(work->earlier)->count;
        shot->earlier_emitted = orl_photon_map_header(work->earlier)->emitted;
    }
    return code;
}

static int build_missing(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct orl_shot shots[ORL_SHOT_KINDS] = {{0}, {0}};
    const double started = env->now_s(env->ctx);
    bool missing = false;
    int code = 0;
    for (int k = 0; k < ORL_SHOT_KINDS && code == 0; k++) {
        code = plan_shot(state, (enum orl_map_kind)k, &work[k], &shots[k], err);
        missing = missing || shots[k].target > 0;
    }
    if (missing && code == 0)
        code = shoot_photons(state, shots, err);
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        orl_health_add(&state->result->health, &shots[k].health);
    if (!missing)
        state->clock.cost_s[ORL_STAGE_PHOTONS] = 0;
    if (!missing && !is_missing(&work[ORL_MAP_PRECOMPUTED]))
        state->clock.cost_s[ORL_STAGE_MAPS] = 0;
    const double seconds = env->now_s(env->ctx) - started;
    orl_run_begin_stage(state, ORL_STAGE_MAPS);
    for (int k = 0; k < ORL_SHOT_KINDS && code == 0; k++)
        if (shots[k].target > 0)
            code = store_shot(state, (enum orl_map_kind)k, &work[k], &shots[k],
                              share_of_rays(shots, k, seconds), err);
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        free(shots[k].photons);
    if (code == 0 && is_missing(&work[ORL_MAP_PRECOMPUTED]))
        code = precompute(state, &work[ORL_MAP_PRECOMPUTED], err);
    return code;
}

/* Requests the maps that the technique reads from the store. Precomputed irradiance comes first:
 * the global map is only needed if it is missing. */
static int acquire_all(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    static const enum orl_map_kind order[ORL_MAP_KINDS] = {ORL_MAP_PRECOMPUTED, ORL_MAP_GLOBAL,
                                                           ORL_MAP_CAUSTIC};
    const struct orl_plan *plan = &state->result->plan;
    int code = 0;
    work[ORL_MAP_GLOBAL].target = plan->photons_global;
    work[ORL_MAP_CAUSTIC].target = plan->photons_caustic;
    if (orl_technique_facts(plan->technique)->reads_map[ORL_MAP_PRECOMPUTED])
        work[ORL_MAP_PRECOMPUTED].target = plan->photons_global;
    for (int i = 0; i < ORL_MAP_KINDS && code == 0; i++) {
        if (order[i] == ORL_MAP_GLOBAL && work[ORL_MAP_PRECOMPUTED].hit)
            work[ORL_MAP_GLOBAL].target = 0;
        if (work[order[i]].target > 0)
            code = acquire_map(state, order[i], &work[order[i]], err);
    }
    return code;
}

static void report_share(void *ctx, double share)
{
    orl_run_report_progress(ctx, share);
}

/* Distributed runs: asks other processes to build the missing maps. */
static int distribute_missing(struct orl_run_state *state, struct map_work *work,
                              struct orl_error *err)
{
    const struct orl_map_store *store = store_of(state);
    const struct orl_job_tasks *shared = state->env->tasks;
    struct orl_job_task tasks[ORL_MAP_KINDS];
    const struct orl_job_tasks_watch watch = {report_share, state};
    bool here[ORL_MAP_KINDS] = {false};
    /* Each map costs the tracing of all photons, because both kinds come from the same paths. */
    const double core_s =
        (state->clock.cost_s[ORL_STAGE_PHOTONS] + state->clock.cost_s[ORL_STAGE_MAPS]) *
        orl_thread_pool_size(state->env->pool);
    size_t n = 0;
    for (int k = 0; k < ORL_MAP_KINDS; k++) {
        if (!is_missing(&work[k]))
            continue;
        struct orl_job_task *job_task = &tasks[n++];
        *job_task = (struct orl_job_task){.work = (double)work[k].target,
                                          .core_s = core_s,
                                          .bytes = ORL_PHOTON_BYTES * work[k].target};
        snprintf(job_task->kind, sizeof job_task->kind, "%s",
                 orl_map_kind_name((enum orl_map_kind)k));
        memcpy(job_task->key, state->keys[k], sizeof job_task->key);
        store->abandon(store->ctx, job_task->kind, job_task->key);
        state->pinned[k] = false;
    }
    if (n == 0)
        return 0;
    orl_run_release_maps(state);
    memset(work, 0, ORL_MAP_KINDS * sizeof *work);
    const int code = orl_job_tasks_claim(shared, tasks, n, here, &watch, err);
    return code < 0 ? code : acquire_all(state, work, err);
}

/* Stores the counters and warnings of a build under each map's key, so that a run which reuses a
 * map reports the same ones. first_warning: index of the first warning about maps in the result. */
static void store_counters(const struct orl_run_state *state, const struct map_work *work,
                           const struct orl_health *health, size_t first_warning)
{
    for (int k = 0; k < ORL_MAP_KINDS; k++)
        if (is_missing(&work[k])) {
            orl_run_store_counts(state, state->keys[k], health);
            orl_run_store_warnings(state, state->keys[k], first_warning);
        }
}

static void load_counters(struct orl_run_state *state, const struct map_work *work)
{
    bool counted = false;
    for (int k = 0; k < ORL_MAP_KINDS; k++)
        if (work[k].target > 0) {
            counted = counted || orl_run_load_counts(state, state->keys[k]);
            orl_run_load_warnings(state, state->keys[k]);
        }
}

/* Distributed runs: finds the maps or makes them here. */
static int build_distributed(struct orl_run_state *state, struct map_work *work,
                             struct orl_error *err)
{
    struct orl_health before, of_searches, health = state->result->health;
    const size_t first_warning = state->result->n_warnings;
    bool any = false;
    int code = distribute_missing(state, work, err);
    for (int k = 0; k < ORL_MAP_KINDS; k++)
        any = any || is_missing(&work[k]);
    if (code < 0)
        return code;
    orl_run_move_health(state, &before);
    state->result->health = (struct orl_health){.rays = 0};
    code = build_missing(state, work, err);
    orl_run_move_health(state, &of_searches);
    orl_health_add(&state->result->health, &of_searches);
    if (code == 0 && any)
        store_counters(state, work, &state->result->health, first_warning);
    else if (code == 0)
        load_counters(state, work);
    orl_health_add(&health, &state->result->health);
    state->result->health = health;
    state->searches[0].health = before;
    return code;
}

int orl_run_prepare_maps(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct map_work *work = calloc(ORL_MAP_KINDS, sizeof *work);
    if (!work)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    int code = acquire_all(state, work, err);
    if (code == 0)
        code = orl_run_is_distributed(state) ? build_distributed(state, work, err)
                                             : build_missing(state, work, err);
    for (int k = 0; k < ORL_MAP_KINDS && code == 0; k++) {
        if (work[k].target == 0)
            continue;
        state->result->maps[state->result->n_maps++] = work[k].info;
        if (env->map_ready)
            env->map_ready(env->ctx, &work[k].info);
    }
    if (code == 0)
        code = warn_of_light(state, work, err);
    /* A failed build leaves nothing behind. */
    for (int k = 0; k < ORL_MAP_KINDS && code < 0; k++) {
        if (state->pinned[k] && !work[k].hit && !work[k].info.kind[0]) {
            env->store->abandon(env->store->ctx, orl_map_kind_name((enum orl_map_kind)k),
                                state->keys[k]);
            state->pinned[k] = false;
        }
        drop_earlier(state, (enum orl_map_kind)k, &work[k]);
    }
    free(work);
    return code;
}

void orl_run_release_maps(struct orl_run_state *state)
{
    const struct orl_map_store *store = store_of(state);
    for (int k = 0; k < ORL_MAP_KINDS; k++) {
        orl_photon_map_free(state->maps[k]);
        state->maps[k] = NULL;
        if (state->pinned[k])
            store->release(store->ctx, orl_map_kind_name((enum orl_map_kind)k), state->keys[k]);
        state->pinned[k] = false;
    }
}

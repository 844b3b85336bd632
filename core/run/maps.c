#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "photon/records.h"
#include "run/stages.h"

/* What a map's photons depend on beyond the scene: raised when their making changes. */
static const char recipe[] = "oriel photons 7";

/* And what precomputed irradiance does beyond its global map. */
static const char records_recipe[] = "oriel records 5";

/* Of precomputed irradiance: from the key of the global map it is made from. */
static void derive_key(const char global[ORL_DIGEST_HEX + 1], char ret_key[ORL_DIGEST_HEX + 1])
{
    unsigned char digest[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state hash;
    crypto_hash_sha256_init(&hash);
    crypto_hash_sha256_update(&hash, (const unsigned char *)records_recipe, sizeof records_recipe);
    crypto_hash_sha256_update(&hash, (const unsigned char *)global, ORL_DIGEST_HEX);
    crypto_hash_sha256_final(&hash, digest);
    sodium_bin2hex(ret_key, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

/*
 * What the plan leaves out changes photons; what it leaves in is in the files. So that jobs share
 * maps whose plans differ in nothing that photons know, it is the world that counts, not the plan.
 */
static void add_plan(crypto_hash_sha256_state *hash, const struct orl_world *world,
                     enum orl_map_kind kind)
{
    const struct orl_omissions *omit = &world->omit;
    const bool caustic = kind == ORL_MAP_CAUSTIC;
    const uint64_t numbers[] = {omit->exterior,
                                omit->glossy,
                                omit->media,
                                omit->refraction,
                                omit->bleached,
                                omit->channels,
                                caustic ? 0 : omit->most_reflections,
                                caustic && omit->mirror_caustics,
                                caustic && omit->lobe_caustics,
                                !caustic && omit->counted_light,
                                caustic && world->caustics_lit,
                                world->n_suns,
                                world->n_domes,
                                world->n_emitters};
    crypto_hash_sha256_update(hash, (const unsigned char *)numbers, sizeof numbers);
    for (size_t i = 0; i < world->n_suns; i++) {
        const struct orl_vec3 n = world->suns[i].frame.n;
        const double sun[] = {n.x, n.y, n.z, world->suns[i].cos_half_angle};
        crypto_hash_sha256_update(hash, (const unsigned char *)sun, sizeof sun);
    }
    for (size_t i = 0; i < world->n_ports; i++) {
        const unsigned char silent = world->ports[i].silent;
        crypto_hash_sha256_update(hash, &silent, sizeof silent);
    }
}

static void make_key(const struct orl_run_state *state, enum orl_map_kind kind, uint64_t target,
                     char ret_key[ORL_DIGEST_HEX + 1])
{
    if (kind == ORL_MAP_PRECOMPUTED) {
        char global[ORL_DIGEST_HEX + 1];
        make_key(state, ORL_MAP_GLOBAL, target, global);
        derive_key(global, ret_key);
        return;
    }
    const uint64_t numbers[4] = {ORL_MAP_VERSION, (uint64_t)kind, target, state->job->seed};
    unsigned char digest[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state hash;
    crypto_hash_sha256_init(&hash);
    crypto_hash_sha256_update(&hash, (const unsigned char *)recipe, sizeof recipe);
    crypto_hash_sha256_update(&hash, state->world->description.digest,
                              sizeof state->world->description.digest);
    crypto_hash_sha256_update(&hash, (const unsigned char *)numbers, sizeof numbers);
    if (state->job->sky.model != ORL_SKY_OF_SCENE)
        crypto_hash_sha256_update(&hash, state->sky_digest, sizeof state->sky_digest);
    add_plan(&hash, state->world, kind);
    crypto_hash_sha256_final(&hash, digest);
    sodium_bin2hex(ret_key, ORL_DIGEST_HEX + 1, digest, sizeof digest);
}

struct map_work {
    uint64_t target;
    bool hit;
    char path[4096];
    struct orl_map_info info;
};

/* Opens what the store had. A damaged file is dropped and asked for once more, then to be built. */
static int acquire(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                   struct orl_error *err)
{
    const struct orl_map_store *store = state->env->store;
    const char *name = orl_map_kind_name(kind);
    make_key(state, kind, work->target, state->keys[kind]);
    for (int attempt = 0; attempt < 2; attempt++) {
        int code = store->acquire(store->ctx, name, state->keys[kind], state->env->cancel,
                                  work->path, &work->hit, &work->info, err);
        if (code < 0)
            return code;
        state->held[kind] = true;
        if (!work->hit)
            return 0;
        code = orl_photon_map_open(work->path, true, &state->maps[kind], err);
        if (code == 0) {
            const struct orl_map_header *h = orl_photon_map_header(state->maps[kind]);
            snprintf(work->info.kind, sizeof work->info.kind, "%s", name);
            snprintf(work->info.key, sizeof work->info.key, "%s", state->keys[kind]);
            work->info.stored = h->count;
            work->info.emitted = h->emitted;
            work->info.bytes = h->size;
            work->info.cached = true;
            return 0;
        }
        if (code != ORL_ERR_CORRUPT && code != ORL_ERR_VERSION)
            return code;
        orl_run_warn(state, "a cached %s photon map was damaged and is built again", name);
        store->abandon(store->ctx, name, state->keys[kind]);
        state->held[kind] = false;
    }
    return orl_error_set(err, ORL_ERR_CORRUPT, "the cached %s photon map is damaged twice over",
                         name);
}

static void stage_progress(void *ctx, double fraction)
{
    orl_run_progress(ctx, fraction);
}

static int shoot(struct orl_run_state *state, struct orl_shot shots[ORL_SHOT_KINDS],
                 struct orl_error *err)
{
    struct orl_emission *emission = NULL;
    int code = orl_emission_new(state->world, state->job->seed, state->env->crew, &emission, err);
    if (code == 0) {
        const struct orl_shoot_env env = {.emission = emission,
                                          .seed = state->job->seed,
                                          .crew = state->env->crew,
                                          .cancel = state->env->cancel,
                                          .progress = stage_progress,
                                          .ctx = state};
        code = orl_shoot(&env, shots, err);
    }
    if (code == 0 && emission->n_strata == 0)
        orl_run_warn(state, "no light reaches the scene: everything is black");
    if (code == 0 && state->world->n_mirrors_left_out > 0)
        orl_run_warn(state,
                     "flat mirrors and panes face more than %d ways: the sun's reflections in %zu "
                     "of them are not simulated outside",
                     ORL_MOST_MIRRORS, state->world->n_mirrors_left_out);
    orl_emission_free(emission);
    return code;
}

/* What there is to write: photons, or records, and what they took. */
struct harvest {
    struct orl_photon *photons;
    size_t count;
    uint64_t emitted;
    double seconds;
    const struct orl_record_note *notes; /* of records */
};

/* Writes one map, hands it to the store and opens it. */
static int keep(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                const struct harvest *harvest, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    const struct orl_map_build build = {.kind = orl_map_kind_name(kind),
                                        .emitted = harvest->emitted,
                                        .seed = state->job->seed,
                                        .notes = harvest->notes,
                                        .note_bytes =
                                            harvest->notes ? (uint32_t)sizeof *harvest->notes : 0};
    const double started = env->now_s(env->ctx);
    int code =
        orl_photon_map_write(work->path, harvest->photons, harvest->count, &build, env->crew, err);
    if (code == 0)
        code = orl_photon_map_open(work->path, false, &state->maps[kind], err);
    if (code < 0)
        return code;
    const struct orl_map_header *h = orl_photon_map_header(state->maps[kind]);
    work->info = (struct orl_map_info){.emitted = h->emitted, .stored = h->count, .bytes = h->size};
    work->info.seconds = harvest->seconds + env->now_s(env->ctx) - started;
    snprintf(work->info.kind, sizeof work->info.kind, "%s", build.kind);
    snprintf(work->info.key, sizeof work->info.key, "%s", state->keys[kind]);
    return env->store->commit(env->store->ctx, &work->info, err);
}

static int keep_shot(struct orl_run_state *state, enum orl_map_kind kind, struct map_work *work,
                     const struct orl_shot *shot, double seconds, struct orl_error *err)
{
    const struct harvest harvest = {shot->photons, shot->count, shot->emitted, seconds, NULL};
    if (shot->count > 0 && shot->count < shot->target)
        orl_run_warn(state, "only %zu of the %llu %s photons asked for were found, of %llu emitted",
                     shot->count, (unsigned long long)shot->target, orl_map_kind_name(kind),
                     (unsigned long long)shot->emitted);
    orl_health_add(&state->result->health, &shot->health);
    return keep(state, kind, work, &harvest, err);
}

/* Irradiance from the global map, which is in state->maps by now. */
static int precompute(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    const struct orl_records_making making = {.global = state->maps[ORL_MAP_GLOBAL],
                                              .world = state->world,
                                              .crew = env->crew,
                                              .searches = state->searches,
                                              .cancel = env->cancel,
                                              .progress = stage_progress,
                                              .ctx = state};
    const double started = env->now_s(env->ctx);
    struct harvest harvest = {.emitted = orl_photon_map_header(making.global)->emitted};
    struct orl_records records = {0};
    int code = orl_records_make(&making, &records, err);
    harvest.photons = records.photons;
    harvest.notes = records.notes;
    harvest.count = records.count;
    harvest.seconds = env->now_s(env->ctx) - started;
    if (code == 0)
        code = keep(state, ORL_MAP_PRECOMPUTED, work, &harvest, err);
    orl_records_done(&records);
    return code;
}

/* Photon time of one kind: the pass is one, so it is told apart by the rays each kind took. */
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

static int build_missing(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct orl_shot shots[ORL_SHOT_KINDS] = {{0}, {0}};
    const double started = env->now_s(env->ctx);
    bool missing = false;
    int code = 0;
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        shots[k].target = is_missing(&work[k]) ? work[k].target : 0;
        missing = missing || shots[k].target > 0;
    }
    if (missing)
        code = shoot(state, shots, err);
    else
        state->cost_s[ORL_STAGE_PHOTONS] = 0;
    if (!missing && !is_missing(&work[ORL_MAP_PRECOMPUTED]))
        state->cost_s[ORL_STAGE_MAPS] = 0;
    const double seconds = env->now_s(env->ctx) - started;
    orl_run_enter(state, ORL_STAGE_MAPS);
    for (int k = 0; k < ORL_SHOT_KINDS && code == 0; k++)
        if (shots[k].target > 0)
            code = keep_shot(state, (enum orl_map_kind)k, &work[k], &shots[k],
                             share_of_rays(shots, k, seconds), err);
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        free(shots[k].photons);
    if (code == 0 && is_missing(&work[ORL_MAP_PRECOMPUTED]))
        code = precompute(state, &work[ORL_MAP_PRECOMPUTED], err);
    return code;
}

/*
 * Asks the store for what the technique reads. Precomputed irradiance comes first: only where it is
 * missing the global map is needed.
 */
static int acquire_all(struct orl_run_state *state, struct map_work *work, struct orl_error *err)
{
    static const enum orl_map_kind order[ORL_MAP_KINDS] = {ORL_MAP_PRECOMPUTED, ORL_MAP_GLOBAL,
                                                           ORL_MAP_CAUSTIC};
    const struct orl_plan *plan = &state->result->plan;
    int code = 0;
    work[ORL_MAP_GLOBAL].target = plan->photons_global;
    work[ORL_MAP_CAUSTIC].target = plan->photons_caustic;
    if (plan->technique == ORL_TECHNIQUE_PRECOMPUTED)
        work[ORL_MAP_PRECOMPUTED].target = plan->photons_global;
    for (int i = 0; i < ORL_MAP_KINDS && code == 0; i++) {
        if (order[i] == ORL_MAP_GLOBAL && work[ORL_MAP_PRECOMPUTED].hit)
            work[ORL_MAP_GLOBAL].target = 0;
        if (work[order[i]].target > 0)
            code = acquire(state, order[i], &work[order[i]], err);
    }
    return code;
}

int orl_run_maps(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct map_work *work = calloc(ORL_MAP_KINDS, sizeof *work);
    if (!work)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_run_enter(state, ORL_STAGE_PHOTONS);
    int code = acquire_all(state, work, err);
    if (code == 0)
        code = build_missing(state, work, err);
    for (int k = 0; k < ORL_MAP_KINDS && code == 0; k++) {
        if (work[k].target == 0)
            continue;
        state->result->maps[state->result->n_maps++] = work[k].info;
        if (env->map_ready)
            env->map_ready(env->ctx, &work[k].info);
        if (work[k].info.stored == 0 && k == ORL_MAP_GLOBAL)
            orl_run_warn(state, "no photons: no light reaches a diffuse surface");
    }
    /* A build that failed leaves nothing behind. */
    for (int k = 0; k < ORL_MAP_KINDS && code < 0; k++) {
        if (state->held[k] && !work[k].hit && !work[k].info.kind[0]) {
            env->store->abandon(env->store->ctx, orl_map_kind_name((enum orl_map_kind)k),
                                state->keys[k]);
            state->held[k] = false;
        }
    }
    free(work);
    return code;
}

void orl_run_release_maps(struct orl_run_state *state)
{
    const struct orl_map_store *store = state->env->store;
    for (int k = 0; k < ORL_MAP_KINDS; k++) {
        orl_photon_map_free(state->maps[k]);
        state->maps[k] = NULL;
        if (state->held[k])
            store->release(store->ctx, orl_map_kind_name((enum orl_map_kind)k), state->keys[k]);
        state->held[k] = false;
    }
}

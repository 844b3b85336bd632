#include "run/cache/emission_cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/memory_cache.h>

#include "run/cache/word_file.h"
#include "run/stages/run_stages.h"

static const char pilot_kind[] = "pilot";

struct cached_emission {
    struct orl_emission *emission; /* owned, detached */
    struct orl_pilot_of_emission pilot;
};

static enum orl_photon_use photon_use(const struct orl_run_state *state)
{
    return orl_technique_facts(state->result->plan.technique)->photons;
}

/* Makes the memory cache key: the emission depends on what its pilot depends on. */
static void make_key(const struct orl_run_state *state, char ret_key[ORL_MEMORY_CACHE_KEY])
{
    char key[ORL_DIGEST_HEX + 1];
    orl_run_pilot_key(state, photon_use(state), key);
    snprintf(ret_key, ORL_MEMORY_CACHE_KEY, "emission %s", key);
}

static void free_cached(void *thing)
{
    struct cached_emission *cached = thing;
    orl_emission_free(cached->emission);
    free(cached);
}

/* Takes the emission of an earlier job. Leaves state->emission NULL if there is none. */
static int take_cached(struct orl_run_state *state)
{
    char key[ORL_MEMORY_CACHE_KEY];
    if (!state->env->memory_cache)
        return 0;
    make_key(state, key);
    struct cached_emission *cached = orl_memory_cache_take(state->env->memory_cache, key);
    if (!cached)
        return 0;
    const int code = orl_emission_attach(cached->emission, state->lit_scene);
    if (code < 0) {
        free_cached(cached);
        return code;
    }
    state->emission = cached->emission;
    state->pilot_of_emission = cached->pilot;
    free(cached);
    return 0;
}

int orl_run_ensure_emission(struct orl_run_state *state, struct orl_error *err)
{
    if (state->emission)
        return 0;
    if (take_cached(state) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory preparing photon emission");
    return state->emission ? 0
                           : orl_emission_new(state->lit_scene, photon_use(state), state->job->seed,
                                              state->env->pool, &state->emission, err);
}

/* ---- The photon pilot ------------------------------------------------------------------------ */

static int run_pilot(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct orl_pilot_of_emission *pilot = &state->pilot_of_emission;
    int code = orl_run_ensure_emission(state, err);
    if (code < 0 || pilot->known)
        return code;
    const struct orl_shoot_env shooting = {.emission = state->emission,
                                           .seed = state->job->seed,
                                           .pool = env->pool,
                                           .cancel = env->cancel};
    memset(pilot, 0, sizeof *pilot);
    code = orl_photon_pilot_run(&shooting, env->now_s, env->ctx, &pilot->result, err);
    pilot->known = code == 0;
    pilot->threads = orl_thread_pool_size(env->pool);
    return code;
}

static bool read_pilot(const char *path, const char *key, struct orl_pilot_of_emission *pilot)
{
    struct orl_word_file_info file_info;
    void *data = NULL;
    size_t size = 0;
    const bool found =
        orl_word_file_read(path, key, &file_info, &data, &size, NULL) == 0 && size == sizeof *pilot;
    if (found)
        memcpy(pilot, data, size);
    free(data);
    return found && pilot->known && pilot->threads > 0;
}

static bool write_pilot(const struct orl_map_store *store, const char *path, const char *key,
                        const struct orl_pilot_of_emission *pilot)
{
    struct orl_map_info info = {.emitted = 0};
    struct orl_word_file_info file_info = {.rays = pilot->result.emitted[ORL_MAP_GLOBAL] +
                                                   pilot->result.emitted[ORL_MAP_CAUSTIC]};
    snprintf(info.kind, sizeof info.kind, "%s", pilot_kind);
    snprintf(info.key, sizeof info.key, "%s", key);
    memcpy(file_info.key, info.key, sizeof file_info.key);
    const bool written = orl_word_file_write(path, &file_info, pilot, sizeof *pilot, NULL) == 0;
    info.emitted = file_info.rays;
    info.bytes = file_info.bytes;
    return written && store->commit(store->ctx, &info, NULL) == 0;
}

/* Sets state->pilot_of_emission. A store that fails costs only the time of another pilot. */
static int find_pilot(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_map_store *store = state->pilot ? NULL : state->env->store;
    struct orl_pilot_of_emission *pilot = &state->pilot_of_emission;
    struct orl_map_info info;
    char path[4096], key[ORL_DIGEST_HEX + 1];
    bool hit = false;
    orl_run_pilot_key(state, photon_use(state), key);
    if (!store || store->acquire(store->ctx, pilot_kind, key, state->env->cancel, path, &hit, &info,
                                 NULL) < 0)
        return run_pilot(state, err);
    if (hit && read_pilot(path, key, pilot)) {
        store->release(store->ctx, pilot_kind, key);
        return 0;
    }
    const int code = run_pilot(state, err);
    if (!hit && code == 0 && write_pilot(store, path, key, pilot))
        store->release(store->ctx, pilot_kind, key);
    else
        store->abandon(store->ctx, pilot_kind, key);
    return code;
}

int orl_run_photon_pilot(struct orl_run_state *state, struct orl_photon_pilot *ret_pilot,
                         struct orl_error *err)
{
    struct orl_pilot_of_emission *pilot = &state->pilot_of_emission;
    int code = state->emission || take_cached(state) == 0 ? 0 : ORL_ERR_NOMEM;
    if (code < 0)
        return orl_error_no_memory(err);
    if (!pilot->known)
        code = find_pilot(state, err);
    if (code < 0)
        return code;
    *ret_pilot = pilot->result;
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        ret_pilot->emission_s[k] *= (double)pilot->threads / orl_thread_pool_size(state->env->pool);
    return 0;
}

void orl_run_release_emission(struct orl_run_state *state)
{
    char key[ORL_MEMORY_CACHE_KEY];
    /* Rounds of a goal may have made it with another seed, which the key does not name. */
    const bool keeps =
        state->emission && state->env->memory_cache && state->emission->seed == state->job->seed;
    struct cached_emission *cached = keeps ? malloc(sizeof *cached) : NULL;
    if (cached) {
        make_key(state, key);
        *cached = (struct cached_emission){state->emission, state->pilot_of_emission};
        const uint64_t bytes = sizeof *cached + orl_emission_detach(cached->emission);
        orl_memory_cache_put(state->env->memory_cache, key, cached, bytes, free_cached);
    } else {
        orl_emission_free(state->emission);
    }
    state->emission = NULL;
}

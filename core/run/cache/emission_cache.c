#include "run/cache/emission_cache.h"

#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/memory_cache.h>

#include "run/stages/run_stages.h"

struct cached_emission {
    struct orl_emission *emission; /* owned, detached */
    struct orl_pilot_of_emission pilot;
};

static enum orl_photon_use photon_use(const struct orl_run_state *state)
{
    return orl_technique_facts(state->result->plan.technique)->photons;
}

/* Makes the key. The families of both maps cover all that photons depend on. */
static void make_key(const struct orl_run_state *state, char ret_key[ORL_MEMORY_CACHE_KEY])
{
    const struct orl_map_name global = orl_run_map_name(state, ORL_MAP_GLOBAL, 0),
                              caustic = orl_run_map_name(state, ORL_MAP_CAUSTIC, 0);
    snprintf(ret_key, ORL_MEMORY_CACHE_KEY, "emission %s %s %d", global.family, caustic.family,
             (int)photon_use(state));
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

int orl_run_photon_pilot(struct orl_run_state *state, struct orl_photon_pilot *ret_pilot,
                         struct orl_error *err)
{
    const struct orl_run_env *env = state->env;
    struct orl_pilot_of_emission *pilot = &state->pilot_of_emission;
    const uint32_t threads = orl_thread_pool_size(env->pool);
    int code = orl_run_ensure_emission(state, err);
    if (code == 0 && !pilot->known) {
        const struct orl_shoot_env shooting = {.emission = state->emission,
                                               .seed = state->job->seed,
                                               .pool = env->pool,
                                               .cancel = env->cancel};
        code = orl_photon_pilot_run(&shooting, env->now_s, env->ctx, &pilot->result, err);
        pilot->known = code == 0;
        pilot->threads = threads;
    }
    if (code < 0)
        return code;
    *ret_pilot = pilot->result;
    for (int k = 0; k < ORL_SHOT_KINDS; k++)
        ret_pilot->emission_s[k] *= (double)pilot->threads / threads;
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

#include "run/cache/file_cache.h"

#include <stdio.h>
#include <string.h>

/* Writes to the path that the store supplied, and commits. */
static int write_and_commit(struct orl_run_state *state, const struct orl_keepable *thing,
                            const char *path, double seconds, struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info = {.seconds = seconds};
    snprintf(info.kind, sizeof info.kind, "%s", thing->kind);
    snprintf(info.key, sizeof info.key, "%s", thing->key);
    const int code = thing->keep(thing->ctx, path, &info, err);
    return code < 0 ? code : store->commit(store->ctx, &info, err);
}

static int make_and_keep(struct orl_run_state *state, const struct orl_keepable *thing,
                         const char *path, struct orl_error *err)
{
    const struct orl_run_env *const env = state->env;
    const struct orl_map_store *const store = env->store;
    const double started = env->now_s(env->ctx);
    struct orl_error why = {0};
    const int code = thing->make(thing->ctx, err);
    if (code < 0 || (thing->is_worth_it && !thing->is_worth_it(thing->ctx))) {
        store->abandon(store->ctx, thing->kind, thing->key);
        return code;
    }
    if (write_and_commit(state, thing, path, env->now_s(env->ctx) - started, &why) == 0) {
        store->release(store->ctx, thing->kind, thing->key);
    } else {
        store->abandon(store->ctx, thing->kind, thing->key);
        orl_run_warn(state, "the %s '%s' could not be kept for later jobs: %s", thing->what,
                     thing->name, why.message);
    }
    return 0;
}

int orl_run_keep(struct orl_run_state *state, const struct orl_keepable *thing,
                 struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info;
    char path[4096];
    bool hit = true;
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        int code = store->acquire(store->ctx, thing->kind, thing->key, state->env->cancel, path,
                                  &hit, &info, err);
        if (code == ORL_ERR_CANCELLED)
            return code;
        if (code < 0)
            break;
        if (!hit)
            return make_and_keep(state, thing, path, err);
        code = thing->open(thing->ctx, path, err);
        if (code == 0 || code == ORL_ERR_CANCELLED) {
            store->release(store->ctx, thing->kind, thing->key);
            return code;
        }
        if (code != ORL_ERR_VERSION || !thing->outdates)
            orl_run_warn(state,
                         "the %s '%s' was kept, but damaged or out of date: it is read again",
                         thing->what, thing->name);
        store->abandon(store->ctx, thing->kind, thing->key);
    }
    memset(err, 0, sizeof *err);
    return thing->make(thing->ctx, err);
}

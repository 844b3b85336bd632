#include "run/cache/file_cache.h"
#include "run/diagnostics/run_warnings.h"
#include "run/run_state.h"

#include <stdio.h>
#include <string.h>

/* Writes to the path that the store supplied, and commits. */
static int write_and_commit(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                            const char *path, double seconds, struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info = {.seconds = seconds};
    snprintf(info.kind, sizeof info.kind, "%s", entry->kind);
    snprintf(info.key, sizeof info.key, "%s", entry->key);
    const int code = entry->write(entry->ctx, path, &info, err);
    return code < 0 ? code : store->commit(store->ctx, &info, err);
}

static int make_and_store(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                          const char *path, struct orl_error *err)
{
    const struct orl_run_env *const env = state->env;
    const struct orl_map_store *const store = env->store;
    const double started = env->now_s(env->ctx);
    struct orl_error why = {0};
    const int code = entry->make(entry->ctx, err);
    if (code < 0 || (entry->is_worth_storing && !entry->is_worth_storing(entry->ctx))) {
        store->abandon(store->ctx, entry->kind, entry->key);
        return code;
    }
    if (write_and_commit(state, entry, path, env->now_s(env->ctx) - started, &why) == 0) {
        store->release(store->ctx, entry->kind, entry->key);
    } else {
        store->abandon(store->ctx, entry->kind, entry->key);
        orl_run_warn(state, "the %s '%s' could not be kept for later jobs: %s", entry->what,
                     entry->name, why.message);
    }
    return 0;
}

int orl_file_cache_get(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                       struct orl_error *err)
{
    const struct orl_map_store *const store = state->env->store;
    struct orl_map_info info;
    char path[4096];
    bool hit = true;
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        int code = store->acquire(store->ctx, entry->kind, entry->key, state->env->cancel, path,
                                  &hit, &info, err);
        if (code == ORL_ERR_CANCELLED)
            return code;
        if (code < 0)
            break;
        if (!hit)
            return make_and_store(state, entry, path, err);
        code = entry->open(entry->ctx, path, err);
        if (code == 0 || code == ORL_ERR_CANCELLED) {
            store->release(store->ctx, entry->kind, entry->key);
            return code;
        }
        if (code != ORL_ERR_VERSION || !entry->may_be_outdated)
            orl_run_warn(state,
                         "the %s '%s' was kept, but damaged or out of date: it is read again",
                         entry->what, entry->name);
        store->abandon(store->ctx, entry->kind, entry->key);
    }
    memset(err, 0, sizeof *err);
    return entry->make(entry->ctx, err);
}

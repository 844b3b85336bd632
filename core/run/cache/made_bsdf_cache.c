#include "run/cache/made_bsdf_cache.h"

#include <stdlib.h>
#include <string.h>

#include "run/cache/word_file.h"

static bool read_cached(const struct orl_made_bsdf_calls *bsdf_calls, const char *path,
                        const char *key)
{
    struct orl_word_file_info file_info;
    void *data = NULL;
    size_t size = 0;
    if (orl_word_file_read(path, key, &file_info, &data, &size, NULL) < 0)
        return false;
    const bool found = bsdf_calls->unpack(bsdf_calls->ctx, data, size);
    free(data);
    return found;
}

/* Stores the BSDF. Returns false on failure; the next job then makes it again. */
static bool store_bsdf(const struct orl_made_bsdf_calls *bsdf_calls,
                       const struct orl_map_store *store, const char *path,
                       struct orl_map_info *info)
{
    struct orl_word_file_info file_info = {.rays = 0};
    size_t size = 0;
    char *data = bsdf_calls->pack(bsdf_calls->ctx, &size, &file_info.rays);
    memcpy(file_info.key, info->key, sizeof file_info.key);
    const bool written = data && orl_word_file_write(path, &file_info, data, size, NULL) == 0;
    free(data);
    info->emitted = file_info.rays;
    info->stored = size / sizeof(float);
    info->bytes = file_info.bytes;
    return written && store->commit(store->ctx, info, NULL) == 0;
}

static int make_and_store(const struct orl_made_bsdf_calls *bsdf_calls,
                          const struct orl_bsdf_make_env *env,
                          const struct orl_bsdf_cache_key *cache_key, const char *path,
                          struct orl_map_info *info, struct orl_error *err)
{
    const struct orl_map_store *store = cache_key->store;
    const double began_s = cache_key->now_s(env->ctx);
    const int code = bsdf_calls->make(bsdf_calls->ctx, err);
    info->seconds = cache_key->now_s(env->ctx) - began_s;
    if (code == 0 && path[0] && store_bsdf(bsdf_calls, store, path, info))
        store->release(store->ctx, ORL_BSDF_CACHE_KIND, info->key);
    else if (path[0])
        store->abandon(store->ctx, ORL_BSDF_CACHE_KIND, info->key);
    return code;
}

int orl_made_bsdf_get(const struct orl_made_bsdf_calls *bsdf_calls,
                      const struct orl_bsdf_make_env *env,
                      const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                      struct orl_error *err)
{
    const struct orl_map_store *store = cache_key->store;
    struct orl_map_info info = {.kind = ORL_BSDF_CACHE_KIND};
    char path[4096] = "";
    bool hit = true;
    memcpy(info.key, cache_key->key, ORL_DIGEST_HEX);
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        struct orl_map_info found = info;
        const int code =
            store->acquire(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key,
                           (atomic_bool *)(uintptr_t)env->cancel, path, &hit, &found, NULL);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled");
        if (code < 0) { /* it is made for this job only */
            path[0] = '\0';
            break;
        }
        if (hit && read_cached(bsdf_calls, path, cache_key->key)) {
            store->release(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key);
            *ret_info = found;
            ret_info->cached = true;
            return 0;
        }
        if (hit) {
            store->abandon(store->ctx, ORL_BSDF_CACHE_KIND, cache_key->key);
            path[0] = '\0';
        }
    }
    *ret_info = info;
    return make_and_store(bsdf_calls, env, cache_key, path, ret_info, err);
}

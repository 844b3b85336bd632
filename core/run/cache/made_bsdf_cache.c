#include "run/cache/made_bsdf_cache.h"

#include <stdlib.h>
#include <string.h>

#include "run/cache/word_file.h"

static bool read_kept(const struct orl_kept_bsdf *bsdf, const char *path, const char *key)
{
    struct orl_kept_about about;
    void *data = NULL;
    size_t size = 0;
    if (orl_kept_read(path, key, &about, &data, &size, NULL) < 0)
        return false;
    const bool found = bsdf->unpack(bsdf->ctx, data, size);
    free(data);
    return found;
}

/* Stores the BSDF. Returns false on failure; the next job then makes it again. */
static bool store_bsdf(const struct orl_kept_bsdf *bsdf, const struct orl_map_store *store,
                       const char *path, struct orl_map_info *info)
{
    struct orl_kept_about about = {.rays = 0};
    size_t size = 0;
    char *data = bsdf->pack(bsdf->ctx, &size, &about.rays);
    memcpy(about.key, info->key, sizeof about.key);
    const bool written = data && orl_kept_write(path, &about, data, size, NULL) == 0;
    free(data);
    info->emitted = about.rays;
    info->stored = size / sizeof(float);
    info->bytes = about.bytes;
    return written && store->commit(store->ctx, info, NULL) == 0;
}

static int make_and_put(const struct orl_kept_bsdf *bsdf, const struct orl_bsdf_make_env *env,
                        const struct orl_bsdf_keep *keep, const char *path,
                        struct orl_map_info *info, struct orl_error *err)
{
    const struct orl_map_store *store = keep->store;
    const double began_s = keep->now_s(env->ctx);
    const int code = bsdf->make(bsdf->ctx, err);
    info->seconds = keep->now_s(env->ctx) - began_s;
    if (code == 0 && path[0] && store_bsdf(bsdf, store, path, info))
        store->release(store->ctx, ORL_MADE_KIND, info->key);
    else if (path[0])
        store->abandon(store->ctx, ORL_MADE_KIND, info->key);
    return code;
}

int orl_kept_bsdf_get(const struct orl_kept_bsdf *bsdf, const struct orl_bsdf_make_env *env,
                      const struct orl_bsdf_keep *keep, struct orl_map_info *ret_info,
                      struct orl_error *err)
{
    const struct orl_map_store *store = keep->store;
    struct orl_map_info info = {.kind = ORL_MADE_KIND};
    char path[4096] = "";
    bool hit = true;
    memcpy(info.key, keep->key, ORL_DIGEST_HEX);
    for (int attempt = 0; attempt < 2 && hit; attempt++) {
        struct orl_map_info found = info;
        const int code =
            store->acquire(store->ctx, ORL_MADE_KIND, keep->key,
                           (atomic_bool *)(uintptr_t)env->cancel, path, &hit, &found, NULL);
        if (code == ORL_ERR_CANCELLED)
            return orl_error_set(err, code, "cancelled");
        if (code < 0) { /* it is made for this job only */
            path[0] = '\0';
            break;
        }
        if (hit && read_kept(bsdf, path, keep->key)) {
            store->release(store->ctx, ORL_MADE_KIND, keep->key);
            *ret_info = found;
            ret_info->cached = true;
            return 0;
        }
        if (hit) {
            store->abandon(store->ctx, ORL_MADE_KIND, keep->key);
            path[0] = '\0';
        }
    }
    *ret_info = info;
    return make_and_put(bsdf, env, keep, path, ret_info, err);
}

/* Caches a computed BSDF in a store (oriel/bsdf/bsdf_cache.h). */
#ifndef ORL_RUN_CACHE_MADE_BSDF_CACHE_H
#define ORL_RUN_CACHE_MADE_BSDF_CACHE_H

#include <oriel/bsdf/bsdf_store.h>

/* Operations for one kind of BSDF; ctx receives the result. */
struct orl_made_bsdf_calls {
    void *ctx;
    int (*make)(void *ctx, struct orl_error *err);
    /* Serialises to whole words, owned by the caller; NULL: out of memory. */
    char *(*pack)(const void *ctx, size_t *ret_size, uint64_t *ret_effort);
    /* Returns false if the data are malformed or memory is exhausted. */
    bool (*unpack)(void *ctx, const char *data, size_t size);
};

/* Finds the BSDF, or makes and stores it. */
int orl_made_bsdf_get(const struct orl_made_bsdf_calls *bsdf_calls,
                      const struct orl_bsdf_make_env *env,
                      const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                      struct orl_error *err);

#endif

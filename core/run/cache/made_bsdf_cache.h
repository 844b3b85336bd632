/* Caches a computed BSDF in a store (oriel/bsdf_kept.h). */
#ifndef ORL_RUN_CACHE_MADE_BSDF_CACHE_H
#define ORL_RUN_CACHE_MADE_BSDF_CACHE_H

#include <oriel/bsdf_kept.h>

/* Operations for one kind of BSDF; ctx receives the result. */
struct orl_kept_bsdf {
    void *ctx;
    int (*make)(void *ctx, struct orl_error *err);
    /* Serialises to whole words, owned by the caller; NULL: out of memory. */
    char *(*pack)(const void *ctx, size_t *ret_size, uint64_t *ret_effort);
    /* Returns false if the data are malformed or memory is exhausted. */
    bool (*unpack)(void *ctx, const char *data, size_t size);
};

/* Finds the BSDF, or makes and stores it. */
int orl_kept_bsdf_get(const struct orl_kept_bsdf *bsdf, const struct orl_bsdf_make_env *env,
                      const struct orl_bsdf_keep *keep, struct orl_map_info *ret_info,
                      struct orl_error *err);

#endif

/*
 * A BSDF that is made, of whatever, once and found again in a store (oriel/bsdf_kept.h).
 */
#ifndef ORL_RUN_KEPT_BSDF_H
#define ORL_RUN_KEPT_BSDF_H

#include <oriel/bsdf_kept.h>

/* One kind of making. ctx has room for what is made. */
struct orl_kept_bsdf {
    void *ctx;
    int (*make)(void *ctx, struct orl_error *err);
    /* As bytes, the caller's; in whole words. NULL: there is no memory. */
    char *(*pack)(const void *ctx, size_t *ret_size, uint64_t *ret_effort);
    /* False: it is of another shape, or there is no memory. */
    bool (*unpack)(void *ctx, const char *data, size_t size);
};

/* Finds it, or makes and keeps it. */
int orl_kept_bsdf_get(const struct orl_kept_bsdf *bsdf, const struct orl_bsdf_make_env *env,
                      const struct orl_bsdf_keep *keep, struct orl_map_info *ret_info,
                      struct orl_error *err);

#endif

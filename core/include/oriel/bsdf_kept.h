/*
 * A BSDF that is made once, of a panel or of measurements, and found again: orl_bsdf_make and
 * orl_bsdf_fit with a store (oriel/run.h) beside them, as kind "made". The result is the same
 * either way, to the bit.
 */
#ifndef ORIEL_BSDF_KEPT_H
#define ORIEL_BSDF_KEPT_H

#include <oriel/bsdf_fit.h>
#include <oriel/bsdf_make.h>
#include <oriel/run.h>

#define ORL_MADE_KIND "made"

struct orl_bsdf_keep {
    const struct orl_map_store *store;
    /* ORL_DIGEST_HEX digits of all that the BSDF depends on, the program included; the caller's to
     * tell. */
    const char *key;
    double (*now_s)(void *ctx); /* a steady clock, called with the environment's ctx */
};

/*
 * *ret_info: what is kept, cached when it was there already; its paths, or rows, are those emitted.
 * Errors as XML are not kept: a request for them is ORL_ERR_INVALID. What cannot be kept, or is
 * found damaged, costs time alone. Else as orl_bsdf_make and orl_bsdf_fit.
 */
int orl_bsdf_make_kept(const struct orl_bsdf_make_request *request,
                       const struct orl_bsdf_make_env *env, const struct orl_bsdf_keep *keep,
                       struct orl_map_info *ret_info, struct orl_bsdf_made *ret_made,
                       struct orl_error *err);
int orl_bsdf_fit_kept(const struct orl_bsdf_fit_request *request,
                      const struct orl_bsdf_make_env *env, const struct orl_bsdf_keep *keep,
                      struct orl_map_info *ret_info, struct orl_bsdf_fitted *ret_fitted,
                      struct orl_error *err);

#endif

/*
 * A panel's BSDF that is made once and found again: orl_bsdf_make with a store (oriel/run.h) beside
 * it, as kind "made". The result is the same either way, to the bit.
 */
#ifndef ORIEL_BSDF_KEPT_H
#define ORIEL_BSDF_KEPT_H

#include <oriel/bsdf_make.h>
#include <oriel/run.h>

#define ORL_MADE_KIND "made"

/*
 * key: ORL_DIGEST_HEX digits of all that the BSDF depends on, the program included; the caller's to
 * tell. now_s: a steady clock, called with env's ctx. *ret_info: what is kept, cached when it was
 * there already. What cannot be kept, or is found damaged, costs time alone. Else as orl_bsdf_make.
 */
int orl_bsdf_make_kept(const struct orl_bsdf_make_request *request,
                       const struct orl_bsdf_make_env *env, const struct orl_map_store *store,
                       const char *key, double (*now_s)(void *ctx), struct orl_map_info *ret_info,
                       struct orl_bsdf_made *ret_made, struct orl_error *err);

#endif

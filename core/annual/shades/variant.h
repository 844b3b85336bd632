/* The scene of a year with its window groups in given states: its files, and material
 * overrides. */
#ifndef ORL_ANNUAL_SHADES_VARIANT_H
#define ORL_ANNUAL_SHADES_VARIANT_H

#include <oriel/annual.h>

#include "scene/swap.h"

struct orl_annual_variant {
    /* The year's request with other scene_files and no groups; the rest is borrowed. */
    struct orl_annual_request request;
    char **files;           /* owned array; names are borrowed */
    struct orl_swap *items; /* one per group */
    struct orl_swaps swaps;
};

/* Builds the variant. states: one per group. parted: light can be split by group (scene/swap.h).
 * Borrows the request, and contains pointers to itself, so it must not be moved. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_INVALID (no file is left); the caller calls orl_annual_variant_done in
 * either case. */
int orl_annual_variant_init(struct orl_annual_variant *variant,
                            const struct orl_annual_request *request, const unsigned char *states,
                            bool parted, struct orl_error *err);
void orl_annual_variant_done(struct orl_annual_variant *variant);

#endif

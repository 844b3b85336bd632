/*
 * The scene of a year with its window groups in states of theirs: which files it has, and which
 * surfaces another material.
 */
#ifndef ORL_ANNUAL_VARIANT_H
#define ORL_ANNUAL_VARIANT_H

#include <oriel/annual.h>

#include "scene/swap.h"

struct orl_annual_variant {
    struct orl_annual_request request; /* the year's, all borrowed but for the next */
    char **files;                      /* names are borrowed */
    struct orl_swap *items;            /* a group each */
    struct orl_swaps swaps;
};

/* states: of each group. parted: so that light can be told apart by group (scene/swap.h). Borrows
 * the request, and points into itself. Returns 0, ORL_ERR_NOMEM or ORL_ERR_INVALID (no file is
 * left); orl_annual_variant_done in either case. */
int orl_annual_variant_init(struct orl_annual_variant *variant,
                            const struct orl_annual_request *request, const unsigned char *states,
                            bool parted, struct orl_error *err);
void orl_annual_variant_done(struct orl_annual_variant *variant);

#endif

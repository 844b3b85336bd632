/*
 * Search for the nearest centers by a kd-tree over their places (Friedman, Bentley and Finkel
 * 1977). The tree is an array in which the middle of every range divides it.
 */
#ifndef ORL_BSDF_FIT_SCAN_KD_TREE_H
#define ORL_BSDF_FIT_SCAN_KD_TREE_H

#include "bsdf/fit/scan/rbf.h"

struct orl_fit_nearest {
    uint32_t center[ORL_FIT_NEIGHBOURS];
    float distance2[ORL_FIT_NEIGHBOURS]; /* squared chords, ascending */
    unsigned count;
};

/* Orders centers->tree and sets axes. */
void orl_fit_kd_tree_build(struct orl_fit_rbf *centers);
void orl_fit_kd_tree_find(const struct orl_fit_rbf *centers, struct orl_vec3 place,
                          struct orl_fit_nearest *ret_found);

#endif

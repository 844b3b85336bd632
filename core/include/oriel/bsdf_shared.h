/*
 * A panel's BSDF (oriel/bsdf_make.h) as a job that is shared (oriel/pieces.h): the paths of a few
 * incident directions are a piece, with an accuracy of each round.
 */
#ifndef ORIEL_BSDF_SHARED_H
#define ORIEL_BSDF_SHARED_H

#include <oriel/bsdf_make.h>
#include <oriel/pieces.h>
#include <oriel/run.h>

/* Borrowed. The store is one that makes nobody wait (orl_shared_store). */
struct orl_bsdf_pieces {
    const struct orl_pieces *pieces;
    const struct orl_map_store *store;
};

/* For the environment of orl_bsdf_make; borrows the state. */
struct orl_bsdf_sharing orl_bsdf_share(struct orl_bsdf_pieces *state);

#endif

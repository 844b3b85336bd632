/*
 * Distributes the computation of a panel's BSDF (oriel/bsdf_make.h) over processes
 * (oriel/pieces.h). A piece is the paths of a few incident directions; with an accuracy, those of
 * one round.
 */
#ifndef ORIEL_BSDF_SHARED_H
#define ORIEL_BSDF_SHARED_H

#include <oriel/bsdf_make.h>
#include <oriel/pieces.h>
#include <oriel/run.h>

/* Borrowed. The store never blocks (orl_shared_store). */
struct orl_bsdf_pieces {
    const struct orl_pieces *pieces;
    const struct orl_map_store *store;
};

/* Returns a sharing object for the environment of orl_bsdf_make; it borrows the state. */
struct orl_bsdf_sharing orl_bsdf_share(struct orl_bsdf_pieces *state);

#endif

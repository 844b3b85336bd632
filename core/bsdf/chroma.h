/*
 * Colour of one component: the colour channels beside its luminances, and the tints made of them.
 *
 * Matrices have one tint per value. Trees keep u' and v' as separate trees, usually much coarser
 * than the luminance's. Both have `total`: tints of the integral over the other direction, for each
 * given direction. Entries are by matrix cell, by cell of a grid of 2^depth a side (rank 4), or by
 * ring of A (rank 3). Rank 3 has none for B, because their colour is never needed.
 *
 * Ownership: owned by the component; freed by orl_chroma_done. Immutable once finished; safe to
 * read from any number of threads.
 */
#ifndef ORL_BSDF_CHROMA_H
#define ORL_BSDF_CHROMA_H

#include "bsdf/color.h"
#include "bsdf/data.h"
#include "bsdf/matrix/matrix.h"
#include "bsdf/tree/tree.h"

enum { ORL_CHROMA_CHANNELS = 2 }; /* X and Z, or u' and v' */

struct orl_chroma {
    bool given[ORL_CHROMA_CHANNELS]; /* true if the file has this channel */
    struct orl_tree tree[ORL_CHROMA_CHANNELS];
    struct orl_iso iso[ORL_CHROMA_CHANNELS];
    struct orl_matrix matrix[ORL_CHROMA_CHANNELS]; /* freed by orl_chroma_finish */
    bool present;            /* true if both channels fit the luminance: the fields below are set */
    struct orl_tint *values; /* matrices: indexed like orl_matrix.values */
    struct orl_tint *total[2];
    size_t cells; /* entries of each total; for matrices the larger of both axes */
    size_t n_values;
    unsigned depth; /* rank 4: total has 2^depth cells a side */
    unsigned rings; /* rank 3: number of rings in total */
};

struct orl_component; /* defined in document.h */

/*
 * Makes the tints of component->chroma if both channels are given and match the luminance; frees
 * what is no longer needed. Adds to *outside the number of colours that RGB cannot represent.
 * Returns 0 or ORL_ERR_NOMEM.
 */
int orl_chroma_finish(enum orl_structure structure, struct orl_component *component,
                      size_t *outside, struct orl_error *err);
void orl_chroma_done(struct orl_chroma *chroma);
size_t orl_chroma_bytes(const struct orl_chroma *chroma);

/* Tint of one value, and tint of the integral for a given direction. Grey if there is no colour. */
struct orl_tint orl_chroma_tint(enum orl_structure structure, const struct orl_component *component,
                                const struct orl_coords *a, const struct orl_coords *b);
struct orl_tint orl_chroma_total(enum orl_structure structure,
                                 const struct orl_component *component, enum orl_tree_axis given,
                                 const struct orl_coords *coords);

#endif

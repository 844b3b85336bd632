/*
 * The colour of one component: what stands beside its luminances, and the tints made of it.
 *
 * Matrices get a tint per value. Trees keep u' and v' as plain trees of their own, which are as a
 * rule much coarser than the luminance's. Either way there is a tint of the integral over the other
 * direction per given one: total, by matrix cell; by cell of 2^depth a side (trees of rank 4); by
 * ring of A (rank 3, where no integral given B is asked for its colour).
 *
 * Ownership: a component's; orl_chroma_done. Immutable once finished, any number may read.
 */
#ifndef ORL_BSDF_CHROMA_H
#define ORL_BSDF_CHROMA_H

#include "bsdf/color.h"
#include "bsdf/data.h"
#include "bsdf/matrix.h"
#include "bsdf/tree.h"

enum { ORL_CHROMA_CHANNELS = 2 }; /* X and Z, or u' and v' */

struct orl_chroma {
    bool given[ORL_CHROMA_CHANNELS]; /* by the file */
    struct orl_tree tree[ORL_CHROMA_CHANNELS];
    struct orl_iso iso[ORL_CHROMA_CHANNELS];
    struct orl_matrix matrix[ORL_CHROMA_CHANNELS]; /* until finished */
    bool present;            /* both were given and fit: all below is filled in */
    struct orl_tint *values; /* matrices: as orl_matrix.values */
    struct orl_tint *total[2];
    size_t cells; /* of each total: a matrix's may differ, the larger counts */
    size_t n_values;
    unsigned depth; /* trees of rank 4: of total */
    unsigned rings; /* trees of rank 3: of total */
};

struct orl_component; /* whose colour it is: document.h */

/*
 * Makes the tints of component->chroma, when both its channels are given and fit; gives back what
 * is not needed. Values of colours that RGB cannot show are counted in *outside. Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_chroma_finish(enum orl_structure structure, struct orl_component *component,
                      size_t *outside, struct orl_error *err);
void orl_chroma_done(struct orl_chroma *chroma);
size_t orl_chroma_bytes(const struct orl_chroma *chroma);

/* The tint of one value, and that of the integral for a given direction. Grey without colour. */
struct orl_tint orl_chroma_tint(enum orl_structure structure, const struct orl_component *component,
                                const struct orl_coords *a, const struct orl_coords *b);
struct orl_tint orl_chroma_total(enum orl_structure structure,
                                 const struct orl_component *component, enum orl_tree_axis given,
                                 const struct orl_coords *coords);

#endif

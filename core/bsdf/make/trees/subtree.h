/*
 * A part of a tree's incident directions that one thread measures: a cell at some level, with all
 * cells below it. Blocks of a shared BSDF are sent between machines in serialised form.
 */
#ifndef ORL_BSDF_MAKE_TREES_SUBTREE_H
#define ORL_BSDF_MAKE_TREES_SUBTREE_H

#include "bsdf/make/batch_mean.h"
#include "bsdf/make/trees/tree_builder.h"

struct orl_gonio_subtree {
    struct orl_gonio_builder builder;
    struct orl_gonio_cells
        top_nodes; /* [transmitted][cell out at that level]; owned; NULL at first */
    double totals[ORL_GONIO_BATCHES][2], lost;
    double peaks[2]; /* 1/sr; reflected, transmitted: estimates from a few paths */
    uint64_t paths;
    bool not_converged; /* true if an error was predicted above the accuracy at the most paths */
    int code;
};
void orl_gonio_subtree_done(struct orl_gonio_subtree *subtree);

/* Returns the serialised size of a block that has n_tops top nodes, or none if it is not measured.
 */
size_t orl_gonio_subtree_bytes(const struct orl_gonio_subtree *subtree, size_t n_top_nodes);
/* Serialises a block. Returns the position after it. */
char *orl_gonio_subtree_pack(const struct orl_gonio_subtree *subtree, size_t n_top_nodes, char *to);
/* Reads a block from at most `most` bytes. Returns the position after it, or NULL if its shape
 * differs or memory is out. The builder's rank, cull and color must be set before. */
const char *orl_gonio_subtree_unpack(struct orl_gonio_subtree *subtree, size_t n_top_nodes,
                                     const char *from, size_t most);

#endif

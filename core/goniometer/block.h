/*
 * A part of a tree's incident directions that one thread measures: a cell at some level, with all
 * cells below it. Blocks of a shared BSDF are sent between machines in serialised form.
 */
#ifndef ORL_GONIOMETER_BLOCK_H
#define ORL_GONIOMETER_BLOCK_H

#include "goniometer/batches.h"
#include "goniometer/forest.h"

struct orl_gonio_block {
    struct orl_gonio_forest forest;
    struct orl_gonio_cells tops; /* [transmitted][cell out at that level]; owned; NULL at first */
    double totals[ORL_GONIO_BATCHES][2], lost;
    double peaks[2]; /* 1/sr; reflected, transmitted: estimates from a few paths */
    uint64_t paths;
    bool short_of; /* true if an error was predicted above the accuracy at the most paths */
    int code;
};
void orl_gonio_block_done(struct orl_gonio_block *block);

/* Returns the serialised size of a block that has n_tops tops, or none if it is not measured. */
size_t orl_gonio_block_bytes(const struct orl_gonio_block *block, size_t n_tops);
/* Serialises a block. Returns the position after it. */
char *orl_gonio_block_pack(const struct orl_gonio_block *block, size_t n_tops, char *to);
/* Reads a block from at most `most` bytes. Returns the position after it, or NULL if its shape
 * differs or memory is out. The forest's rank, cull and color must be set before. */
const char *orl_gonio_block_unpack(struct orl_gonio_block *block, size_t n_tops, const char *from,
                                   size_t most);

#endif

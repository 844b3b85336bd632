/*
 * A part of a tree's incident directions that one thread measures: a cell at some level, with all
 * below it. Blocks of a BSDF that is shared go from one machine to another by their bytes.
 */
#ifndef ORL_GONIOMETER_BLOCK_H
#define ORL_GONIOMETER_BLOCK_H

#include "goniometer/batches.h"
#include "goniometer/forest.h"

struct orl_gonio_block {
    struct orl_gonio_forest forest;
    struct orl_gonio_cells tops; /* [transmitted][cell out at that level]; owned; none: it is not
                                    measured yet */
    double totals[ORL_GONIO_BATCHES][2], lost;
    double peaks[2]; /* reflected, transmitted: as few paths tell them */
    uint64_t paths;
    bool short_of; /* an error was foreseen above the accuracy, for want of paths */
    int code;
};
void orl_gonio_block_done(struct orl_gonio_block *block);

/* Bytes of a block that has so many tops, or none. */
size_t orl_gonio_block_bytes(const struct orl_gonio_block *block, size_t n_tops);
/* Returns what is behind it. */
char *orl_gonio_block_pack(const struct orl_gonio_block *block, size_t n_tops, char *to);
/* From so many bytes at the most: what is behind it; NULL: it is of another shape, or there is no
 * memory. The forest has its rank, cull and color already. */
const char *orl_gonio_block_unpack(struct orl_gonio_block *block, size_t n_tops, const char *from,
                                   size_t most);

#endif

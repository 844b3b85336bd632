#include "goniometer/block.h"

#include <stdlib.h>
#include <string.h>

/* A block in its bytes: this, its tops, its branches. */
struct kept {
    uint64_t n_tops, n_branches, paths, short_of;
    double totals[ORL_GONIO_BATCHES][2], lost, peaks[2];
};

void orl_gonio_block_done(struct orl_gonio_block *block)
{
    orl_gonio_forest_done(&block->forest);
    free(block->tops);
    block->tops = NULL;
}

static size_t bytes_of(uint64_t n_tops, uint64_t n_branches)
{
    return sizeof(struct kept) + n_tops * sizeof(struct orl_gonio_node) +
           n_branches * sizeof(struct orl_gonio_branch);
}

size_t orl_gonio_block_bytes(const struct orl_gonio_block *block, size_t n_tops)
{
    return bytes_of(block->tops ? n_tops : 0, block->forest.count);
}

char *orl_gonio_block_pack(const struct orl_gonio_block *block, size_t n_tops, char *to)
{
    const size_t tops = block->tops ? n_tops : 0, branches = block->forest.count;
    struct kept kept = {.n_tops = tops,
                        .n_branches = branches,
                        .paths = block->paths,
                        .short_of = block->short_of,
                        .lost = block->lost};
    memcpy(kept.totals, block->totals, sizeof kept.totals);
    memcpy(kept.peaks, block->peaks, sizeof kept.peaks);
    memcpy(to, &kept, sizeof kept);
    to += sizeof kept;
    if (tops > 0)
        memcpy(to, block->tops, tops * sizeof *block->tops);
    to += tops * sizeof *block->tops;
    if (branches > 0)
        memcpy(to, block->forest.branches, branches * sizeof *block->forest.branches);
    return to + branches * sizeof *block->forest.branches;
}

/* Refers to none but branches that are there. */
static bool is_sound(const struct orl_gonio_node *nodes, size_t n, uint64_t n_branches)
{
    for (size_t i = 0; i < n; i++)
        if (nodes[i].branch > n_branches)
            return false;
    return true;
}

static bool fill(struct orl_gonio_block *block, const struct kept *kept, const char *from)
{
    struct orl_gonio_forest *forest = &block->forest;
    const size_t tops = kept->n_tops * sizeof *block->tops;
    const size_t branches = kept->n_branches * sizeof *forest->branches;
    orl_gonio_block_done(block);
    block->tops = kept->n_tops > 0 ? malloc(tops) : NULL;
    forest->branches = branches > 0 ? malloc(branches) : NULL;
    if ((branches > 0 && !forest->branches) || (tops > 0 && !block->tops))
        return false;
    if (block->tops)
        memcpy(block->tops, from, tops);
    if (forest->branches)
        memcpy(forest->branches, from + tops, branches);
    forest->count = forest->room = kept->n_branches;
    bool sound = !block->tops || is_sound(block->tops, kept->n_tops, kept->n_branches);
    for (size_t i = 0; forest->branches && i < forest->count && sound; i++)
        sound = is_sound(forest->branches[i].child, ORL_GONIO_FAN_MOST, i);
    return sound;
}

const char *orl_gonio_block_unpack(struct orl_gonio_block *block, size_t n_tops, const char *from,
                                   size_t most)
{
    const unsigned rank = block->forest.rank;
    const struct orl_gonio_cull cull = block->forest.cull;
    struct kept kept;
    if (most < sizeof kept)
        return NULL;
    memcpy(&kept, from, sizeof kept);
    if ((kept.n_tops != 0 && kept.n_tops != n_tops) || kept.n_branches > most ||
        bytes_of(kept.n_tops, kept.n_branches) > most || !fill(block, &kept, from + sizeof kept))
        return NULL;
    block->forest.rank = rank;
    block->forest.cull = cull;
    memcpy(block->totals, kept.totals, sizeof block->totals);
    memcpy(block->peaks, kept.peaks, sizeof block->peaks);
    block->lost = kept.lost;
    block->paths = kept.paths;
    block->short_of = kept.short_of != 0;
    return from + bytes_of(kept.n_tops, kept.n_branches);
}

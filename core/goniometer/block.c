#include "goniometer/block.h"

#include <stdlib.h>
#include <string.h>

/* Header of a serialised block. Its tops and branches follow; with colour also the hues of both. */
struct kept {
    uint64_t n_tops, n_branches, paths, short_of;
    double totals[ORL_GONIO_BATCHES][2], lost, peaks[2];
};

void orl_gonio_block_done(struct orl_gonio_block *block)
{
    orl_gonio_forest_done(&block->forest);
    orl_gonio_cells_done(&block->tops);
}

static size_t bytes_of(uint64_t n_tops, uint64_t n_branches, bool color)
{
    const size_t hues =
        n_tops * sizeof(struct orl_gonio_hue) + n_branches * sizeof(struct orl_gonio_branch_hues);
    return sizeof(struct kept) + n_tops * sizeof(struct orl_gonio_node) +
           n_branches * sizeof(struct orl_gonio_branch) + (color ? hues : 0);
}

size_t orl_gonio_block_bytes(const struct orl_gonio_block *block, size_t n_tops)
{
    return bytes_of(block->tops.nodes ? n_tops : 0, block->forest.count, block->forest.color);
}

static char *put_bytes(char *to, const void *from, size_t size)
{
    if (size > 0)
        memcpy(to, from, size);
    return to + size;
}

char *orl_gonio_block_pack(const struct orl_gonio_block *block, size_t n_tops, char *to)
{
    const struct orl_gonio_forest *forest = &block->forest;
    const size_t tops = block->tops.nodes ? n_tops : 0, branches = forest->count;
    struct kept kept = {.n_tops = tops,
                        .n_branches = branches,
                        .paths = block->paths,
                        .short_of = block->short_of,
                        .lost = block->lost};
    memcpy(kept.totals, block->totals, sizeof kept.totals);
    memcpy(kept.peaks, block->peaks, sizeof kept.peaks);
    to = put_bytes(to, &kept, sizeof kept);
    to = put_bytes(to, block->tops.nodes, tops * sizeof *block->tops.nodes);
    to = put_bytes(to, forest->branches, branches * sizeof *forest->branches);
    if (!forest->color)
        return to;
    to = put_bytes(to, block->tops.hues, tops * sizeof *block->tops.hues);
    return put_bytes(to, forest->hues, branches * sizeof *forest->hues);
}

/* Returns true if all nodes refer to existing branches. */
static bool is_sound(const struct orl_gonio_node *nodes, size_t n, uint64_t n_branches)
{
    for (size_t i = 0; i < n; i++)
        if (nodes[i].branch > n_branches)
            return false;
    return true;
}

/* Returns a new array with a copy of `size` bytes; sets *fine to false if out of memory. */
static void *get_array(const char **from, size_t size, bool *fine)
{
    void *array = size > 0 ? malloc(size) : NULL;
    *fine = *fine && (array || size == 0);
    if (array)
        memcpy(array, *from, size);
    *from += size;
    return array;
}

static bool fill_block(struct orl_gonio_block *block, const struct kept *kept, const char *from,
                       bool color)
{
    struct orl_gonio_forest *forest = &block->forest;
    const size_t tops = kept->n_tops, branches = kept->n_branches;
    bool fine = true;
    orl_gonio_block_done(block);
    block->tops.nodes = get_array(&from, tops * sizeof *block->tops.nodes, &fine);
    forest->branches = get_array(&from, branches * sizeof *forest->branches, &fine);
    if (color) {
        block->tops.hues = get_array(&from, tops * sizeof *block->tops.hues, &fine);
        forest->hues = get_array(&from, branches * sizeof *forest->hues, &fine);
    }
    forest->count = forest->room = forest->hues_room = branches;
    fine = fine && (!block->tops.nodes || is_sound(block->tops.nodes, tops, branches));
    for (size_t i = 0; i < branches && fine; i++)
        fine = is_sound(forest->branches[i].child, ORL_GONIO_FAN_MOST, i);
    return fine;
}

const char *orl_gonio_block_unpack(struct orl_gonio_block *block, size_t n_tops, const char *from,
                                   size_t most)
{
    const unsigned rank = block->forest.rank;
    const struct orl_gonio_cull cull = block->forest.cull;
    const bool color = block->forest.color;
    struct kept kept;
    if (most < sizeof kept)
        return NULL;
    memcpy(&kept, from, sizeof kept);
    if ((kept.n_tops != 0 && kept.n_tops != n_tops) || kept.n_branches > most ||
        bytes_of(kept.n_tops, kept.n_branches, color) > most ||
        !fill_block(block, &kept, from + sizeof kept, color))
        return NULL;
    block->forest.rank = rank;
    block->forest.cull = cull;
    block->forest.color = color;
    memcpy(block->totals, kept.totals, sizeof block->totals);
    memcpy(block->peaks, kept.peaks, sizeof block->peaks);
    block->lost = kept.lost;
    block->paths = kept.paths;
    block->short_of = kept.short_of != 0;
    return from + bytes_of(kept.n_tops, kept.n_branches, color);
}

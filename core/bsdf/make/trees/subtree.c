/* The subtree that one thread measures, and its bytes for transfer between machines. */
#include "bsdf/make/trees/measure_subtrees.h"

#include <stdlib.h>
#include <string.h>

/* Header of a serialised subtree. Its top nodes and branches follow; with colour also the colours
 * of both. */
struct subtree_header {
    uint64_t n_top_nodes, n_branches, paths, not_converged;
    double totals[ORL_GONIO_BATCHES][2], lost, peaks[2];
};

void orl_gonio_subtree_done(struct orl_gonio_subtree *subtree)
{
    orl_gonio_builder_done(&subtree->builder);
    orl_gonio_cells_done(&subtree->top_nodes);
}

static size_t bytes_of(uint64_t n_top_nodes, uint64_t n_branches, bool color)
{
    const size_t colors = n_top_nodes * sizeof(struct orl_gonio_color) +
                          n_branches * sizeof(struct orl_gonio_branch_colors);
    return sizeof(struct subtree_header) + n_top_nodes * sizeof(struct orl_gonio_node) +
           n_branches * sizeof(struct orl_gonio_branch) + (color ? colors : 0);
}

size_t orl_gonio_subtree_bytes(const struct orl_gonio_subtree *subtree, size_t n_top_nodes)
{
    return bytes_of(subtree->top_nodes.nodes ? n_top_nodes : 0, subtree->builder.count,
                    subtree->builder.color);
}

static char *put_bytes(char *to, const void *from, size_t size)
{
    if (size > 0)
        memcpy(to, from, size);
    return to + size;
}

char *orl_gonio_subtree_pack(const struct orl_gonio_subtree *subtree, size_t n_top_nodes, char *to)
{
    const struct orl_gonio_builder *builder = &subtree->builder;
    const size_t top_nodes = subtree->top_nodes.nodes ? n_top_nodes : 0, branches = builder->count;
    struct subtree_header subtree_header = {.n_top_nodes = top_nodes,
                                            .n_branches = branches,
                                            .paths = subtree->paths,
                                            .not_converged = subtree->not_converged,
                                            .lost = subtree->lost};
    memcpy(subtree_header.totals, subtree->totals, sizeof subtree_header.totals);
    memcpy(subtree_header.peaks, subtree->peaks, sizeof subtree_header.peaks);
    to = put_bytes(to, &subtree_header, sizeof subtree_header);
    to = put_bytes(to, subtree->top_nodes.nodes, top_nodes * sizeof *subtree->top_nodes.nodes);
    to = put_bytes(to, builder->branches, branches * sizeof *builder->branches);
    if (!builder->color)
        return to;
    to = put_bytes(to, subtree->top_nodes.colors, top_nodes * sizeof *subtree->top_nodes.colors);
    return put_bytes(to, builder->colors, branches * sizeof *builder->colors);
}

/* Returns true if all nodes refer to existing branches. */
static bool are_valid_nodes(const struct orl_gonio_node *nodes, size_t n, uint64_t n_branches)
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

static bool fill_block(struct orl_gonio_subtree *subtree,
                       const struct subtree_header *subtree_header, const char *from, bool color)
{
    struct orl_gonio_builder *builder = &subtree->builder;
    const size_t top_nodes = subtree_header->n_top_nodes, branches = subtree_header->n_branches;
    bool fine = true;
    orl_gonio_subtree_done(subtree);
    subtree->top_nodes.nodes =
        get_array(&from, top_nodes * sizeof *subtree->top_nodes.nodes, &fine);
    builder->branches = get_array(&from, branches * sizeof *builder->branches, &fine);
    if (color) {
        subtree->top_nodes.colors =
            get_array(&from, top_nodes * sizeof *subtree->top_nodes.colors, &fine);
        builder->colors = get_array(&from, branches * sizeof *builder->colors, &fine);
    }
    builder->count = builder->capacity = builder->colors_capacity = branches;
    fine = fine && (!subtree->top_nodes.nodes ||
                    are_valid_nodes(subtree->top_nodes.nodes, top_nodes, branches));
    for (size_t i = 0; fine && builder->branches && i < branches; i++)
        fine = are_valid_nodes(builder->branches[i].child, ORL_GONIO_MAX_BRANCHING, i);
    return fine;
}

const char *orl_gonio_subtree_unpack(struct orl_gonio_subtree *subtree, size_t n_top_nodes,
                                     const char *from, size_t most)
{
    const unsigned rank = subtree->builder.rank;
    const struct orl_gonio_cull cull = subtree->builder.cull;
    const bool color = subtree->builder.color;
    struct subtree_header subtree_header;
    if (most < sizeof subtree_header)
        return NULL;
    memcpy(&subtree_header, from, sizeof subtree_header);
    if ((subtree_header.n_top_nodes != 0 && subtree_header.n_top_nodes != n_top_nodes) ||
        subtree_header.n_branches > most ||
        bytes_of(subtree_header.n_top_nodes, subtree_header.n_branches, color) > most ||
        !fill_block(subtree, &subtree_header, from + sizeof subtree_header, color))
        return NULL;
    subtree->builder.rank = rank;
    subtree->builder.cull = cull;
    subtree->builder.color = color;
    memcpy(subtree->totals, subtree_header.totals, sizeof subtree->totals);
    memcpy(subtree->peaks, subtree_header.peaks, sizeof subtree->peaks);
    subtree->lost = subtree_header.lost;
    subtree->paths = subtree_header.paths;
    subtree->not_converged = subtree_header.not_converged != 0;
    return from + bytes_of(subtree_header.n_top_nodes, subtree_header.n_branches, color);
}

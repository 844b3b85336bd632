/*
 * Tensor trees while they are measured: cells with values and what is known of their errors, from
 * the finest up. Of rank 4 or 3 (bsdf/tree.h, iso.h): a branch has a child for each part of a cell
 * in (A.x, A.y, B.x, B.y), or (A, B.x, B.y), numbered by these bits.
 *
 * Cells that a branch would hold become one where the data do not tell them apart: where they
 * differ by no more than their standard errors explain, or by less than a share of their mean that
 * is asked for, or by less light than counts. Their mean stays, with what it may be off by from any
 * of them: the standard error of the mean, and how far they lie from it.
 * Colours are asked beside that (hues.h); errors are those of luminance.
 *
 * Ownership: the caller's, orl_gonio_forest_done. One thread writes at a time.
 */
#ifndef ORL_GONIOMETER_FOREST_H
#define ORL_GONIOMETER_FOREST_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <oriel/crew.h>

enum { ORL_GONIO_FAN_MOST = 16 };

/* A leaf, or a branch. */
struct orl_gonio_node {
    float value, variance; /* 1/sr; of a branch: of the mean of all below */
    float path;      /* what one path alone brings of the value, 1/sr: so much is never known */
    float spread;    /* mean square of what finest cells below are off by from the value, as
                        far as their errors do not explain it: by chance it may be negative */
    float doubt;     /* of a branch: by how much, at the most, what is below it differs by
                        more than errors explain, as a ratio of squares; of a leaf 0 */
    uint32_t branch; /* 1 + its place; 0: a leaf */
};

struct orl_gonio_branch {
    struct orl_gonio_node child[ORL_GONIO_FAN_MOST];
};

/* The colour of a node beside its luminance (hues.h): red, green, blue; the variances of what these
 * are off by from the luminance in the node's own chromaticity. */
enum { ORL_GONIO_HUES = 3 };
struct orl_gonio_hue {
    float value[ORL_GONIO_HUES], noise[ORL_GONIO_HUES];
};

struct orl_gonio_branch_hues {
    struct orl_gonio_hue child[ORL_GONIO_FAN_MOST];
};

/* Nodes side by side, with their colours. */
struct orl_gonio_cells {
    struct orl_gonio_node *nodes;
    struct orl_gonio_hue *hues; /* NULL: by luminance alone */
};
/* So many; false: no memory, and none. */
bool orl_gonio_cells_make(struct orl_gonio_cells *cells, size_t count, bool color);
void orl_gonio_cells_done(struct orl_gonio_cells *cells);
static inline struct orl_gonio_cells orl_gonio_cells_at(struct orl_gonio_cells cells, size_t first)
{
    return (struct orl_gonio_cells){cells.nodes + first, cells.hues ? cells.hues + first : NULL};
}
void orl_gonio_cells_copy(struct orl_gonio_cells to, struct orl_gonio_cells from, size_t count);

/* How far cells may be from their mean that become one, unless errors explain it. */
struct orl_gonio_cull {
    double share;  /* of the mean */
    double unseen; /* or of the light that comes: what a cell may send elsewhere */
};

struct orl_gonio_forest {
    unsigned rank;
    struct orl_gonio_cull cull;
    bool color;
    struct orl_gonio_branch *branches;  /* owned */
    struct orl_gonio_branch_hues *hues; /* as many, of colour; owned */
    size_t count, room, hues_room;
};

void orl_gonio_forest_done(struct orl_gonio_forest *forest);

/* What is never known of a cell's mean, as a variance: of a dark one nothing counts as known or
 * not. */
static inline double orl_gonio_noise(const struct orl_gonio_node *node)
{
    const double variance = (double)node->variance, path = (double)node->path;
    return node->value > 0 ? fmax(variance, path * path) : 0;
}
/* What a leaf may be off by from its finest cells: a standard error, 1/sr. */
static inline double orl_gonio_error(const struct orl_gonio_node *node)
{
    const double path = (double)node->path;
    return sqrt((double)node->variance + path * path + fmax(0, (double)node->spread));
}

/* Whether fan nodes, which lie level deep, are as good as their mean, which is filled in; its doubt
 * says how far they are from that. */
bool orl_gonio_are_one(const struct orl_gonio_cull *cull, struct orl_gonio_cells children,
                       unsigned fan, unsigned level, struct orl_gonio_cells ret_mean);

/* One node over 2^rank others, which lie level deep: a branch, or a leaf. False: no memory. */
bool orl_gonio_join(struct orl_gonio_forest *forest, struct orl_gonio_cells children,
                    unsigned level, struct orl_gonio_cells ret_node);

/* Parts of a cell of directions in, a level deeper: 4 of rank 4, 2 of rank 3. */
static inline unsigned orl_gonio_parts_in(unsigned rank)
{
    return rank == 4 ? 4 : 2;
}
/* count nodes of one cell in, which lie at that level, over those of its parts: four times as many
 * of each part, part after part. False: no memory. */
bool orl_gonio_join_level(struct orl_gonio_forest *forest, struct orl_gonio_cells parts,
                          size_t count, unsigned level, struct orl_gonio_cells ret_nodes);

/* Takes over all branches of another one, with children mirrored: the i-th is the (i ^ mirror)-th.
 * *ret_shift: what is to be added to places. False: no memory. */
bool orl_gonio_forest_take(struct orl_gonio_forest *forest, const struct orl_gonio_forest *other,
                           unsigned mirror, uint32_t *ret_shift);
struct orl_gonio_node orl_gonio_shifted(struct orl_gonio_node node, uint32_t shift);

/* As the braces of a file: luminances, or their errors. Incomplete when cancelled. */
void orl_gonio_forest_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                            bool errors, const atomic_bool *cancel, FILE *out);

/* The largest leaf. */
double orl_gonio_forest_peak(const struct orl_gonio_forest *forest, struct orl_gonio_node root);
/* Of leaves from a value on the largest shares of it: of the error of a mean, and of what cells
 * that it stands for are off by. Raises what is there. */
struct orl_gonio_worst {
    double noise, joined;
};
void orl_gonio_forest_worst(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                            double from, struct orl_gonio_worst *worst);

#endif

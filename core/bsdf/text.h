/*
 * Readers of a ScatteringData block, fed in pieces as the XML parser hands them out: a tensor tree
 * in braces, or the numbers of a matrix. Both keep bounded state beside what they build.
 */
#ifndef ORL_BSDF_TEXT_H
#define ORL_BSDF_TEXT_H

#include <oriel/limits.h>

#include "bsdf/iso.h"
#include "bsdf/matrix.h"
#include "bsdf/scan.h"
#include "bsdf/tree.h"

/* A brace that has been opened: either children so far, or the values of a grid so far. */
struct orl_brace {
    struct orl_tree_ref child[ORL_TREE_FANOUT];
    unsigned n_children;
};

struct orl_tree_text {
    struct orl_scan scan;
    unsigned rank; /* 4: builds the tree, 3: the iso; borrowed */
    struct orl_tree *tree;
    struct orl_iso *iso;
    size_t *values, *clamped; /* counts of whichever is built */
    struct orl_brace open[ORL_LIMIT_TREE_DEPTH + 1];
    unsigned n_open;
    float *grid; /* values of the innermost brace; owned */
    size_t n_grid, grid_capacity;
    bool complete; /* the outermost brace has closed */
};

void orl_tree_text_init(struct orl_tree_text *text, struct orl_tree *tree);
void orl_tree_text_init_iso(struct orl_tree_text *text, struct orl_iso *iso);
int orl_tree_text_feed(struct orl_tree_text *text, const char *piece, size_t size,
                       struct orl_error *err);
/* The block has ended: the tree must be whole. */
int orl_tree_text_finish(struct orl_tree_text *text, struct orl_error *err);
void orl_tree_text_done(struct orl_tree_text *text); /* frees the scratch, not the tree */

struct orl_matrix_text {
    struct orl_scan scan;
    struct orl_matrix *matrix; /* borrowed, filled here */
    bool by_rows;              /* Rows: an incident direction's values stand together */
    size_t count;              /* values so far */
};

void orl_matrix_text_init(struct orl_matrix_text *text, struct orl_matrix *matrix, bool by_rows);
int orl_matrix_text_feed(struct orl_matrix_text *text, const char *piece, size_t size,
                         struct orl_error *err);
int orl_matrix_text_finish(struct orl_matrix_text *text, struct orl_error *err);

#endif

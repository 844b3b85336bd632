/*
 * Parsers of a ScatteringData block, fed in pieces as the XML parser delivers them: a tensor tree
 * in braces, or the numbers of a matrix. Their state is bounded, apart from the result.
 */
#ifndef ORL_BSDF_XML_DATA_TEXT_H
#define ORL_BSDF_XML_DATA_TEXT_H

#include <oriel/base/limits.h>

#include "bsdf/matrix/matrix.h"
#include "bsdf/tree/iso.h"
#include "bsdf/tree/tree.h"
#include "bsdf/xml/scan.h"

/* An open brace with its children so far. The values of a grid are in orl_tree_text.grid. */
struct orl_brace {
    struct orl_tree_ref child[ORL_TREE_FANOUT];
    unsigned n_children;
};

struct orl_tree_text {
    struct orl_scan scan;
    unsigned rank; /* 4: fills tree, 3: fills iso; both borrowed */
    struct orl_tree *tree;
    struct orl_iso *iso;
    size_t *values, *clamped; /* counters of the tree or iso that is filled */
    struct orl_brace open[ORL_LIMIT_TREE_DEPTH + 1];
    unsigned n_open;
    float *grid; /* values of the innermost brace so far; owned */
    size_t n_grid, grid_capacity;
    bool complete; /* true once the outermost brace has closed */
};

void orl_tree_text_init(struct orl_tree_text *text, struct orl_tree *tree);
void orl_tree_text_init_iso(struct orl_tree_text *text, struct orl_iso *iso);
int orl_tree_text_feed(struct orl_tree_text *text, const char *piece, size_t size,
                       struct orl_error *err);
/* Ends the block. Returns ORL_ERR_SYNTAX if the tree is incomplete. */
int orl_tree_text_finish(struct orl_tree_text *text, struct orl_error *err);
void orl_tree_text_done(struct orl_tree_text *text); /* frees the scratch memory, not the tree */

struct orl_matrix_text {
    struct orl_scan scan;
    struct orl_matrix *matrix; /* borrowed; filled by the parser */
    bool by_rows;              /* Rows: the values of one incident direction are contiguous */
    size_t count;              /* values read so far */
};

void orl_matrix_text_init(struct orl_matrix_text *text, struct orl_matrix *matrix, bool by_rows);
int orl_matrix_text_feed(struct orl_matrix_text *text, const char *piece, size_t size,
                         struct orl_error *err);
int orl_matrix_text_finish(struct orl_matrix_text *text, struct orl_error *err);

#endif

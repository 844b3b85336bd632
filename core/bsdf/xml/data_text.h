/*
 * Text of the number blocks of a BSDF file, fed in pieces: the tokenizer (scan.c) and the parsers
 * of trees and matrices (data_text.c).
 */
#ifndef ORL_BSDF_XML_DATA_TEXT_H
#define ORL_BSDF_XML_DATA_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/limits.h>

#include "bsdf/matrix/matrix.h"
#include "bsdf/tree/iso.h"
#include "bsdf/tree/tree.h"

/*
 * Tokenizer for the number blocks of a BSDF file: braces and numbers, separated by white space or
 * commas, in pieces of any size. Independent of the locale.
 *
 * Use: feed a piece with orl_scan_feed, then call orl_scan_next until it returns ORL_TOKEN_NONE;
 * repeat. At the end call orl_scan_finish, then orl_scan_next until ORL_TOKEN_NONE again: a number
 * may end with the block. The scanner borrows each piece until it is used up and owns nothing.
 */

enum { ORL_SCAN_TOKEN_MAX = 96 };

enum orl_token { ORL_TOKEN_NONE, ORL_TOKEN_OPEN, ORL_TOKEN_CLOSE, ORL_TOKEN_NUMBER };

struct orl_scan {
    const char *next, *end;
    char partial[ORL_SCAN_TOKEN_MAX]; /* start of a number that is cut by the end of a piece */
    size_t partial_length;
    bool finished;
};

void orl_scan_init(struct orl_scan *scan);
void orl_scan_feed(struct orl_scan *scan, const char *piece, size_t size);
void orl_scan_finish(struct orl_scan *scan);

/*
 * Returns an enum orl_token, with ret_value set for a number, or a negative enum orl_err:
 * ORL_ERR_SYNTAX for text that is not a number, ORL_ERR_RANGE for a number that is not finite or
 * exceeds ORL_BSDF_VALUE_MAX in magnitude.
 */
int orl_scan_next(struct orl_scan *scan, double *ret_value, struct orl_error *err);

/* Parses one number that fills text exactly. Returns 0 or a negative enum orl_err as above. */
int orl_number_parse(const char *text, size_t length, double *ret_value, struct orl_error *err);

/*
 * Bounds of values, 1/sr. A leaf of a 2^8 tree cannot physically exceed 2.1e4. Above the maximum,
 * sums over a tree could overflow; below the minimum they could vanish.
 */
#define ORL_BSDF_VALUE_MAX 1e30
#define ORL_BSDF_VALUE_MIN 1e-30

/* Returns a value as it is stored. Negative values become 0 and are counted; tiny ones become 0. */
static inline float orl_bsdf_value(double value, size_t *clamped)
{
    if (value < 0) {
        ++*clamped;
        return 0;
    }
    return value < ORL_BSDF_VALUE_MIN ? 0 : (float)value;
}

/*
 * Parsers of a ScatteringData block, fed in pieces from the XML parser: a tensor tree in braces, or
 * the numbers of a matrix. Their state has a bounded size, apart from the result.
 */

/* An open brace with its children so far. The values of a grid are in orl_tree_text.grid. */
struct orl_brace {
    struct orl_tree_ref child[ORL_TREE_FANOUT];
    unsigned n_children;
};

struct orl_tree_text {
    struct orl_scan scan;
    unsigned rank; /* 4: fills tree, 3: fills iso; borrowed */
    struct orl_tree *tree;
    struct orl_iso *iso;
    size_t *values, *clamped; /* counters of the tree or iso that is filled */
    struct orl_brace open[ORL_LIMIT_TREE_DEPTH + 1];
    unsigned n_open;
    float *grid; /* values of the innermost brace so far; owned */
    size_t n_grid, grid_capacity;
    bool complete; /* true once the outermost brace has closed */
};

/* Prepares to fill a tree of rank 4 or of rank 3; the other is NULL. */
void orl_tree_text_init(struct orl_tree_text *text, struct orl_tree *tree, struct orl_iso *iso);
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

/* Parsers of a ScatteringData block: trees of rank 4 and 3, then matrices. */
#include "bsdf/xml/data_text.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/* ---- Trees ----------------------------------------------------------------------------------- */

/*
 * Syntax of trees of rank 4: "{ v }" is a leaf, "{ v v ... }" a grid of 16^n values. "{ {..} {..}
 * ... }" is a branch of 16 children. In rank 3 a grid has 8^n values and a branch 8 children.
 * ORL_LIMIT_TREE_DEPTH limits the depth, ORL_LIMIT_BSDF_VALUES the values.
 */

void orl_tree_text_init(struct orl_tree_text *text, struct orl_tree *tree, struct orl_iso *iso)
{
    *text = (struct orl_tree_text){.rank = tree ? 4 : 3,
                                   .tree = tree,
                                   .iso = iso,
                                   .values = tree ? &tree->values : &iso->leaves,
                                   .clamped = tree ? &tree->clamped : &iso->clamped};
}

static unsigned fanout(const struct orl_tree_text *text)
{
    return 1U << text->rank;
}

void orl_tree_text_done(struct orl_tree_text *text)
{
    free(text->grid);
    text->grid = NULL;
}

static int on_open(struct orl_tree_text *text, struct orl_error *err)
{
    if (text->complete)
        return orl_error_set(err, ORL_ERR_SYNTAX, "more data after the end of the tensor tree");
    if (text->n_grid > 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "'{' among the values of a grid");
    if (text->n_open > 0 && text->open[text->n_open - 1].n_children == fanout(text))
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "a branch of the tensor tree has more than %u children", fanout(text));
    if (text->n_open > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    text->open[text->n_open++].n_children = 0;
    return 0;
}

static int on_number(struct orl_tree_text *text, double number, struct orl_error *err)
{
    struct orl_tree *tree = text->tree;
    const float value = orl_bsdf_value(number, text->clamped);
    if (text->n_open == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a number outside the braces of the tensor tree");
    if (text->open[text->n_open - 1].n_children > 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a number among the children of a branch");
    if (*text->values == ORL_LIMIT_BSDF_VALUES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree has more than %lu values",
                             ORL_LIMIT_BSDF_VALUES);
    if (!orl_array_reserve(&text->grid, &text->grid_capacity, text->n_grid, sizeof *text->grid))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
    if (tree && (*text->values == 0 || value < tree->minimum))
        tree->minimum = value;
    ++*text->values;
    text->grid[text->n_grid++] = value;
    return 0;
}

/* Computes the place of the innermost brace in cells of its own size, from its number among its
 * siblings and those of the enclosing braces. */
static void find_place(const struct orl_tree_text *text, unsigned ret_place[3])
{
    ret_place[0] = ret_place[1] = ret_place[2] = 0;
    for (unsigned level = 0; level + 1 < text->n_open; level++)
        for (unsigned axis = 0; axis < 3; axis++)
            ret_place[axis] = ret_place[axis] << 1 | (text->open[level].n_children >> axis & 1);
}

/* Turns the values of the innermost brace into a leaf or a branch. */
static int close_grid(struct orl_tree_text *text, struct orl_tree_ref *ret_ref,
                      struct orl_error *err)
{
    const unsigned level = text->n_open - 1;
    unsigned log2_side = 0, place[3];
    while ((size_t)1 << text->rank * log2_side < text->n_grid)
        log2_side++;
    if ((size_t)1 << text->rank * log2_side != text->n_grid)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "a grid of %zu values; a tensor tree of rank %u has 1, %u, %u, ...",
                             text->n_grid, text->rank, fanout(text), fanout(text) * fanout(text));
    if (level + log2_side > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    text->n_grid = 0;
    if (text->rank == 4)
        return orl_tree_grid(text->tree, text->grid, log2_side, ret_ref, err);
    find_place(text, place);
    orl_iso_fill(text->iso, place, level, text->grid, log2_side);
    return 0;
}

/* Turns the children of the innermost brace into a branch. */
static int close_branch(struct orl_tree_text *text, struct orl_tree_ref *ret_ref,
                        struct orl_error *err)
{
    const struct orl_brace *brace = &text->open[text->n_open - 1];
    if (brace->n_children != fanout(text))
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "a branch of the tensor tree has %u children instead of %u",
                             brace->n_children, fanout(text));
    return text->rank == 4 ? orl_tree_branch(text->tree, brace->child, ret_ref, err) : 0;
}

static int on_close(struct orl_tree_text *text, struct orl_error *err)
{
    struct orl_brace *brace;
    struct orl_tree_ref ref = orl_tree_leaf(0);
    int code;
    if (text->n_open == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "'}' without a matching '{'");
    code = text->n_grid > 0 ? close_grid(text, &ref, err) : close_branch(text, &ref, err);
    if (code < 0)
        return code;
    if (--text->n_open == 0) {
        if (text->rank == 4)
            orl_tree_finish(text->tree, ref);
        else
            code = orl_iso_finish(text->iso, err);
        text->complete = true;
    } else {
        brace = &text->open[text->n_open - 1];
        brace->child[brace->n_children++] = ref;
    }
    return code;
}

/* Processes all tokens that are available. */
static int parse_tokens(struct orl_tree_text *text, struct orl_error *err)
{
    for (;;) {
        double number = 0;
        int code = orl_scan_next(&text->scan, &number, err);
        switch (code) {
        case ORL_TOKEN_NONE:
            return 0;
        case ORL_TOKEN_OPEN:
            code = on_open(text, err);
            break;
        case ORL_TOKEN_CLOSE:
            code = on_close(text, err);
            break;
        case ORL_TOKEN_NUMBER:
            code = on_number(text, number, err);
            break;
        default:
            break;
        }
        if (code < 0)
            return code;
    }
}

int orl_tree_text_feed(struct orl_tree_text *text, const char *piece, size_t size,
                       struct orl_error *err)
{
    orl_scan_feed(&text->scan, piece, size);
    return parse_tokens(text, err);
}

int orl_tree_text_finish(struct orl_tree_text *text, struct orl_error *err)
{
    int code;
    orl_scan_finish(&text->scan);
    code = parse_tokens(text, err);
    if (code < 0)
        return code;
    if (text->n_open == 0 && !text->complete)
        return orl_error_set(err, ORL_ERR_SYNTAX, "the tensor tree is empty");
    if (!text->complete)
        return orl_error_set(err, ORL_ERR_SYNTAX, "the tensor tree ends with %u braces open",
                             text->n_open);
    return 0;
}

/* ---- Matrices -------------------------------------------------------------------------------- */

void orl_matrix_text_init(struct orl_matrix_text *text, struct orl_matrix *matrix, bool by_rows)
{
    *text = (struct orl_matrix_text){.matrix = matrix, .by_rows = by_rows};
}

static size_t count_values(const struct orl_matrix *m)
{
    return (size_t)m->basis[ORL_AXIS_A].n_cells * (size_t)m->basis[ORL_AXIS_B].n_cells;
}

/* Returns the index of the next value. Columns: the incident direction varies fastest. Rows: the
 * exitant one. */
static size_t place_of(const struct orl_matrix_text *text)
{
    const size_t n_a = (size_t)text->matrix->basis[ORL_AXIS_A].n_cells;
    const size_t n_b = (size_t)text->matrix->basis[ORL_AXIS_B].n_cells;
    if (text->by_rows)
        return text->count;
    return text->count % n_a * n_b + text->count / n_a;
}

static int parse_values(struct orl_matrix_text *text, struct orl_error *err)
{
    for (;;) {
        double number = 0;
        const int code = orl_scan_next(&text->scan, &number, err);
        if (code <= ORL_TOKEN_NONE)
            return code;
        if (code != ORL_TOKEN_NUMBER)
            return orl_error_set(err, ORL_ERR_SYNTAX, "a brace in the data of a matrix");
        if (text->count == count_values(text->matrix)) {
            orl_error_set(err, ORL_ERR_SYNTAX, "more than the %zu values of the matrix",
                          text->count);
            orl_error_hint(err, "decimal commas may be the cause: write 0.5, not 0,5");
            return ORL_ERR_SYNTAX;
        }
        text->matrix->values[place_of(text)] = orl_bsdf_value(number, &text->matrix->clamped);
        text->count++;
    }
}

int orl_matrix_text_feed(struct orl_matrix_text *text, const char *piece, size_t size,
                         struct orl_error *err)
{
    orl_scan_feed(&text->scan, piece, size);
    return parse_values(text, err);
}

int orl_matrix_text_finish(struct orl_matrix_text *text, struct orl_error *err)
{
    int code;
    orl_scan_finish(&text->scan);
    code = parse_values(text, err);
    if (code < 0)
        return code;
    if (text->count != count_values(text->matrix))
        return orl_error_set(err, ORL_ERR_SYNTAX, "%zu values instead of the matrix's %zu",
                             text->count, count_values(text->matrix));
    return orl_matrix_finish(text->matrix, err);
}

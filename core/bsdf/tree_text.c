/*
 * "{ v }" is a leaf, "{ v v ... }" a grid of 16^n values, "{ {..} {..} ... }" a branch of 16
 * children. Depth is bounded by ORL_LIMIT_TREE_DEPTH, values by ORL_LIMIT_BSDF_VALUES.
 */
#include "bsdf/text.h"

#include <stdlib.h>
#include <string.h>

void orl_tree_text_init(struct orl_tree_text *text, struct orl_tree *tree)
{
    memset(text, 0, sizeof *text);
    orl_scan_init(&text->scan);
    text->tree = tree;
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
    if (text->n_open > 0 && text->open[text->n_open - 1].n_children == ORL_TREE_FANOUT)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "a branch of the tensor tree has more than %d "
                             "children",
                             ORL_TREE_FANOUT);
    if (text->n_open > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    text->open[text->n_open++].n_children = 0;
    return 0;
}

static int grow_grid(struct orl_tree_text *text, struct orl_error *err)
{
    const size_t capacity = text->grid_capacity ? 2 * text->grid_capacity : 256;
    float *grid = realloc(text->grid, capacity * sizeof *grid);
    if (!grid)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
    text->grid = grid;
    text->grid_capacity = capacity;
    return 0;
}

static int on_number(struct orl_tree_text *text, double number, struct orl_error *err)
{
    struct orl_tree *tree = text->tree;
    const float value = orl_bsdf_value(number, &tree->clamped);
    if (text->n_open == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a number outside the braces of the tensor tree");
    if (text->open[text->n_open - 1].n_children > 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a number among the children of a branch");
    if (tree->values == ORL_LIMIT_BSDF_VALUES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree has more than %lu values",
                             ORL_LIMIT_BSDF_VALUES);
    if (text->n_grid == text->grid_capacity && grow_grid(text, err) < 0)
        return ORL_ERR_NOMEM;
    if (tree->values++ == 0 || value < tree->minimum)
        tree->minimum = value;
    text->grid[text->n_grid++] = value;
    return 0;
}

/* Turns the values of the innermost brace into a leaf or a branch. */
static int close_grid(struct orl_tree_text *text, struct orl_tree_ref *ret_ref,
                      struct orl_error *err)
{
    unsigned log2_side = 0;
    while ((size_t)1 << 4 * log2_side < text->n_grid)
        log2_side++;
    if ((size_t)1 << 4 * log2_side != text->n_grid)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "a grid of %zu values; a tensor tree of rank 4 has 1, 16, 256, ...",
                             text->n_grid);
    if (text->n_open - 1 + log2_side > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    text->n_grid = 0;
    return orl_tree_grid(text->tree, text->grid, log2_side, ret_ref, err);
}

static int on_close(struct orl_tree_text *text, struct orl_error *err)
{
    struct orl_brace *brace;
    struct orl_tree_ref ref = orl_tree_leaf(0);
    int code;
    if (text->n_open == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "'}' without its '{'");
    brace = &text->open[text->n_open - 1];
    if (text->n_grid > 0)
        code = close_grid(text, &ref, err);
    else if (brace->n_children == ORL_TREE_FANOUT)
        code = orl_tree_branch(text->tree, brace->child, &ref, err);
    else
        code = orl_error_set(err, ORL_ERR_SYNTAX,
                             "a branch of the tensor tree has %u children where %d belong",
                             brace->n_children, ORL_TREE_FANOUT);
    if (code < 0)
        return code;
    if (--text->n_open == 0) {
        orl_tree_finish(text->tree, ref);
        text->complete = true;
    } else {
        brace = &text->open[text->n_open - 1];
        brace->child[brace->n_children++] = ref;
    }
    return 0;
}

/* Works off the tokens at hand. */
static int drain(struct orl_tree_text *text, struct orl_error *err)
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
    return drain(text, err);
}

int orl_tree_text_finish(struct orl_tree_text *text, struct orl_error *err)
{
    int code;
    orl_scan_finish(&text->scan);
    code = drain(text, err);
    if (code < 0)
        return code;
    if (text->n_open == 0 && !text->complete)
        return orl_error_set(err, ORL_ERR_SYNTAX, "the tensor tree is empty");
    if (!text->complete)
        return orl_error_set(err, ORL_ERR_SYNTAX, "the tensor tree ends with %u braces open",
                             text->n_open);
    return 0;
}

/* Complete trees of a panel: measurement, mirrors, file. */
#include "bsdf/make/make_bsdf.h"

#include <stdlib.h>
#include <string.h>

#include "bsdf/make/trees/measure_subtrees.h"
#include "bsdf/make/trees/tree_builder.h"

enum { SPLIT_LEVEL = 4 };

/* Share of the peak above which errors count. */
static const double counted_from = 0.01;

/* ---- The whole ------------------------------------------------------------------------------- */

/* Returns the mirror image of a cell of B at a level, by the bits of a child's mirror. */
static size_t mirrored_cell(size_t cell, unsigned level, unsigned mirror)
{
    for (unsigned l = 0; l < level; l++)
        cell ^= (size_t)(mirror & 3) << 2 * l;
    return cell;
}

/* Adds the nodes of a subtree, original or mirrored, to the side's builder. */
static bool add_subtree_nodes(const struct orl_gonio_trees *t, struct orl_gonio_builder *builder,
                              size_t side, size_t a, struct orl_gonio_cells ret_cells)
{
    unsigned mirror;
    const struct orl_gonio_subtree *subtree =
        &t->subtrees[side * t->n_subtrees + orl_gonio_original_of(t, a, &mirror)];
    const size_t cells = orl_gonio_nodes_at(t->split) / 2;
    uint32_t shift;
    if (!orl_gonio_builder_append(builder, &subtree->builder, mirror, &shift))
        return false;
    for (size_t i = 0; i < 2 * cells; i++) {
        const size_t from = i / cells * cells + mirrored_cell(i % cells, t->split, mirror);
        orl_gonio_cells_copy(orl_gonio_cells_at(ret_cells, i),
                             orl_gonio_cells_at(subtree->top_nodes, from), 1);
        ret_cells.nodes[i] = orl_gonio_node_shifted(ret_cells.nodes[i], shift);
    }
    return true;
}

/* Computes the nodes of incident cell a at a level above the subtrees. In rank 3 the upper half of
 * A has no directions; it is a copy of the lower one. */
static bool merge_nodes(const struct orl_gonio_trees *t, struct orl_gonio_builder *builder,
                        size_t side, unsigned level, size_t a, struct orl_gonio_cells ret_cells)
{
    const unsigned in = orl_gonio_children_in(t->rank);
    if (level == t->split)
        return add_subtree_nodes(t, builder, side, a, ret_cells);
    const size_t count = orl_gonio_nodes_at(level + 1);
    struct orl_gonio_cells parts;
    bool fine = orl_gonio_cells_make(&parts, in * count, builder->color);
    for (unsigned k = 0; k < in && fine; k++) {
        if (t->rank == 3 && level == 0 && k == 1)
            orl_gonio_cells_copy(orl_gonio_cells_at(parts, count), parts, count);
        else
            fine = merge_nodes(t, builder, side, level + 1, in * a + k,
                               orl_gonio_cells_at(parts, k * count));
    }
    fine = fine && orl_gonio_builder_merge_level(builder, parts, orl_gonio_nodes_at(level), level,
                                                 ret_cells);
    orl_gonio_cells_done(&parts);
    return fine;
}

static int merge_all(struct orl_gonio_trees *t)
{
    for (size_t side = 0; side < 2; side++) {
        const struct orl_gonio_cells roots = {t->roots[side],
                                              t->request->color ? t->root_hues[side] : NULL};
        t->builders[side] = orl_gonio_empty_builder(t);
        if (!merge_nodes(t, &t->builders[side], side, 0, 0, roots))
            return ORL_ERR_NOMEM;
    }
    return 0;
}

/* ---- Results -------------------------------------------------------------------------------- */

/* Returns the share of diffuse light from a side. Cells of A have equal weights in rank 4; rings
 * have weights by their size in rank 3. */
static struct orl_bsdf_share diffuse_of(const struct orl_gonio_trees *t, size_t side,
                                        bool transmitted)
{
    double values[ORL_GONIO_BATCHES] = {0};
    unsigned mirror;
    for (size_t a = 0; a < t->n_subtrees; a++) {
        const struct orl_gonio_subtree *b =
            &t->subtrees[side * t->n_subtrees + orl_gonio_original_of(t, a, &mirror)];
        const double n = (double)t->n_subtrees;
        const double weight =
            t->rank == 4 ? ldexp(1, -2 * (int)t->levels) : (2 * (n - (double)a) - 1) / (n * n);
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            values[k] += weight * b->totals[k][transmitted];
    }
    return orl_gonio_batch_mean(values);
}

static void set_results(const struct orl_gonio_trees *t, struct orl_bsdf_make_result *result)
{
    double lost = 0;
    struct orl_gonio_max_error worst = {0, 0};
    result->reached = true;
    for (size_t side = 0; side < 2; side++)
        for (size_t k = 0; k < 2; k++) {
            const struct orl_gonio_builder *builder = &t->builders[side];
            const struct orl_gonio_node root = t->roots[side][k];
            const double from = counted_from * orl_gonio_builder_peak(builder, root);
            result->diffuse[side][k] = diffuse_of(t, side, k);
            orl_gonio_builder_max_errors(builder, root, from, &worst);
        }
    for (size_t i = 0; i < t->n_todo; i++) {
        result->paths += t->subtrees[t->todo[i]].paths;
        lost += t->subtrees[t->todo[i]].lost;
        result->reached = result->reached && !t->subtrees[t->todo[i]].not_converged;
    }
    result->worst = worst.noise;
    result->merge_error = worst.merge_error;
    result->lost = result->paths > 0 ? lost / (double)result->paths : 0;
}

/* Finds the side of a part, and if it is transmitted. */
static void find_part(enum orl_component_kind part, size_t *ret_side, size_t *ret_transmitted)
{
    for (size_t i = 0; i < 4; i++)
        if (orl_gonio_component_of[i / 2][i % 2] == part) {
            *ret_side = i / 2;
            *ret_transmitted = i % 2;
        }
}

static void write_part(void *ctx, enum orl_component_kind part, enum orl_bsdf_channel channel,
                       FILE *out)
{
    const struct orl_gonio_trees *t = ctx;
    size_t side = 0, k = 0;
    find_part(part, &side, &k);
    if (channel == ORL_CHANNEL_VISIBLE)
        orl_gonio_builder_write(&t->builders[side], t->roots[side][k], false, t->cancel, out);
    else
        orl_gonio_write_chromaticity(&t->builders[side], t->roots[side][k], t->root_hues[side][k],
                                     channel, t->cancel, out);
}

/* Writes errors, which are those of luminance only. */
static void write_errors(void *ctx, enum orl_component_kind part, enum orl_bsdf_channel channel,
                         FILE *out)
{
    const struct orl_gonio_trees *t = ctx;
    size_t side = 0, k = 0;
    (void)channel;
    find_part(part, &side, &k);
    orl_gonio_builder_write(&t->builders[side], t->roots[side][k], true, t->cancel, out);
}

/* Writes the BSDF, or its errors. */
static int write_out(struct orl_gonio_trees *t, bool errors, struct orl_bsdf_make_result *result)
{
    struct orl_document document = {.structure =
                                        t->rank == 4 ? ORL_STRUCTURE_TREE4 : ORL_STRUCTURE_TREE3};
    for (int part = 0; part < ORL_COMPONENT_COUNT; part++) {
        bool *given = document.parts[part].chroma.given;
        document.parts[part].present = true;
        given[0] = given[1] = t->request->color && !errors;
    }
    const int code =
        errors ? orl_gonio_write_errors(&document, write_errors, t, t->sample, t->request, result)
               : orl_gonio_write(&document, write_part, t, t->sample, t->request, result);
    return code == 0 && orl_is_cancelled(t->cancel) ? ORL_ERR_CANCELLED : code;
}

static void trees_done(struct orl_gonio_trees *t)
{
    for (size_t i = 0; t->subtrees && i < 2 * t->n_subtrees; i++)
        orl_gonio_subtree_done(&t->subtrees[i]);
    free(t->subtrees);
    free(t->todo);
    orl_gonio_builder_done(&t->builders[0]);
    orl_gonio_builder_done(&t->builders[1]);
}

static struct orl_gonio_trees trees_of(const struct orl_bsdf_make_request *request,
                                       const struct orl_bsdf_make_env *env,
                                       const struct orl_gonio_sample *sample,
                                       const struct orl_sobol *sobol)
{
    struct orl_gonio_trees t = {.request = request,
                                .cull = {request->cull, request->cull_fraction},
                                .sample = sample,
                                .sobol = sobol,
                                .levels = 1,
                                .paths_most = request->paths_most / ORL_GONIO_BATCHES,
                                .cancel = env->cancel};
    t.rank = request->basis == ORL_BSDF_TENSOR_TREE_4 ? 4 : 3;
    while (1U << t.levels < request->resolution)
        t.levels++;
    /* Rank 3: every ring is a subtree, and half of A has none. */
    t.split = t.rank == 3 ? t.levels : t.levels < SPLIT_LEVEL ? t.levels : SPLIT_LEVEL;
    t.n_subtrees = t.rank == 3 ? (size_t)1 << (t.levels - 1) : (size_t)1 << 2 * t.split;
    const uint32_t sets = request->accuracy > 0 ? 2 * ORL_GONIO_BATCHES : ORL_GONIO_BATCHES;
    t.paths = (orl_bsdf_make_paths(request) + sets - 1) / sets;
    t.subtrees = calloc(2 * t.n_subtrees, sizeof *t.subtrees);
    t.todo = calloc(2 * t.n_subtrees, sizeof *t.todo);
    for (size_t i = 0; t.todo && i < 2 * t.n_subtrees; i++) {
        unsigned mirror;
        if (orl_gonio_original_of(&t, i % t.n_subtrees, &mirror) == i % t.n_subtrees)
            t.todo[t.n_todo++] = i;
    }
    return t;
}

int orl_gonio_make_trees(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_make_result *result,
                         struct orl_error *err)
{
    struct orl_gonio_trees t = trees_of(request, env, sample, sobol);
    if (!t.subtrees || !t.todo) {
        trees_done(&t);
        return orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    }
    int code = orl_gonio_measure_subtrees(&t, env, err);
    if (code == 0 && merge_all(&t) < 0)
        code = orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    if (code == 0) {
        set_results(&t, result);
        code = write_out(&t, false, result);
        if (code == 0 && request->want_errors)
            code = write_out(&t, true, result);
        code = code < 0 ? orl_gonio_trees_fail(&t, code, err) : 0;
    }
    trees_done(&t);
    return code;
}

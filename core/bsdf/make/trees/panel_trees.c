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

/* One side of the trees. */
struct side {
    struct orl_gonio_trees *t;
    size_t number;
};

/* Adds the nodes of a subtree, original or mirrored, to the side's builder. */
static bool add_subtree_nodes(void *ctx, uint32_t a, struct orl_gonio_cells ret_cells)
{
    const struct side *side = ctx;
    const struct orl_gonio_trees *t = side->t;
    unsigned mirror;
    const struct orl_gonio_subtree *subtree =
        &t->subtrees[side->number * t->of.n_subtrees + orl_gonio_original_of(t, a, &mirror)];
    const size_t cells = orl_gonio_nodes_at(t->of.split) / 2;
    uint32_t shift;
    if (!orl_gonio_builder_append(&side->t->builders[side->number], &subtree->builder, mirror,
                                  &shift))
        return false;
    for (size_t i = 0; i < 2 * cells; i++) {
        const size_t from = i / cells * cells +
                            orl_gonio_mirrored_cell((uint32_t)(i % cells), t->of.split, mirror & 3);
        orl_gonio_cells_copy(orl_gonio_cells_at(ret_cells, i),
                             orl_gonio_cells_at(subtree->top_nodes, from), 1);
        ret_cells.nodes[i] = orl_gonio_node_shifted(ret_cells.nodes[i], shift);
    }
    return true;
}

static int merge_all(struct orl_gonio_trees *t)
{
    for (size_t k = 0; k < 2; k++) {
        const struct orl_gonio_cells roots = {t->roots[k],
                                              t->request->color ? t->root_hues[k] : NULL};
        struct side side = {t, k};
        const struct orl_gonio_merger merger = {&t->builders[k], t->of.split, 2, add_subtree_nodes,
                                                &side};
        t->builders[k] = orl_gonio_empty_builder(t);
        if (!orl_gonio_merge_nodes(&merger, 0, 0, roots))
            return ORL_ERR_NOMEM;
    }
    return 0;
}

/* ---- Results -------------------------------------------------------------------------------- */

/* Returns the share of diffuse light from a side. */
static struct orl_bsdf_share diffuse_of(const struct orl_gonio_trees *t, size_t side,
                                        bool transmitted)
{
    double values[ORL_GONIO_BATCHES] = {0};
    unsigned mirror;
    for (size_t a = 0; a < t->of.n_subtrees; a++) {
        const struct orl_gonio_subtree *b =
            &t->subtrees[side * t->of.n_subtrees + orl_gonio_original_of(t, a, &mirror)];
        const double weight = orl_gonio_diffuse_weight(&t->of, a);
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

/* Writes a part of the BSDF, or of its errors, which are those of luminance only. */
static void write_part(void *ctx, enum orl_component_kind part, enum orl_bsdf_channel channel,
                       FILE *out)
{
    const struct orl_gonio_trees *t = ctx;
    const atomic_bool *cancel = t->measurement->env->cancel;
    size_t i = 0;
    while (orl_gonio_component_of[i / 2][i % 2] != part)
        i++;
    const struct orl_gonio_builder *builder = &t->builders[i / 2];
    const struct orl_gonio_node root = t->roots[i / 2][i % 2];
    if (channel == ORL_CHANNEL_VISIBLE)
        orl_gonio_builder_write(builder, root, t->writes_errors, cancel, out);
    else
        orl_gonio_write_chromaticity(builder, root, t->root_hues[i / 2][i % 2], channel, cancel,
                                     out);
}

/* Writes the BSDF, or its errors. */
static int write_out(struct orl_gonio_trees *t, bool errors, struct orl_bsdf_make_result *result)
{
    struct orl_document document = {.structure = t->of.rank == 4 ? ORL_STRUCTURE_TREE4
                                                                 : ORL_STRUCTURE_TREE3};
    for (int part = 0; part < ORL_COMPONENT_COUNT; part++) {
        bool *given = document.parts[part].chroma.given;
        document.parts[part].present = true;
        given[0] = given[1] = t->request->color && !errors;
    }
    t->writes_errors = errors;
    const int code = orl_gonio_write(&document, write_part, t, t->measurement, errors, result);
    return code == 0 && orl_is_cancelled(t->measurement->env->cancel) ? ORL_ERR_CANCELLED : code;
}

static void trees_done(struct orl_gonio_trees *t)
{
    for (size_t i = 0; t->subtrees && i < 2 * t->of.n_subtrees; i++)
        orl_gonio_subtree_done(&t->subtrees[i]);
    free(t->subtrees);
    free(t->todo);
    orl_gonio_builder_done(&t->builders[0]);
    orl_gonio_builder_done(&t->builders[1]);
}

static struct orl_gonio_trees trees_of(const struct orl_gonio_measurement *measurement)
{
    const struct orl_bsdf_make_request *request = measurement->request;
    struct orl_gonio_trees t = {
        .measurement = measurement,
        .request = request,
        .sample = measurement->sample,
        .cull = {request->cull, request->cull_fraction},
        .of = orl_gonio_split_of(request->basis, request->resolution, SPLIT_LEVEL),
        .paths_most = request->paths_most / ORL_GONIO_BATCHES};
    const uint32_t sets = request->accuracy > 0 ? 2 * ORL_GONIO_BATCHES : ORL_GONIO_BATCHES;
    t.paths = (orl_bsdf_make_paths(request) + sets - 1) / sets;
    t.subtrees = calloc(2 * t.of.n_subtrees, sizeof *t.subtrees);
    t.todo = calloc(2 * t.of.n_subtrees, sizeof *t.todo);
    for (size_t i = 0; t.todo && i < 2 * t.of.n_subtrees; i++) {
        unsigned mirror;
        if (orl_gonio_original_of(&t, i % t.of.n_subtrees, &mirror) == i % t.of.n_subtrees)
            t.todo[t.n_todo++] = i;
    }
    return t;
}

int orl_gonio_make_trees(const struct orl_gonio_measurement *measurement,
                         struct orl_bsdf_make_result *result, struct orl_error *err)
{
    struct orl_gonio_trees t = trees_of(measurement);
    if (!t.subtrees || !t.todo) {
        trees_done(&t);
        return orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    }
    int code = orl_gonio_measure_subtrees(&t, err);
    if (code == 0 && merge_all(&t) < 0)
        code = orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    if (code == 0) {
        set_results(&t, result);
        code = write_out(&t, false, result);
        if (code == 0 && measurement->request->want_errors)
            code = write_out(&t, true, result);
        code = code < 0 ? orl_gonio_trees_fail(&t, code, err) : 0;
    }
    trees_done(&t);
    return code;
}

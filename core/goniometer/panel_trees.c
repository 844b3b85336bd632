#include "goniometer/panel_trees.h"

#include <stdlib.h>
#include <string.h>

#include "goniometer/hues.h"
#include "goniometer/panel_xml.h"
#include "goniometer/tree_blocks.h"

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

/* Adds the nodes of a block, original or mirrored, to the side's forest. */
static bool add_block_nodes(const struct orl_gonio_trees *t, struct orl_gonio_forest *forest,
                            size_t side, size_t a, struct orl_gonio_cells ret_cells)
{
    unsigned mirror;
    const struct orl_gonio_block *block =
        &t->blocks[side * t->n_blocks + orl_gonio_original_of(t, a, &mirror)];
    const size_t cells = orl_gonio_nodes_at(t->split) / 2;
    uint32_t shift;
    if (!orl_gonio_forest_take(forest, &block->forest, mirror, &shift))
        return false;
    for (size_t i = 0; i < 2 * cells; i++) {
        const size_t from = i / cells * cells + mirrored_cell(i % cells, t->split, mirror);
        orl_gonio_cells_copy(orl_gonio_cells_at(ret_cells, i),
                             orl_gonio_cells_at(block->tops, from), 1);
        ret_cells.nodes[i] = orl_gonio_shifted(ret_cells.nodes[i], shift);
    }
    return true;
}

/* Computes the nodes of incident cell a at a level above the blocks. In rank 3 the upper half of A
 * has no directions; it is a copy of the lower one. */
static bool gather_nodes(const struct orl_gonio_trees *t, struct orl_gonio_forest *forest,
                         size_t side, unsigned level, size_t a, struct orl_gonio_cells ret_cells)
{
    const unsigned in = orl_gonio_parts_in(t->rank);
    if (level == t->split)
        return add_block_nodes(t, forest, side, a, ret_cells);
    const size_t count = orl_gonio_nodes_at(level + 1);
    struct orl_gonio_cells parts;
    bool fine = orl_gonio_cells_make(&parts, in * count, forest->color);
    for (unsigned k = 0; k < in && fine; k++) {
        if (t->rank == 3 && level == 0 && k == 1)
            orl_gonio_cells_copy(orl_gonio_cells_at(parts, count), parts, count);
        else
            fine = gather_nodes(t, forest, side, level + 1, in * a + k,
                                orl_gonio_cells_at(parts, k * count));
    }
    fine = fine && orl_gonio_join_level(forest, parts, orl_gonio_nodes_at(level), level, ret_cells);
    orl_gonio_cells_done(&parts);
    return fine;
}

static int join_all(struct orl_gonio_trees *t)
{
    for (size_t side = 0; side < 2; side++) {
        const struct orl_gonio_cells roots = {t->roots[side],
                                              t->request->color ? t->root_hues[side] : NULL};
        t->forests[side] = orl_gonio_forest_of(t);
        if (!gather_nodes(t, &t->forests[side], side, 0, 0, roots))
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
    for (size_t a = 0; a < t->n_blocks; a++) {
        const struct orl_gonio_block *b =
            &t->blocks[side * t->n_blocks + orl_gonio_original_of(t, a, &mirror)];
        const double n = (double)t->n_blocks;
        const double weight =
            t->rank == 4 ? ldexp(1, -2 * (int)t->levels) : (2 * (n - (double)a) - 1) / (n * n);
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            values[k] += weight * b->totals[k][transmitted];
    }
    return orl_gonio_share_of(values);
}

static void set_results(const struct orl_gonio_trees *t, struct orl_bsdf_made *made)
{
    double lost = 0;
    struct orl_gonio_worst worst = {0, 0};
    made->reached = true;
    for (size_t side = 0; side < 2; side++)
        for (size_t k = 0; k < 2; k++) {
            const struct orl_gonio_forest *forest = &t->forests[side];
            const struct orl_gonio_node root = t->roots[side][k];
            const double from = counted_from * orl_gonio_forest_peak(forest, root);
            made->diffuse[side][k] = diffuse_of(t, side, k);
            orl_gonio_forest_worst(forest, root, from, &worst);
        }
    for (size_t i = 0; i < t->n_todo; i++) {
        made->paths += t->blocks[t->todo[i]].paths;
        lost += t->blocks[t->todo[i]].lost;
        made->reached = made->reached && !t->blocks[t->todo[i]].short_of;
    }
    made->worst = worst.noise;
    made->joined = worst.joined;
    made->lost = made->paths > 0 ? lost / (double)made->paths : 0;
}

/* Finds the side of a part, and if it is transmitted. */
static void find_part(enum orl_bsdf_part part, size_t *ret_side, size_t *ret_transmitted)
{
    for (size_t i = 0; i < 4; i++)
        if (orl_gonio_part_of[i / 2][i % 2] == part) {
            *ret_side = i / 2;
            *ret_transmitted = i % 2;
        }
}

static void write_part(void *ctx, enum orl_bsdf_part part, enum orl_bsdf_channel channel, FILE *out)
{
    const struct orl_gonio_trees *t = ctx;
    size_t side = 0, k = 0;
    find_part(part, &side, &k);
    if (channel == ORL_CHANNEL_VISIBLE)
        orl_gonio_forest_write(&t->forests[side], t->roots[side][k], false, t->cancel, out);
    else
        orl_gonio_hues_write(&t->forests[side], t->roots[side][k], t->root_hues[side][k], channel,
                             t->cancel, out);
}

/* Writes errors, which are those of luminance only. */
static void write_errors(void *ctx, enum orl_bsdf_part part, enum orl_bsdf_channel channel,
                         FILE *out)
{
    const struct orl_gonio_trees *t = ctx;
    size_t side = 0, k = 0;
    (void)channel;
    find_part(part, &side, &k);
    orl_gonio_forest_write(&t->forests[side], t->roots[side][k], true, t->cancel, out);
}

/* Writes the BSDF, or its errors. */
static int write_out(struct orl_gonio_trees *t, bool errors, struct orl_bsdf_made *made)
{
    struct orl_document document = {.structure =
                                        t->rank == 4 ? ORL_STRUCTURE_TREE4 : ORL_STRUCTURE_TREE3};
    for (int part = 0; part < ORL_PART_COUNT; part++) {
        bool *given = document.parts[part].chroma.given;
        document.parts[part].present = true;
        given[0] = given[1] = t->request->color && !errors;
    }
    const int code =
        errors ? orl_gonio_write_errors(&document, write_errors, t, t->sample, t->request, made)
               : orl_gonio_write(&document, write_part, t, t->sample, t->request, made);
    return code == 0 && orl_is_cancelled(t->cancel) ? ORL_ERR_CANCELLED : code;
}

static void trees_done(struct orl_gonio_trees *t)
{
    for (size_t i = 0; t->blocks && i < 2 * t->n_blocks; i++)
        orl_gonio_block_done(&t->blocks[i]);
    free(t->blocks);
    free(t->todo);
    orl_gonio_forest_done(&t->forests[0]);
    orl_gonio_forest_done(&t->forests[1]);
}

static struct orl_gonio_trees trees_of(const struct orl_bsdf_make_request *request,
                                       const struct orl_bsdf_make_env *env,
                                       const struct orl_gonio_sample *sample,
                                       const struct orl_sobol *sobol)
{
    struct orl_gonio_trees t = {.request = request,
                                .cull = {request->cull, request->unseen},
                                .sample = sample,
                                .sobol = sobol,
                                .levels = 1,
                                .paths_most = request->paths_most / ORL_GONIO_BATCHES,
                                .cancel = env->cancel};
    t.rank = request->basis == ORL_BSDF_TENSOR_TREE_4 ? 4 : 3;
    while (1U << t.levels < request->resolution)
        t.levels++;
    /* Rank 3: every ring is a block, and half of A has none. */
    t.split = t.rank == 3 ? t.levels : t.levels < SPLIT_LEVEL ? t.levels : SPLIT_LEVEL;
    t.n_blocks = t.rank == 3 ? (size_t)1 << (t.levels - 1) : (size_t)1 << 2 * t.split;
    const uint32_t sets = request->accuracy > 0 ? 2 * ORL_GONIO_BATCHES : ORL_GONIO_BATCHES;
    t.paths = (orl_bsdf_make_paths(request) + sets - 1) / sets;
    t.blocks = calloc(2 * t.n_blocks, sizeof *t.blocks);
    t.todo = calloc(2 * t.n_blocks, sizeof *t.todo);
    for (size_t i = 0; t.todo && i < 2 * t.n_blocks; i++) {
        unsigned mirror;
        if (orl_gonio_original_of(&t, i % t.n_blocks, &mirror) == i % t.n_blocks)
            t.todo[t.n_todo++] = i;
    }
    return t;
}

int orl_gonio_make_trees(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err)
{
    struct orl_gonio_trees t = trees_of(request, env, sample, sobol);
    if (!t.blocks || !t.todo) {
        trees_done(&t);
        return orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    }
    int code = orl_gonio_measure_blocks(&t, env, err);
    if (code == 0 && join_all(&t) < 0)
        code = orl_gonio_trees_fail(&t, ORL_ERR_NOMEM, err);
    if (code == 0) {
        set_results(&t, made);
        code = write_out(&t, false, made);
        if (code == 0 && request->tell_errors)
            code = write_out(&t, true, made);
        code = code < 0 ? orl_gonio_trees_fail(&t, code, err) : 0;
    }
    trees_done(&t);
    return code;
}

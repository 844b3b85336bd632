/* Writes models as tensor trees. Incident cells are processed in blocks in parallel, and cells are
 * merged from the finest level up. */
#include <stdlib.h>
#include <string.h>

#include "bsdf/fit/fit.h"
#include "bsdf/fit/scan/scan_light.h"
#include "bsdf/make/make_bsdf.h"
#include "bsdf/make/trees/tree_builder.h"
#include "bsdf/xml/bsdf_xml.h"

enum { SPLIT_LEVEL = 3, CHUNK = 8 };

/* Incident directions processed by one thread: a cell at some level. */
struct block {
    struct orl_gonio_builder builder;
    struct orl_gonio_cells top_nodes; /* by cell out at that level; owned */
    double total;                     /* light sent out, summed over finest incident cells */
    int code;
};

struct scratch {
    struct orl_fit_accumulator accumulator;
    struct orl_fit_light light;
    double *sums; /* sums by cell out */
};

struct tree_fit {
    const struct orl_bsdf_make_env *env;
    struct orl_fit_model *model;
    const struct orl_fit_raster *raster;
    struct orl_gonio_split of; /* its subtrees are the blocks */
    struct orl_gonio_cull cull;
    double progress_from, share; /* shares of all work: the start of this component, and its part */
    size_t first;                /* first of the blocks in work */
    struct block *blocks;
    struct scratch *scratches; /* one per thread of the pool */
    struct orl_gonio_builder builder;
    struct orl_gonio_node root;
};

/* ---- Incident cells -------------------------------------------------------------------------- */

/* Sets the ring of a cell in rank 3: inner and outer radius on the disk of sines. */
static void set_ring(const struct tree_fit *g, uint32_t a, double ret_sines[2])
{
    const double side = UINT32_C(1) << g->of.levels;
    ret_sines[0] = 1 - 2 * (a + 1) / side;
    ret_sines[1] = 1 - 2 * a / side;
}

/* Returns the sample directions for an incident cell. Rank 4 has so many cells that the middle of
 * each is enough. Rings are wide near grazing, where mirrored light moves as far as the incident
 * light. */
static unsigned samples_in(const struct tree_fit *g, uint32_t a)
{
    const double widest_rad = 1.5 * ORL_DEG_TO_RAD;
    double sines[2];
    if (g->of.rank == 4)
        return 1;
    set_ring(g, a, sines);
    const unsigned n = (unsigned)ceil((asin(sines[1]) - asin(sines[0])) / widest_rad);
    return n < ORL_FIT_CELL_SAMPLES ? ORL_FIT_CELL_SAMPLES : n;
}

/* Returns a direction from which light of a finest incident cell comes; cells hold directions of
 * travel. */
static struct orl_vec3 incidence(const struct tree_fit *g, uint32_t a, unsigned location)
{
    if (g->of.rank == 3) {
        double sines[2];
        set_ring(g, a, sines);
        const double u = (location + 0.5) / samples_in(g, a);
        const double r2 = sines[0] * sines[0] * (1 - u) + sines[1] * sines[1] * u;
        return orl_v3(-sqrt(r2), 0, sqrt(1 - r2));
    }
    const struct orl_vec3 travel = orl_morton_direction(a, g->of.levels, 0.5, 0.5);
    return orl_v3(-travel.x, -travel.y, travel.z);
}

/* Returns the first of the blocks that are mirror images of this one; the others are copied from
 * it. */
static uint32_t original_of(const struct tree_fit *g, uint32_t block, unsigned *ret_mirror)
{
    unsigned mirrors[3];
    const size_t n = g->of.rank == 3 ? 0 : orl_fit_mirrors(g->model->symmetry, mirrors);
    uint32_t first = block;
    *ret_mirror = 0;
    for (size_t i = 0; i < n; i++) {
        const uint32_t other = orl_gonio_mirrored_cell(block, g->of.split, mirrors[i]);
        if (other < first) {
            first = other;
            *ret_mirror = mirrors[i];
        }
    }
    return first;
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* Returns the value of a cell out. Isotropic samples: the two sides of the plane of incidence are
 * averaged. */
static double value_of(const struct tree_fit *g, const double *sums, uint32_t cell)
{
    const double value = sums[cell];
    return g->of.rank == 3 ? 0.5 * (value + sums[orl_gonio_mirrored_cell(cell, g->of.levels, 2)])
                           : value;
}

/* Context of one block. */
struct block_work {
    const struct tree_fit *g;
    struct scratch *scratch;
    struct block *block;
};

static bool evaluate_cell(void *ctx, uint32_t a, struct orl_gonio_cells ret_cells)
{
    const struct block_work *work = ctx;
    const struct tree_fit *g = work->g;
    struct scratch *scratch = work->scratch;
    struct block *block = work->block;
    const size_t cells = g->raster->n_cells;
    const unsigned samples = samples_in(g, a);
    if (orl_is_cancelled(g->env->cancel))
        return false;
    memset(scratch->sums, 0, cells * sizeof *scratch->sums);
    for (unsigned i = 0; i < samples; i++) {
        struct orl_fit_location location;
        orl_fit_mesh_locate(&g->model->mesh, incidence(g, a, i), &location);
        if (!orl_fit_interpolate(&g->model->mesh, &g->model->plans, &location, &scratch->light))
            return false;
        orl_fit_rasterize(g->raster, &scratch->light, 0, &scratch->accumulator);
        for (size_t c = 0; c < cells; c++)
            scratch->sums[c] += scratch->accumulator.value[c] / samples;
    }
    for (size_t c = 0; c < cells; c++) {
        const double value = value_of(g, scratch->sums, (uint32_t)c);
        ret_cells.nodes[c] = (struct orl_gonio_node){.value = (float)value};
        block->total += value * g->raster->area;
    }
    return true;
}

/* ---- Merging --------------------------------------------------------------------------------- */

static void build_block(void *arg, size_t index, uint32_t member)
{
    const struct tree_fit *g = arg;
    const uint32_t a = (uint32_t)(g->first + index);
    struct block *block = &g->blocks[a];
    unsigned mirror;
    if (original_of(g, a, &mirror) != a)
        return;
    struct block_work work = {g, &g->scratches[member], block};
    const struct orl_gonio_merger merger = {&block->builder, g->of.levels, 1, evaluate_cell, &work};
    block->builder = (struct orl_gonio_builder){.rank = g->of.rank, .cull = g->cull};
    if (!orl_gonio_cells_make(&block->top_nodes, (size_t)1 << 2 * g->of.split, false) ||
        !orl_gonio_merge_nodes(&merger, g->of.split, a, block->top_nodes))
        block->code = orl_is_cancelled(g->env->cancel) ? ORL_ERR_CANCELLED : ORL_ERR_NOMEM;
}

/* Adds the nodes of a block, original or mirrored, to the whole tree. */
static bool add_block_nodes(void *ctx, uint32_t a, struct orl_gonio_cells ret_cells)
{
    struct tree_fit *g = ctx;
    unsigned mirror;
    const struct block *block = &g->blocks[original_of(g, a, &mirror)];
    uint32_t shift;
    if (!orl_gonio_builder_append(&g->builder, &block->builder, mirror * 5U, &shift))
        return false;
    for (uint32_t i = 0; i < 1U << 2 * g->of.split; i++)
        ret_cells.nodes[i] = orl_gonio_node_shifted(
            block->top_nodes
                .nodes[g->of.rank == 3 ? i : orl_gonio_mirrored_cell(i, g->of.split, mirror)],
            shift);
    return true;
}

/* ---- One component --------------------------------------------------------------------------- */

/* Returns the total for diffuse light from a side. */
static double diffuse_of(const struct tree_fit *g)
{
    double sum = 0;
    unsigned mirror;
    for (uint32_t a = 0; a < g->of.n_subtrees; a++)
        sum += orl_gonio_diffuse_weight(&g->of, a) * g->blocks[original_of(g, a, &mirror)].total;
    return sum;
}

static int request_plans(struct tree_fit *g, struct orl_error *err)
{
    const size_t cells = g->of.rank == 3 ? g->of.n_subtrees : (size_t)1 << 2 * g->of.levels;
    unsigned mirror;
    for (uint32_t a = 0; a < cells; a++) {
        const uint32_t block = a >> 2 * (g->of.levels - g->of.split);
        if (original_of(g, block, &mirror) != block)
            continue;
        for (unsigned i = 0; i < samples_in(g, a); i++) {
            struct orl_fit_location location;
            orl_fit_mesh_locate(&g->model->mesh, incidence(g, a, i), &location);
            if (!orl_fit_plans_request(&g->model->plans, &location))
                return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for transport plans");
        }
    }
    return orl_fit_plans_make(&g->model->plans, &g->model->mesh, g->env->pool, g->env->cancel, err);
}

static bool make_scratches(struct tree_fit *g)
{
    const uint32_t members = orl_thread_pool_size(g->env->pool);
    bool fine = g->scratches != NULL && g->blocks != NULL;
    for (uint32_t i = 0; i < members && fine; i++) {
        g->scratches[i].sums = malloc(g->raster->n_cells * sizeof *g->scratches[i].sums);
        fine = g->scratches[i].sums &&
               orl_fit_accumulator_make(g->raster, &g->scratches[i].accumulator);
    }
    return fine;
}

static void free_work(struct tree_fit *g)
{
    for (uint32_t i = 0; g->scratches && i < orl_thread_pool_size(g->env->pool); i++) {
        free(g->scratches[i].sums);
        orl_fit_accumulator_done(&g->scratches[i].accumulator);
        orl_fit_light_done(&g->scratches[i].light);
    }
    free(g->scratches);
    for (size_t i = 0; g->blocks && i < g->of.n_subtrees; i++) {
        orl_gonio_builder_done(&g->blocks[i].builder);
        orl_gonio_cells_done(&g->blocks[i].top_nodes);
    }
    free(g->blocks);
    g->scratches = NULL;
    g->blocks = NULL;
}

static int build_blocks(struct tree_fit *g)
{
    int code = 0;
    for (g->first = 0; g->first < g->of.n_subtrees && code == 0; g->first += CHUNK) {
        const size_t left = g->of.n_subtrees - g->first, count = left < CHUNK ? left : CHUNK;
        code = orl_parallel_try(g->env->pool, count, build_block, g);
        for (size_t i = g->first; i < g->first + count && code == 0; i++)
            code = g->blocks[i].code;
        if (g->env->progress && code == 0)
            g->env->progress(g->env->ctx, 1,
                             g->progress_from +
                                 g->share * (double)(g->first + count) / (double)g->of.n_subtrees);
    }
    return code;
}

static int build_all(struct tree_fit *g, struct orl_error *err)
{
    int code = request_plans(g, err);
    if (code < 0)
        return code;
    g->blocks = calloc(g->of.n_subtrees, sizeof *g->blocks);
    g->scratches = calloc(orl_thread_pool_size(g->env->pool), sizeof *g->scratches);
    code = make_scratches(g) ? build_blocks(g) : ORL_ERR_NOMEM;
    const struct orl_gonio_merger merger = {&g->builder, g->of.split, 1, add_block_nodes, g};
    if (code == 0 &&
        !orl_gonio_merge_nodes(&merger, 0, 0, (struct orl_gonio_cells){&g->root, NULL}))
        code = ORL_ERR_NOMEM;
    return code == 0 ? 0
                     : orl_error_set(err, code,
                                     code == ORL_ERR_CANCELLED ? "cancelled"
                                                               : "out of memory for tensor trees");
}

/* ---- The file -------------------------------------------------------------------------------- */

struct parts {
    struct tree_fit of[2][2];
};

static void write_part(void *ctx, enum orl_component_kind part, enum orl_bsdf_channel channel,
                       FILE *out)
{
    const struct parts *parts = ctx;
    size_t i = 0;
    (void)channel;
    while (orl_gonio_component_of[i / 2][i % 2] != part)
        i++;
    const struct tree_fit *g = &parts->of[i / 2][i % 2];
    orl_gonio_builder_write(&g->builder, g->root, false, g->env->cancel, out);
}

int orl_fit_write_trees(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err)
{
    struct orl_fit_raster raster;
    struct orl_document document = {.structure = result->basis == ORL_BSDF_TENSOR_TREE_4
                                                     ? ORL_STRUCTURE_TREE4
                                                     : ORL_STRUCTURE_TREE3};
    struct parts parts = {0};
    const struct orl_gonio_split split =
        orl_gonio_split_of(result->basis, request->resolution, SPLIT_LEVEL);
    int n_models = 0, done = 0;
    for (int i = 0; i < 4; i++)
        n_models += models->of[i / 2][i % 2] != NULL;
    int code = orl_fit_raster_make(split.levels, &raster, err);
    if (code < 0)
        return code;
    for (int i = 0; i < 4 && code == 0; i++) {
        struct orl_fit_model *model = models->of[i / 2][i % 2];
        struct tree_fit *g = &parts.of[i / 2][i % 2];
        if (!model)
            continue;
        *g = (struct tree_fit){.env = env,
                               .model = model,
                               .raster = &raster,
                               .of = split,
                               .cull = {request->cull, ORL_BSDF_CULL_FRACTION},
                               .share = (1 - orl_fit_prepared_share) / n_models};
        g->builder = (struct orl_gonio_builder){.rank = split.rank, .cull = g->cull};
        g->progress_from = orl_fit_prepared_share + done++ * g->share;
        code = build_all(g, err);
        if (code == 0)
            result->diffuse[i / 2][i % 2].value = diffuse_of(g);
        free_work(g);
        document.parts[orl_gonio_component_of[i / 2][i % 2]].present = true;
    }
    const struct orl_bsdf_labels labels = {.write_part = write_part, .ctx = &parts};
    if (code == 0)
        code = orl_fit_write_xml(&document, &labels, request, result, err);
    if (code == 0 && orl_is_cancelled(env->cancel))
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    for (int i = 0; i < 4; i++)
        orl_gonio_builder_done(&parts.of[i / 2][i % 2].builder);
    orl_fit_raster_done(&raster);
    return code;
}

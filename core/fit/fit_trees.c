/* Writes models as tensor trees. Incident cells are processed in blocks in parallel, and cells are
 * joined from the finest level up. */
#include <stdlib.h>
#include <string.h>

#include "bsdf/write_xml.h"
#include "fit/output.h"
#include "fit/square.h"
#include "goniometer/forest.h"
#include "goniometer/panel_xml.h"

enum { SPLIT_LEVEL = 3, AT_ONCE = 8 };

/* Incident directions processed by one thread: a cell at some level. */
struct block {
    struct orl_gonio_forest forest;
    struct orl_gonio_cells tops; /* by cell out at that level; owned */
    double total;                /* light sent out, summed over finest incident cells */
    int code;
};

struct hand {
    struct orl_fit_brush brush;
    struct orl_fit_light light;
    double *sums; /* sums by cell out */
};

struct growing {
    const struct orl_bsdf_make_env *env;
    struct orl_fit_model *model;
    const struct orl_fit_screen *screen;
    unsigned rank, levels, split; /* split: level of the blocks */
    size_t n_blocks;
    struct orl_gonio_cull cull;
    double begun, share; /* shares of all work: the start of this component, and its part */
    size_t first;        /* first of the blocks in work */
    struct block *blocks;
    struct hand *hands; /* by member of the crew */
    struct orl_gonio_forest forest;
    struct orl_gonio_node root;
};

/* ---- Incident cells -------------------------------------------------------------------------- */

static uint32_t even_bits(uint32_t v)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 16; i++)
        bits |= (v >> 2 * i & 1) << i;
    return bits;
}

/* Sets the ring of a cell in rank 3: inner and outer radius on the disk of sines. */
static void set_ring(const struct growing *g, uint32_t a, double ret_sines[2])
{
    const double side = UINT32_C(1) << g->levels;
    ret_sines[0] = 1 - 2 * (a + 1) / side;
    ret_sines[1] = 1 - 2 * a / side;
}

/* Returns the sample directions for an incident cell. Rank 4 has so many cells that the middle of
 * each is enough. Rings are wide near grazing, where mirrored light moves as far as the incident
 * light. */
static unsigned places_in(const struct growing *g, uint32_t a)
{
    const double widest_rad = 1.5 * ORL_DEG_TO_RAD;
    double sines[2];
    if (g->rank == 4)
        return 1;
    set_ring(g, a, sines);
    const unsigned n = (unsigned)ceil((asin(sines[1]) - asin(sines[0])) / widest_rad);
    return n < ORL_FIT_CELL_PLACES ? ORL_FIT_CELL_PLACES : n;
}

/* Returns a direction from which light of a finest incident cell comes; cells hold directions of
 * travel. */
static struct orl_vec3 incidence(const struct growing *g, uint32_t a, unsigned place)
{
    if (g->rank == 3) {
        double sines[2];
        set_ring(g, a, sines);
        const double u = (place + 0.5) / places_in(g, a);
        const double r2 = sines[0] * sines[0] * (1 - u) + sines[1] * sines[1] * u;
        return orl_v3(-sqrt(r2), 0, sqrt(1 - r2));
    }
    const double side = UINT32_C(1) << g->levels;
    const double x = (even_bits(a) + 0.5) / side, y = (even_bits(a >> 1) + 0.5) / side;
    const struct orl_vec3 travel =
        orl_square_to_hemisphere((struct orl_square){2 * x - 1, 2 * y - 1});
    return orl_v3(-travel.x, -travel.y, travel.z);
}

/* Returns the mirror image of a cell at some level. */
static uint32_t mirrored(uint32_t cell, unsigned level, unsigned mirror)
{
    for (unsigned l = 0; l < level; l++)
        cell ^= mirror << 2 * l;
    return cell;
}

/* Returns the first of the blocks that are mirror images of this one; the others are copied from
 * it. */
static uint32_t original_of(const struct growing *g, uint32_t block, unsigned *ret_mirror)
{
    unsigned mirrors[3];
    const size_t n = g->rank == 3 ? 0 : orl_fit_mirrors(g->model->symmetry, mirrors);
    uint32_t first = block;
    *ret_mirror = 0;
    for (size_t i = 0; i < n; i++) {
        const uint32_t other = mirrored(block, g->split, mirrors[i]);
        if (other < first) {
            first = other;
            *ret_mirror = mirrors[i];
        }
    }
    return first;
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* Isotropic samples: the two sides of the plane of incidence are averaged. */
static double value_of(const struct growing *g, const double *sums, uint32_t cell)
{
    const double value = sums[cell];
    return g->rank == 3 ? 0.5 * (value + sums[mirrored(cell, g->levels, 2)]) : value;
}

static bool evaluate_cell(const struct growing *g, struct hand *hand, struct block *block,
                          uint32_t a, struct orl_gonio_cells ret_cells)
{
    const size_t cells = g->screen->n_cells;
    const unsigned places = places_in(g, a);
    memset(hand->sums, 0, cells * sizeof *hand->sums);
    for (unsigned i = 0; i < places; i++) {
        struct orl_fit_place place;
        orl_fit_mesh_locate(&g->model->mesh, incidence(g, a, i), &place);
        if (!orl_fit_blend(&g->model->mesh, &g->model->plans, &place, &hand->light))
            return false;
        orl_fit_draw(g->screen, &hand->light, 0, &hand->brush);
        for (size_t c = 0; c < cells; c++)
            hand->sums[c] += hand->brush.value[c] / places;
    }
    for (size_t c = 0; c < cells; c++) {
        const double value = value_of(g, hand->sums, (uint32_t)c);
        ret_cells.nodes[c] = (struct orl_gonio_node){.value = (float)value};
        block->total += value * g->screen->area;
    }
    return true;
}

/* ---- Joining --------------------------------------------------------------------------------- */

static size_t nodes_at(unsigned level)
{
    return (size_t)1 << 2 * level;
}

/* Computes the nodes of incident cell a at a level, from the finest cells up. */
static bool grow_nodes(const struct growing *g, struct hand *hand, struct block *block,
                       unsigned level, uint32_t a, struct orl_gonio_cells ret_cells)
{
    const unsigned in = orl_gonio_parts_in(g->rank);
    if (level == g->levels)
        return !orl_is_cancelled(g->env->cancel) && evaluate_cell(g, hand, block, a, ret_cells);
    struct orl_gonio_cells parts;
    bool fine = orl_gonio_cells_make(&parts, in * nodes_at(level + 1), false);
    for (unsigned k = 0; k < in && fine; k++)
        fine = grow_nodes(g, hand, block, level + 1, in * a + k,
                          orl_gonio_cells_at(parts, k * nodes_at(level + 1)));
    fine = fine && orl_gonio_join_level(&block->forest, parts, nodes_at(level), level, ret_cells);
    orl_gonio_cells_done(&parts);
    return fine;
}

static void grow_block(void *arg, size_t index, uint32_t member)
{
    const struct growing *g = arg;
    const uint32_t a = (uint32_t)(g->first + index);
    struct block *block = &g->blocks[a];
    unsigned mirror;
    if (original_of(g, a, &mirror) != a)
        return;
    block->forest = (struct orl_gonio_forest){.rank = g->rank, .cull = g->cull};
    if (!orl_gonio_cells_make(&block->tops, nodes_at(g->split), false) ||
        !grow_nodes(g, &g->hands[member], block, g->split, a, block->tops))
        block->code = orl_is_cancelled(g->env->cancel) ? ORL_ERR_CANCELLED : ORL_ERR_NOMEM;
}

/* Adds the nodes of a block, original or mirrored, to the whole tree. */
static bool add_block_nodes(struct growing *g, uint32_t a, struct orl_gonio_cells ret_cells)
{
    unsigned mirror;
    const struct block *block = &g->blocks[original_of(g, a, &mirror)];
    uint32_t shift;
    if (!orl_gonio_forest_take(&g->forest, &block->forest, mirror * 5U, &shift))
        return false;
    for (uint32_t i = 0; i < nodes_at(g->split); i++)
        ret_cells.nodes[i] = orl_gonio_shifted(
            block->tops.nodes[g->rank == 3 ? i : mirrored(i, g->split, mirror)], shift);
    return true;
}

/* Computes the nodes of incident cell a at a level above the blocks. In rank 3 the upper half of A
 * has no directions; it is a copy of the lower one. */
static bool gather_nodes(struct growing *g, unsigned level, uint32_t a,
                         struct orl_gonio_cells ret_cells)
{
    const unsigned in = orl_gonio_parts_in(g->rank);
    if (level == g->split)
        return add_block_nodes(g, a, ret_cells);
    const size_t count = nodes_at(level + 1);
    struct orl_gonio_cells parts;
    bool fine = orl_gonio_cells_make(&parts, in * count, false);
    for (unsigned k = 0; k < in && fine; k++) {
        if (g->rank == 3 && level == 0 && k == 1)
            orl_gonio_cells_copy(orl_gonio_cells_at(parts, count), parts, count);
        else
            fine = gather_nodes(g, level + 1, in * a + k, orl_gonio_cells_at(parts, k * count));
    }
    fine = fine && orl_gonio_join_level(&g->forest, parts, nodes_at(level), level, ret_cells);
    orl_gonio_cells_done(&parts);
    return fine;
}

/* ---- One component --------------------------------------------------------------------------- */

/* Returns the total for diffuse light from a side. Cells of A have equal weights in rank 4; rings
 * have weights by their size in rank 3. */
static double diffuse_of(const struct growing *g)
{
    double sum = 0;
    unsigned mirror;
    for (uint32_t a = 0; a < g->n_blocks; a++) {
        const double n = (double)g->n_blocks;
        const double weight =
            g->rank == 4 ? ldexp(1, -2 * (int)g->levels) : (2 * (n - (double)a) - 1) / (n * n);
        sum += weight * g->blocks[original_of(g, a, &mirror)].total;
    }
    return sum;
}

static int want_plans(struct growing *g, struct orl_error *err)
{
    const size_t cells = g->rank == 3 ? g->n_blocks : (size_t)1 << 2 * g->levels;
    unsigned mirror;
    for (uint32_t a = 0; a < cells; a++) {
        const uint32_t block = a >> 2 * (g->levels - g->split);
        if (original_of(g, block, &mirror) != block)
            continue;
        for (unsigned i = 0; i < places_in(g, a); i++) {
            struct orl_fit_place place;
            orl_fit_mesh_locate(&g->model->mesh, incidence(g, a, i), &place);
            if (!orl_fit_plans_want(&g->model->plans, &place))
                return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for transport plans");
        }
    }
    return orl_fit_plans_make(&g->model->plans, &g->model->mesh, g->env->crew, g->env->cancel, err);
}

static bool make_hands(struct growing *g)
{
    const uint32_t members = orl_crew_size(g->env->crew);
    bool fine = g->hands != NULL && g->blocks != NULL;
    for (uint32_t i = 0; i < members && fine; i++) {
        g->hands[i].sums = malloc(g->screen->n_cells * sizeof *g->hands[i].sums);
        fine = g->hands[i].sums && orl_fit_brush_make(g->screen, &g->hands[i].brush);
    }
    return fine;
}

static void free_work(struct growing *g)
{
    for (uint32_t i = 0; g->hands && i < orl_crew_size(g->env->crew); i++) {
        free(g->hands[i].sums);
        orl_fit_brush_done(&g->hands[i].brush);
        orl_fit_light_done(&g->hands[i].light);
    }
    free(g->hands);
    for (size_t i = 0; g->blocks && i < g->n_blocks; i++) {
        orl_gonio_forest_done(&g->blocks[i].forest);
        orl_gonio_cells_done(&g->blocks[i].tops);
    }
    free(g->blocks);
    g->hands = NULL;
    g->blocks = NULL;
}

static int grow_blocks(struct growing *g)
{
    int code = 0;
    for (g->first = 0; g->first < g->n_blocks && code == 0; g->first += AT_ONCE) {
        const size_t left = g->n_blocks - g->first, count = left < AT_ONCE ? left : AT_ONCE;
        code = orl_crew_try(g->env->crew, count, grow_block, g);
        for (size_t i = g->first; i < g->first + count && code == 0; i++)
            code = g->blocks[i].code;
        if (g->env->progress && code == 0)
            g->env->progress(g->env->ctx, 1,
                             g->begun +
                                 g->share * (double)(g->first + count) / (double)g->n_blocks);
    }
    return code;
}

static int grow_all(struct growing *g, struct orl_error *err)
{
    int code = want_plans(g, err);
    if (code < 0)
        return code;
    g->blocks = calloc(g->n_blocks, sizeof *g->blocks);
    g->hands = calloc(orl_crew_size(g->env->crew), sizeof *g->hands);
    code = make_hands(g) ? grow_blocks(g) : ORL_ERR_NOMEM;
    if (code == 0 && !gather_nodes(g, 0, 0, (struct orl_gonio_cells){&g->root, NULL}))
        code = ORL_ERR_NOMEM;
    return code == 0 ? 0
                     : orl_error_set(err, code,
                                     code == ORL_ERR_CANCELLED ? "cancelled"
                                                               : "out of memory for tensor trees");
}

static struct growing growing_of(const struct orl_bsdf_fit_request *request,
                                 const struct orl_bsdf_make_env *env, enum orl_bsdf_basis basis,
                                 const struct orl_fit_screen *screen)
{
    struct growing g = {.env = env, .screen = screen, .levels = screen->levels};
    g.cull = (struct orl_gonio_cull){request->cull, ORL_BSDF_UNSEEN};
    g.rank = basis == ORL_BSDF_TENSOR_TREE_4 ? 4 : 3;
    /* Rank 3: every ring is a block, and half of A has none. */
    g.split = g.rank == 3 ? g.levels : g.levels < SPLIT_LEVEL ? g.levels : SPLIT_LEVEL;
    g.n_blocks = g.rank == 3 ? (size_t)1 << (g.levels - 1) : (size_t)1 << 2 * g.split;
    return g;
}

/* ---- The file -------------------------------------------------------------------------------- */

struct parts {
    struct growing of[2][2];
};

static void write_part(void *ctx, enum orl_bsdf_part part, enum orl_bsdf_channel channel, FILE *out)
{
    const struct parts *parts = ctx;
    (void)channel;
    for (int front = 0; front < 2; front++)
        for (int t = 0; t < 2; t++)
            if (orl_gonio_part_of[front][t] == part)
                orl_gonio_forest_write(&parts->of[front][t].forest, parts->of[front][t].root, false,
                                       parts->of[front][t].env->cancel, out);
}

int orl_fit_write_trees(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fitted *fitted, struct orl_error *err)
{
    struct orl_fit_screen screen;
    struct orl_document document = {.structure = fitted->basis == ORL_BSDF_TENSOR_TREE_4
                                                     ? ORL_STRUCTURE_TREE4
                                                     : ORL_STRUCTURE_TREE3};
    struct parts parts = {0};
    unsigned levels = 2;
    int n_models = 0, done = 0;
    for (int i = 0; i < 4; i++)
        n_models += models->of[i / 2][i % 2] != NULL;
    while (1U << levels < request->resolution)
        levels++;
    int code = orl_fit_screen_make(levels, &screen, err);
    if (code < 0)
        return code;
    for (int i = 0; i < 4 && code == 0; i++) {
        struct orl_fit_model *model = models->of[i / 2][i % 2];
        struct growing *g = &parts.of[i / 2][i % 2];
        if (!model)
            continue;
        *g = growing_of(request, env, fitted->basis, &screen);
        g->forest = (struct orl_gonio_forest){.rank = g->rank, .cull = g->cull};
        g->model = model;
        g->share = (1 - orl_fit_begun) / n_models;
        g->begun = orl_fit_begun + done++ * g->share;
        code = grow_all(g, err);
        if (code == 0)
            fitted->diffuse[i / 2][i % 2].value = diffuse_of(g);
        free_work(g);
        document.parts[orl_gonio_part_of[i / 2][i % 2]].present = true;
    }
    const struct orl_bsdf_labels labels = {.write_part = write_part, .ctx = &parts};
    if (code == 0)
        code = orl_fit_write_xml(&document, &labels, request, fitted, err);
    if (code == 0 && orl_is_cancelled(env->cancel))
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    for (int i = 0; i < 4; i++)
        orl_gonio_forest_done(&parts.of[i / 2][i % 2].forest);
    orl_fit_screen_done(&screen);
    return code;
}

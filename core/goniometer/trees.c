#include "goniometer/trees.h"

#include <stdlib.h>
#include <string.h>

#include "goniometer/probe.h"
#include "goniometer/provenance.h"
#include "goniometer/reading.h"
#include "goniometer/resolve.h"

enum { SPLIT_LEVEL = 4, AT_ONCE = 16 };
/* Of each incident cell, in each batch, to see how bright it gets. */
enum { SURVEY_PATHS = 4 };
/* Branches of all trees together: a quarter of a gigabyte, twice that while they are joined. */
enum { MOST_BRANCHES = 1 << 20 };

/* Of the peak: values whose error counts, and those that paths are sent for, since a few paths tell
 * it a little too high. */
static const double told_from = 0.01, heeded_from = 0.007;

/* A part of the incident directions that one thread measures: a cell at some level. */
struct block {
    struct orl_gonio_forest forest;
    struct orl_gonio_node *tops; /* [transmitted][cell out at that level]; owned */
    double totals[ORL_GONIO_BATCHES][2], lost;
    double peaks[2]; /* reflected, transmitted: as few paths tell them */
    uint64_t paths;
    bool short_of; /* an error was foreseen above the accuracy, for want of paths */
    int code;
};

struct trees {
    const struct orl_bsdf_make_request *request;
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    struct orl_gonio_cull cull;
    unsigned rank, levels, split; /* split: the level of blocks */
    size_t n_blocks;              /* on one side */
    uint32_t paths, paths_most;   /* in each batch */
    double from[2][2]; /* side, transmitted: values from which on errors count; with an accuracy */
    const atomic_bool *cancel;
    struct block *blocks; /* of light from the back, then from the front */
    size_t *todo, n_todo; /* their places; those that mirrors make of others are left out */
    size_t first;
    /* What they come to, by side: */
    struct orl_gonio_forest forests[2];
    struct orl_gonio_node roots[2][2];
};

/* ---- Joining --------------------------------------------------------------------------------- */

/* Cells of B at a level, of both components. */
static size_t nodes_at(unsigned level)
{
    return (size_t)2 << 2 * level;
}

/* ---- Blocks ---------------------------------------------------------------------------------- */

/* What one thread measures by. */
struct work {
    const struct trees *t;
    struct block *block;
    struct orl_gonio_probe probe;
    struct orl_gonio_node *nodes; /* of one incident cell, to be used up; with an accuracy */
    size_t side;
};

static struct orl_gonio_seen look(const struct work *w, bool transmitted, double from)
{
    const size_t cells = orl_gonio_probe_cells(&w->probe);
    return orl_gonio_resolve(w->nodes + transmitted * cells, w->t->levels, &w->t->cull, from);
}

/* Whether the cell's values will be known as well as was asked for, by twice as many paths. */
static bool is_resolved(const struct work *w, const struct orl_gonio_node *nodes)
{
    const double accuracy = sqrt(2) * w->t->request->accuracy;
    bool resolved = true;
    memcpy(w->nodes, nodes, 2 * orl_gonio_probe_cells(&w->probe) * sizeof *nodes);
    for (int k = 0; k < 2 && resolved; k++)
        resolved = look(w, k, w->t->from[w->side][k]).worst <= accuracy;
    return resolved;
}

/* Paths are doubled until as many again will tell enough. Returns how many there are in each batch;
 * less than those to begin with: cancelled. */
static uint32_t decide(struct work *w, uint32_t a, struct orl_gonio_node *nodes)
{
    const struct trees *t = w->t;
    uint32_t sent = 0, paths = t->paths;
    for (;;) {
        orl_gonio_probe_send(&w->probe, a, sent, paths);
        if (orl_is_cancelled(t->cancel))
            return 0;
        orl_gonio_probe_tell(&w->probe, paths, nodes);
        const bool resolved = is_resolved(w, nodes);
        if (resolved || 4ULL * paths > t->paths_most) {
            w->block->short_of = w->block->short_of || !resolved;
            return paths;
        }
        sent = paths;
        paths *= 2;
    }
}

/* One finest cell. */
static bool measure_cell(struct work *w, uint32_t a, struct orl_gonio_node *ret_nodes)
{
    const struct trees *t = w->t;
    uint32_t paths = t->paths, sets = 1;
    if (t->sample->file) {
        orl_gonio_read_cell(&w->probe, t->sample->file, a, ret_nodes);
        return !orl_is_cancelled(t->cancel);
    }
    if (t->request->accuracy > 0) {
        paths = decide(w, a, ret_nodes);
        orl_gonio_probe_put_aside(&w->probe, paths);
        sets = 2;
    }
    orl_gonio_probe_send(&w->probe, a, 0, paths);
    if (orl_is_cancelled(t->cancel))
        return false;
    orl_gonio_probe_tell(&w->probe, paths, ret_nodes);
    orl_gonio_probe_settle(&w->probe, paths);
    w->block->paths += (uint64_t)paths * sets * ORL_GONIO_BATCHES;
    return true;
}

/* The nodes of incident cell a at a level, from the finest cells up. */
static bool grow(struct work *w, unsigned level, uint32_t a, struct orl_gonio_node *ret_nodes)
{
    const unsigned in = orl_gonio_parts_in(w->t->rank);
    if (level == w->t->levels)
        return measure_cell(w, a, ret_nodes);
    struct orl_gonio_node *parts = malloc(in * nodes_at(level + 1) * sizeof *parts);
    bool fine = parts != NULL;
    for (unsigned k = 0; k < in && fine; k++)
        fine = grow(w, level + 1, in * a + k, parts + k * nodes_at(level + 1));
    fine =
        fine && orl_gonio_join_level(&w->block->forest, parts, nodes_at(level), level, ret_nodes);
    free(parts);
    return fine;
}

/* Mirrors take a block from another one: the one with the lesser place. */
static size_t original_of(const struct trees *t, size_t block, unsigned *ret_mirror)
{
    size_t a = block;
    *ret_mirror = 0;
    if (t->rank == 3 || t->split == 0)
        return block;
    for (unsigned axis = 0; axis < 2; axis++) { /* the top bit of x, then of y */
        if (!(t->request->symmetry >> axis & 1) || !(a >> (2 * (t->split - 1) + axis) & 1))
            continue;
        for (unsigned level = 0; level < t->split; level++)
            a ^= (size_t)1 << (2 * level + axis);
        *ret_mirror |= 5U << axis; /* of A and of B */
    }
    return a;
}

static int open_work(const struct trees *t, size_t place, struct work *w)
{
    *w = (struct work){.t = t, .block = &t->blocks[place], .side = place / t->n_blocks};
    w->probe = (struct orl_gonio_probe){.sample = t->sample,
                                        .sobol = t->sobol,
                                        .seed = t->request->seed,
                                        .rank = t->rank,
                                        .levels = t->levels,
                                        .front = w->side == 1,
                                        .cancel = t->cancel};
    w->nodes = malloc(2 * orl_gonio_probe_cells(&w->probe) * sizeof *w->nodes);
    return w->nodes ? orl_gonio_probe_init(&w->probe, NULL) : ORL_ERR_NOMEM;
}

static void close_work(struct work *w)
{
    orl_gonio_probe_done(&w->probe);
    free(w->nodes);
}

/* How bright cells out get, by a few paths into every incident cell of a block. */
static void survey_block(void *arg, size_t index, uint32_t member)
{
    const struct trees *t = arg;
    const size_t place = t->todo[t->first + index];
    const unsigned below = (t->rank == 4 ? 2 : 1) * (t->levels - t->split);
    const uint32_t first = (uint32_t)(place % t->n_blocks) << below;
    struct work w;
    (void)member;
    w.block = &t->blocks[place];
    w.block->code = open_work(t, place, &w);
    for (uint32_t a = first; w.block->code == 0 && a < first + (1U << below); a++) {
        orl_gonio_probe_send(&w.probe, a, 0, SURVEY_PATHS);
        orl_gonio_probe_tell(&w.probe, SURVEY_PATHS, w.nodes);
        orl_gonio_probe_drop(&w.probe);
        for (int k = 0; k < 2; k++)
            w.block->peaks[k] = fmax(w.block->peaks[k], look(&w, k, 0).peak);
    }
    close_work(&w);
}

static void measure_block(void *arg, size_t index, uint32_t member)
{
    const struct trees *t = arg;
    const size_t place = t->todo[t->first + index];
    struct block *block = &t->blocks[place];
    struct work w;
    (void)member;
    block->forest = (struct orl_gonio_forest){.rank = t->rank, .cull = t->cull};
    block->tops = malloc(nodes_at(t->split) * sizeof *block->tops);
    block->code = open_work(t, place, &w);
    if (block->code == 0 &&
        (!block->tops || !grow(&w, t->split, (uint32_t)(place % t->n_blocks), block->tops)))
        block->code = ORL_ERR_NOMEM;
    memcpy(block->totals, w.probe.totals, sizeof block->totals);
    block->lost = w.probe.lost;
    close_work(&w);
}

/* By pieces; of the whole they go from one share to another. */
static int for_blocks(struct trees *t, const struct orl_bsdf_make_env *env, orl_crew_body body,
                      double share_from, double share_to)
{
    size_t branches = 0;
    if (env->progress)
        env->progress(env->ctx, 1, share_from);
    for (t->first = 0; t->first < t->n_todo; t->first += AT_ONCE) {
        const size_t count = t->n_todo - t->first < AT_ONCE ? t->n_todo - t->first : AT_ONCE;
        const int code = orl_crew_try(env->crew, count, body, t);
        if (code < 0 || orl_is_cancelled(env->cancel))
            return ORL_ERR_CANCELLED;
        for (size_t i = t->first; i < t->first + count; i++) {
            const struct block *block = &t->blocks[t->todo[i]];
            if (block->code < 0)
                return block->code;
            branches += block->forest.count;
        }
        if (branches > MOST_BRANCHES)
            return ORL_ERR_LIMIT;
        if (env->progress)
            env->progress(env->ctx, 1,
                          share_from + (share_to - share_from) * (double)(t->first + count) /
                                           (double)t->n_todo);
    }
    return 0;
}

static int measure(struct trees *t, const struct orl_bsdf_make_env *env)
{
    const double part = 0.05; /* that the survey is of the whole, more or less */
    if (!(t->request->accuracy > 0))
        return for_blocks(t, env, measure_block, 0, 1);
    const int code = for_blocks(t, env, survey_block, 0, part);
    for (size_t i = 0; i < t->n_todo; i++)
        for (int k = 0; k < 2; k++) {
            double *from = &t->from[t->todo[i] / t->n_blocks][k];
            *from = fmax(*from, heeded_from * t->blocks[t->todo[i]].peaks[k]);
        }
    return code < 0 ? code : for_blocks(t, env, measure_block, part, 1);
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* Mirrored cells of B at a level, by the bits of a child's mirror. */
static size_t mirrored_cell(size_t cell, unsigned level, unsigned mirror)
{
    for (unsigned l = 0; l < level; l++)
        cell ^= (size_t)(mirror & 3) << 2 * l;
    return cell;
}

/* The nodes of a block, in the side's forest. Original or mirrored. */
static bool plant(const struct trees *t, struct orl_gonio_forest *forest, size_t side, size_t a,
                  struct orl_gonio_node *ret_nodes)
{
    unsigned mirror;
    const struct block *block = &t->blocks[side * t->n_blocks + original_of(t, a, &mirror)];
    const size_t cells = nodes_at(t->split) / 2;
    uint32_t shift;
    if (!orl_gonio_forest_take(forest, &block->forest, mirror, &shift))
        return false;
    for (size_t i = 0; i < 2 * cells; i++) {
        const size_t from = i / cells * cells + mirrored_cell(i % cells, t->split, mirror);
        ret_nodes[i] = orl_gonio_shifted(block->tops[from], shift);
    }
    return true;
}

/* The nodes of incident cell a at a level above the blocks. Of rank 3 the upper half of A is of no
 * direction: it is as the lower one. */
static bool gather(const struct trees *t, struct orl_gonio_forest *forest, size_t side,
                   unsigned level, size_t a, struct orl_gonio_node *ret_nodes)
{
    const unsigned in = orl_gonio_parts_in(t->rank);
    if (level == t->split)
        return plant(t, forest, side, a, ret_nodes);
    const size_t count = nodes_at(level + 1);
    struct orl_gonio_node *parts = malloc(in * count * sizeof *parts);
    bool fine = parts != NULL;
    for (unsigned k = 0; k < in && fine; k++) {
        if (t->rank == 3 && level == 0 && k == 1)
            memcpy(parts + count, parts, count * sizeof *parts);
        else
            fine = gather(t, forest, side, level + 1, in * a + k, parts + k * count);
    }
    fine = fine && orl_gonio_join_level(forest, parts, nodes_at(level), level, ret_nodes);
    free(parts);
    return fine;
}

static int join_all(struct trees *t)
{
    for (size_t side = 0; side < 2; side++) {
        t->forests[side] = (struct orl_gonio_forest){.rank = t->rank, .cull = t->cull};
        if (!gather(t, &t->forests[side], side, 0, 0, t->roots[side]))
            return ORL_ERR_NOMEM;
    }
    return 0;
}

/* ---- What is told ---------------------------------------------------------------------------- */

/* Light from a side evenly: cells of A weigh alike in rank 4, rings by their size in rank 3. */
static struct orl_bsdf_share diffuse_of(const struct trees *t, size_t side, bool transmitted)
{
    double values[ORL_GONIO_BATCHES] = {0};
    unsigned mirror;
    for (size_t a = 0; a < t->n_blocks; a++) {
        const struct block *b = &t->blocks[side * t->n_blocks + original_of(t, a, &mirror)];
        const double n = (double)t->n_blocks;
        const double weight =
            t->rank == 4 ? ldexp(1, -2 * (int)t->levels) : (2 * (n - (double)a) - 1) / (n * n);
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            values[k] += weight * b->totals[k][transmitted];
    }
    return orl_gonio_share_of(values);
}

static void tell(const struct trees *t, struct orl_bsdf_made *made)
{
    double lost = 0;
    struct orl_gonio_worst worst = {0, 0};
    made->reached = true;
    for (size_t side = 0; side < 2; side++)
        for (size_t k = 0; k < 2; k++) {
            const struct orl_gonio_forest *forest = &t->forests[side];
            const struct orl_gonio_node root = t->roots[side][k];
            const double from = told_from * orl_gonio_forest_peak(forest, root);
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

static void write_as(const struct trees *t, enum orl_bsdf_part part, bool errors, FILE *out)
{
    for (size_t side = 0; side < 2; side++)
        for (size_t k = 0; k < 2; k++)
            if (orl_gonio_part_of[side][k] == part)
                orl_gonio_forest_write(&t->forests[side], t->roots[side][k], errors, out);
}

static void write_part(void *ctx, enum orl_bsdf_part part, FILE *out)
{
    write_as(ctx, part, false, out);
}

static void write_errors(void *ctx, enum orl_bsdf_part part, FILE *out)
{
    write_as(ctx, part, true, out);
}

static void done(struct trees *t)
{
    for (size_t i = 0; t->blocks && i < 2 * t->n_blocks; i++) {
        orl_gonio_forest_done(&t->blocks[i].forest);
        free(t->blocks[i].tops);
    }
    free(t->blocks);
    free(t->todo);
    orl_gonio_forest_done(&t->forests[0]);
    orl_gonio_forest_done(&t->forests[1]);
}

static struct trees trees_of(const struct orl_bsdf_make_request *request,
                             const struct orl_bsdf_make_env *env,
                             const struct orl_gonio_sample *sample, const struct orl_sobol *sobol)
{
    struct trees t = {.request = request,
                      .cull = {request->cull, request->unseen},
                      .sample = sample,
                      .sobol = sobol,
                      .levels = 1,
                      .paths_most = request->paths_most / ORL_GONIO_BATCHES,
                      .cancel = env->cancel};
    t.rank = request->basis == ORL_BSDF_TENSOR_TREE_4 ? 4 : 3;
    while (1U << t.levels < request->resolution)
        t.levels++;
    /* Of rank 3 every ring is a block, and half of A is none. */
    t.split = t.rank == 3 ? t.levels : t.levels < SPLIT_LEVEL ? t.levels : SPLIT_LEVEL;
    t.n_blocks = t.rank == 3 ? (size_t)1 << (t.levels - 1) : (size_t)1 << 2 * t.split;
    const uint32_t sets = request->accuracy > 0 ? 2 * ORL_GONIO_BATCHES : ORL_GONIO_BATCHES;
    t.paths = (orl_bsdf_make_paths(request) + sets - 1) / sets;
    t.blocks = calloc(2 * t.n_blocks, sizeof *t.blocks);
    t.todo = calloc(2 * t.n_blocks, sizeof *t.todo);
    for (size_t i = 0; t.todo && i < 2 * t.n_blocks; i++) {
        unsigned mirror;
        if (original_of(&t, i % t.n_blocks, &mirror) == i % t.n_blocks)
            t.todo[t.n_todo++] = i;
    }
    return t;
}

static int fail(int code, struct orl_error *err)
{
    if (code == ORL_ERR_LIMIT) {
        orl_error_set(err, code, "the panel's trees have more than %d branches", MOST_BRANCHES);
        orl_error_hint(err,
                       "Ask for a lower resolution, a larger cull, or more paths: what is noise "
                       "of single cells then is none of those joined");
        return code;
    }
    return orl_error_set(
        err, code, code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory for the panel's BSDF");
}

int orl_gonio_make_trees(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err)
{
    struct trees t = trees_of(request, env, sample, sobol);
    struct orl_document document = {.structure =
                                        t.rank == 4 ? ORL_STRUCTURE_TREE4 : ORL_STRUCTURE_TREE3};
    int code = t.blocks && t.todo ? measure(&t, env) : ORL_ERR_NOMEM;
    if (code == 0)
        code = join_all(&t);
    if (code == 0) {
        tell(&t, made);
        for (int part = 0; part < ORL_PART_COUNT; part++)
            document.parts[part].present = true;
        code = orl_gonio_write(&document, write_part, &t, sample, request, made);
        if (code == 0 && request->tell_errors)
            code = orl_gonio_write_errors(&document, write_errors, &t, sample, request, made);
    }
    done(&t);
    return code < 0 ? fail(code, err) : 0;
}

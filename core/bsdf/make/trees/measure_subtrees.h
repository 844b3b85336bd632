/*
 * Measurement of a panel's trees: one finest incident cell (probe.c), the subtree that one thread
 * measures (subtree.c), and all subtrees in parallel (measure_subtrees.c).
 */
#ifndef ORL_BSDF_MAKE_TREES_MEASURE_SUBTREES_H
#define ORL_BSDF_MAKE_TREES_MEASURE_SUBTREES_H

#include "bsdf/make/panel/panel.h"
#include "bsdf/make/trees/tree_builder.h"

/*
 * Measures light from one finest cell of a tensor tree's incident directions, counted by the finest
 * cells of directions out. Cells of a square are numbered by the interleaved bits of x and y, as in
 * trees: coarsest bits highest, each bit of x below that of y.
 */

struct orl_gonio_probe {
    const struct orl_gonio_measurement *measurement;
    unsigned rank, levels; /* there are 2^levels cells a side */
    bool color;            /* true to count red, green and blue beside luma */
    bool front;            /* true if light comes from the front */
    /* Counts of one incident cell, by planes: luma, then the three of colour. The arrays are
     * owned. */
    double *sums;  /* [plane][batch][transmitted][cell out] */
    double *pilot; /* [plane][transmitted][cell out]: sum of all pilot batches */
    double pilot_totals[ORL_GONIO_BATCHES][2]; /* pilot's weights, summed over cells */
    float *max_weight;    /* [transmitted][cell out]: largest luma of a single path */
    uint32_t pilot_paths; /* paths in each batch of the pilot */
    double totals[ORL_GONIO_BATCHES][2]; /* shares, summed over all incident cells */
    double lost;
};

static inline size_t orl_gonio_probe_cells(const struct orl_gonio_probe *probe)
{
    return (size_t)1 << 2 * probe->levels;
}

/* Returns a direction of travel for incident cell a, z > 0; in rank 3 at the azimuth given by
 * u[1]. */
struct orl_vec3 orl_gonio_probe_direction(const struct orl_gonio_probe *probe, uint32_t a,
                                          const double u[2]);

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err);
void orl_gonio_probe_done(struct orl_gonio_probe *probe);

/* Sends paths `from` to `to` of each batch into incident cell a: a cell of the square in rank 4, a
 * ring in rank 3. If cancelled, only some are sent. */
void orl_gonio_probe_trace(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to);
/* Ends the pilot after `paths` paths of each batch. New batches use other random numbers, and only
 * they give the errors of values (as in exit_histogram.h). */
void orl_gonio_probe_end_pilot(struct orl_gonio_probe *probe, uint32_t paths);
/* Fills ret_cells[transmitted * cells + cell out] with leaves, after `paths` paths of each
 * batch. */
void orl_gonio_probe_estimate(const struct orl_gonio_probe *probe, uint32_t paths,
                              struct orl_gonio_cells ret_cells);
/* orl_gonio_probe_finish_cell adds the sums to the totals, orl_gonio_probe_clear discards them.
 * Both prepare the probe for another cell. */
void orl_gonio_probe_finish_cell(struct orl_gonio_probe *probe, uint32_t paths);
void orl_gonio_probe_clear(struct orl_gonio_probe *probe);

/*
 * Subtree of a tree's incident directions that one thread measures: a cell at some level, with all
 * cells below it. Subtrees of a distributed BSDF are sent between machines in serialised form.
 */

struct orl_gonio_subtree {
    struct orl_gonio_builder builder;
    struct orl_gonio_cells
        top_nodes; /* [transmitted][cell out at that level]; owned; NULL at first */
    double totals[ORL_GONIO_BATCHES][2], lost;
    double peaks[2]; /* 1/sr; reflected, transmitted: estimates from a few paths */
    uint64_t paths;
    bool not_converged; /* true if an error was predicted above the accuracy at the most paths */
    int code;
};
void orl_gonio_subtree_done(struct orl_gonio_subtree *subtree);

/* Returns the serialised size of a subtree with n_top_nodes top nodes, or with none if it is not
 * measured. */
size_t orl_gonio_subtree_bytes(const struct orl_gonio_subtree *subtree, size_t n_top_nodes);
/* Serialises a subtree. Returns the position after it. */
char *orl_gonio_subtree_pack(const struct orl_gonio_subtree *subtree, size_t n_top_nodes, char *to);
/* Reads a subtree from at most `most` bytes. Returns the position after it, or NULL if its shape
 * differs or memory is out. The builder's rank, cull and color must be set before. */
const char *orl_gonio_subtree_unpack(struct orl_gonio_subtree *subtree, size_t n_top_nodes,
                                     const char *from, size_t most);

/*
 * Measures the subtrees of a panel's trees in parallel, here or on other machines if the BSDF is
 * distributed (oriel/bsdf/bsdf_store.h). With an accuracy, a survey of the subtrees comes first.
 */

struct orl_gonio_trees {
    const struct orl_gonio_measurement *measurement;
    const struct orl_bsdf_make_request *request; /* of the measurement, like sample */
    const struct orl_gonio_sample *sample;
    struct orl_gonio_cull cull;
    struct orl_gonio_split of;  /* n_subtrees: those on one side */
    uint32_t paths, paths_most; /* paths in each batch */
    double from[2][2]; /* [side][transmitted]: least values whose errors count; with an accuracy */
    struct orl_gonio_subtree *subtrees; /* subtrees for light from the back, then from the front */
    size_t *todo, n_todo;               /* subtrees to measure, by index; no mirror images */
    size_t first;
    /* Results, by side: */
    struct orl_gonio_builder builders[2];
    struct orl_gonio_node roots[2][2];
    struct orl_gonio_color root_hues[2][2]; /* set if the request has colour */
    bool writes_errors;                     /* true while the document of errors is written */
};

/* Returns an empty builder. */
static inline struct orl_gonio_builder orl_gonio_empty_builder(const struct orl_gonio_trees *t)
{
    return (struct orl_gonio_builder){
        .rank = t->of.rank, .cull = t->cull, .color = t->request->color};
}

/* Returns the number of cells of B at a level, for both components. */
static inline size_t orl_gonio_nodes_at(unsigned level)
{
    return (size_t)2 << 2 * level;
}

/* Returns the subtree of which this one is a mirror image: the one with the lower index. */
size_t orl_gonio_original_of(const struct orl_gonio_trees *t, size_t subtree, unsigned *ret_mirror);

/* Measures all subtrees in todo. Returns 0 or a negative enum orl_err. */
int orl_gonio_measure_subtrees(struct orl_gonio_trees *t, struct orl_error *err);

/* Sets the error message of a code; returns the code. */
int orl_gonio_trees_fail(const struct orl_gonio_trees *t, int code, struct orl_error *err);

#endif

/*
 * Virtual goniophotometer: computes the BSDF of a panel made of geometry and materials, as XML.
 *
 * The panel lies in the xy plane, y up, z towards the inside, as in Radiance's genBSDF. It is
 * infinite and periodic in x and y: one cell of it, by default the box around all surfaces, stands
 * for the whole. A ray that leaves the cell at one side re-enters at the opposite side. Parts of
 * surfaces outside a given cell are cut off.
 *
 * Light is sent onto the cell from every incident direction of the basis, distributed evenly over
 * the directions of each basis cell and over the panel's cell. The materials (scene/material)
 * scatter it until it leaves, and it is counted by its outgoing direction. A value is thus the
 * unbiased mean of the panel's BSDF over a pair of basis cells. Its standard error comes from
 * independent batches.
 *
 * Suns, skies and emitting surfaces are rejected as no part of a panel. No files are written; the
 * XML is returned as text. The same request gives the same bytes for any number of threads.
 */
#ifndef ORIEL_BSDF_BSDF_MAKE_H
#define ORIEL_BSDF_BSDF_MAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>
#include <oriel/base/thread_pool.h>

enum orl_bsdf_basis {
    ORL_BSDF_KLEMS_FULL,    /* 145 directions per hemisphere */
    ORL_BSDF_KLEMS_HALF,    /* 77 */
    ORL_BSDF_KLEMS_QUARTER, /* 41 */
    ORL_BSDF_TENSOR_TREE_3, /* isotropic: the mean over all rotations about the axis */
    ORL_BSDF_TENSOR_TREE_4,
    ORL_BSDF_BASES,
};

/* Returns "klems_full" and so on; NULL for an invalid value. */
const char *orl_bsdf_basis_name(enum orl_bsdf_basis basis);
static inline bool orl_bsdf_basis_is_tree(enum orl_bsdf_basis basis)
{
    return basis == ORL_BSDF_TENSOR_TREE_3 || basis == ORL_BSDF_TENSOR_TREE_4;
}

/* Mirror symmetries of the panel, under which both halves of the result are made equal. Matrices
 * are averaged; for trees of rank 4 only one half is measured. Trees of rank 3 support none. Auto,
 * for trees of rank 4: mirrors through the cell's middle that are detected in its surfaces, if all
 * of their materials are uniform and scatter by the normal alone (bsdf/make/panel/panel.h). Auto,
 * otherwise: none. */
enum orl_bsdf_symmetry {
    ORL_BSDF_ASYMMETRIC = 0,
    ORL_BSDF_LEFT_RIGHT = 1, /* x */
    ORL_BSDF_UP_DOWN = 2,    /* y */
    ORL_BSDF_QUADRILATERAL = 3,
    ORL_BSDF_SYMMETRY_AUTO = 4,
};

enum {
    ORL_BSDF_MAKE_BATCHES = 16,
    ORL_BSDF_MAKE_PATHS_LEAST = ORL_BSDF_MAKE_BATCHES,
    ORL_BSDF_MAKE_PATHS_MOST = 1 << 24
};

/* Share of the incident light that a tree cell may redirect unnoticed. If all 4096 cells of 64 by
 * 64 are as wrong as allowed, the sum is 0.8 % of the light. */
#define ORL_BSDF_CULL_FRACTION 2e-6

struct orl_bsdf_make_request {
    char **files; /* scene texts, in order; owned */
    size_t n_files;
    char *name; /* material name; NULL: that of the first file. Owned */
    enum orl_bsdf_basis basis;
    enum orl_bsdf_symmetry symmetry;
    bool color;     /* true: also X and Z beside Y, or u' and v' for trees; errors are for Y */
    bool has_cell;  /* true: use cell; false: the box around the panel */
    double cell[4]; /* x from, x to, y from, y to, in the files' coordinates */
    /* Trees only: cells per side of the square, a power of two from 4 to 128. */
    uint32_t resolution;
    double cull; /* trees only: cells are merged if they are within this share of their mean, 0..1,
                    or within their errors (bsdf/make/trees/tree_builder.h); colours too */
    double cull_fraction; /* or if merging redirects no more than this share of the light */
    uint32_t paths; /* paths per incident direction; with an accuracy, the initial number; 0: by the
                       basis (orl_bsdf_make_paths) */
    /*
     * Requested relative standard error; 0: none. It applies to every value of at least a hundredth
     * of the largest of its component. Paths are doubled for incident directions that need it. If
     * one direction would exceed paths_most, the accuracy is given up:
     * orl_bsdf_make_result.reached. In trees, a value that covers several finest cells counts with
     * the error of a quarter of it, which the next subdivision would show
     * (bsdf/make/trees/measure_subtrees.h).
     *
     * Half of the paths decide whether all of them are enough. The other half is independent of the
     * first and gives the stated errors (bsdf/make/klems/exit_histogram.h). So among thousands of
     * values some errors exceed the request by chance, by up to a factor of two. The accuracy is a
     * standard error over the paths that were drawn, not a bound. Among tens of thousands of values
     * the worst is off by four standard errors (the office's panel 64 by 64: 7.7 % for 0.02, 1.5 %
     * for 0.005). Errors do not include light that no path has found.
     */
    double accuracy;
    uint32_t paths_most;
    uint64_t seed;
    bool want_errors; /* true: fill orl_bsdf_make_result.errors_xml */
};

/* Sets defaults: Klems full, seed 1, symmetry auto; for trees a resolution of 64, a cull of
 * 0.05. */
void orl_bsdf_make_request_init(struct orl_bsdf_make_request *request);
void orl_bsdf_make_request_done(struct orl_bsdf_make_request *request);

/* Returns the number of paths of the request, or the default of its basis: 16384 for matrices,
 * 32768 for trees of rank 3, and 4096 for trees of rank 4. For trees with an accuracy it is
 * 2048. */
uint32_t orl_bsdf_make_paths(const struct orl_bsdf_make_request *request);

/* Returns a rough estimate of the single-core seconds, without knowledge of the panel. With an
 * accuracy it covers the initial paths only. */
double orl_bsdf_make_core_s(const struct orl_bsdf_make_request *request);

/* Checks a request without its files. Returns 0, ORL_ERR_INVALID or ORL_ERR_RANGE. */
int orl_bsdf_make_validate(const struct orl_bsdf_make_request *request, struct orl_error *err);

/* Independent tasks of one BSDF. Results are exchanged as bytes. */
struct orl_bsdf_tasks {
    const char *name; /* unique within the BSDF */
    size_t n;
    void *ctx;
    double (*core_s)(void *ctx, size_t task); /* estimated single-core seconds of a task */
    /* Computes a task and keeps the result. *ret_data, allocated by malloc, is the copy for other
     * processes; its size is a multiple of 4. */
    int (*make)(void *ctx, size_t task, void **ret_data, size_t *ret_size, struct orl_error *err);
    /* Reads the result that another process has computed. *ret_taken: false if the data are
     * invalid. */
    int (*take)(void *ctx, size_t task, const void *data, size_t size, bool *ret_taken,
                struct orl_error *err);
    /* Share of the tasks that other processes have completed. */
    void (*told)(void *ctx, double share);
};

/* Computes all tasks here or fetches their results (oriel/bsdf/bsdf_store.h). */
struct orl_bsdf_distributor {
    void *ctx;
    int (*run)(void *ctx, const struct orl_bsdf_tasks *tasks, struct orl_error *err);
};

struct orl_bsdf_make_env {
    const struct orl_files *files; /* borrowed */
    struct orl_thread_pool *pool;  /* borrowed; the calling thread leads it */
    const atomic_bool *cancel;     /* borrowed; may be NULL */
    /* Called by the lead thread from time to time with the completed share, which never falls; with
     * an accuracy it is the share of the round. May be NULL. */
    void (*progress)(void *ctx, uint32_t round, double fraction);
    void *ctx;
    /* Borrowed: distributes the paths of incident directions over processes; the BSDF is the same.
     * NULL: one process. Not used by fitting and conversion. */
    const struct orl_bsdf_distributor *shared;
};

/* Share of light, with its standard error. */
struct orl_bsdf_share {
    double value, error;
};

/* Shares for one incident direction. Index 1 is light from the front (inside), 0 from the back;
 * then reflected, transmitted. */
struct orl_bsdf_make_direction {
    double theta_deg, phi_deg; /* middle of the cell that the light comes from */
    struct orl_bsdf_share shares[2][2];
};

struct orl_bsdf_make_result {
    char *xml; /* owned, NUL-terminated */
    size_t xml_size;
    /* Copy of xml with standard errors in place of values, 1/sr, for inspection and plots; NULL
     * unless requested. For merged tree cells the error includes their rms deviation from the mean.
     * Owned. */
    char *errors_xml;
    size_t errors_xml_size;
    size_t n_directions;                        /* for a matrix; 0 for trees */
    struct orl_bsdf_make_direction *directions; /* owned */
    struct orl_bsdf_share diffuse[2][2];        /* for perfectly diffuse light */
    float *errors[2][2]; /* standard errors, 1/sr, corrected for one path more or less: [direction
                            in][direction out]; owned; NULL for trees */
    double worst;        /* largest relative error of a value, in the sense of accuracy */
    double merge_error; /* trees only: largest relative rms deviation of the finest cells from their
                      merged value, beyond what errors explain */
    bool reached; /* true: the accuracy was reached on the deciding paths, or none was requested */
    uint64_t paths;
    double lost;              /* share of the light that was given up inside the panel */
    double cell[4], depth[2]; /* the files' coordinates; depth: z from, to */
};

/*
 * Computes the BSDF. Returns 0 and a result that the caller frees by orl_bsdf_make_result_done.
 * Otherwise returns the error of reading the scene, ORL_ERR_INVALID (no panel), ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED.
 */
int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_make_result *ret_result, struct orl_error *err);
void orl_bsdf_make_result_done(struct orl_bsdf_make_result *result);

#endif

/* Parts of a fit: the raster of directions out, the model of one component, and the writers of
 * models. */
#ifndef ORL_BSDF_FIT_FIT_H
#define ORL_BSDF_FIT_FIT_H

#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/fit/transport/transport.h"
#include "bsdf/matrix/matrix.h"

/*
 * Raster of directions out: the cells of a tensor tree's square. Each cell has sample points of
 * equal projected solid angle.
 *
 * A Gaussian is spread over the points around it by (1 - d^2 / 12 sigma^2)^4. This kernel is nearly
 * the Gaussian of that width, but has a finite radius. Light below the horizon is reflected up, so
 * that uniform light remains uniform to the edge. Weights are scaled so that the sum is exactly the
 * Gaussian's light.
 *
 * A raster is immutable once made; each thread has its own accumulator. Ownership: the caller's.
 */

struct orl_fit_sphere {
    float x, y, z, radius;
};

struct orl_fit_raster {
    unsigned levels; /* there are 2^levels cells a side, numbered in Morton order */
    size_t n_cells, n_tiles;
    double area;      /* projected solid angle of a cell, sr */
    float *x, *y, *z; /* sample points, sixteen to a cell; owned, like all pointers below */
    struct orl_fit_sphere *tiles, *groups; /* bounding spheres of four cells, of 16 tiles */
    double spacing;                        /* distance of sample points, projected */
};

enum { ORL_FIT_TILE_CELLS = 4, ORL_FIT_CELL_POINTS = 16 };

/* levels: at least 1. Returns 0 or ORL_ERR_NOMEM. */
int orl_fit_raster_make(unsigned levels, struct orl_fit_raster *ret_raster, struct orl_error *err);
void orl_fit_raster_done(struct orl_fit_raster *raster);

struct orl_fit_accumulator {
    float (*accumulated)[ORL_FIT_TILE_CELLS]; /* [tile reached][cell of it]: kernel sums of a
                                                 Gaussian */
    uint32_t *tiles;                          /* numbers of these tiles */
    double *value;                            /* by cell: the result, 1/sr */
};
bool orl_fit_accumulator_make(const struct orl_fit_raster *raster,
                              struct orl_fit_accumulator *ret_accumulator);
void orl_fit_accumulator_done(struct orl_fit_accumulator *accumulator);

/* Sets the accumulator's values to the light. blur_rad is added to all widths in quadrature. */
void orl_fit_rasterize(const struct orl_fit_raster *raster, const struct orl_fit_light *light,
                       double blur_rad, struct orl_fit_accumulator *accumulator);

/*
 * Model of one component (light from the front or the back, reflected or transmitted) for any
 * incident direction: shapes of all scans, their mirror images, the mesh of them, and the transport
 * plans that are needed.
 *
 * Ownership: the caller's, freed by orl_fit_model_done. Once made, it may be read by many threads.
 */

struct orl_fit_model {
    bool front, transmitted;
    enum orl_bsdf_fit_symmetry symmetry;
    struct orl_fit_shape *shapes; /* own ones, then images; owned */
    size_t n_own, n;
    uint32_t *image_of; /* by shape: its original; owned */
    struct orl_fit_mesh mesh;
    struct orl_fit_plans plans;
};

/* Takes ownership of the shapes, even on failure. Returns 0, ORL_ERR_INVALID or ORL_ERR_NOMEM. */
int orl_fit_model_make(struct orl_fit_shape *shapes, size_t n, enum orl_bsdf_fit_symmetry symmetry,
                       struct orl_fit_model *ret_model, struct orl_error *err);
void orl_fit_model_done(struct orl_fit_model *model);

/* Sets the mirrors (of orl_fit_shape_mirror) of a symmetry, without the identity; returns their
 * number. */
size_t orl_fit_mirrors(enum orl_bsdf_fit_symmetry symmetry, unsigned ret_mirrors[3]);

/* Leaves out one direction at a time, if others surround it, and sets the errors in scans. scans:
 * in the order of the model's own shapes. */
int orl_fit_leave_one_out(const struct orl_fit_model *model, const struct orl_bsdf_make_env *env,
                          struct orl_bsdf_fit_scan *scans, struct orl_error *err);

/* ---- Models in the cells of a basis, and their XML ------------------------------------------- */

/* Indexed by [from the front][transmitted]; NULL: no such component. */
struct orl_fit_models {
    struct orl_fit_model *of[2][2];
};

/* Sample directions per incident cell along each axis; wide rings have more. */
enum { ORL_FIT_CELL_SAMPLES = 2 };

/* Share of all work that is complete when components begin; these divide the rest among them. */
static const double orl_fit_prepared_share = 0.4;

/* Write the models in a basis: set result->xml and result->diffuse. Return 0 or a negative enum
 * orl_err. */
int orl_fit_write_trees(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err);
int orl_fit_write_klems(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err);

/* Writes the document with comments on how it was made. */
struct orl_document;
struct orl_bsdf_labels;
int orl_fit_write_xml(struct orl_document *document, const struct orl_bsdf_labels *data,
                      const struct orl_bsdf_fit_request *request,
                      struct orl_bsdf_fit_result *result, struct orl_error *err);

#endif

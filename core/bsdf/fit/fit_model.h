/*
 * Model of one component (light from the front or the back, reflected or transmitted) for any
 * incident direction: shapes of all scans, their mirror images, the mesh of them, and the transport
 * plans that are needed.
 *
 * Ownership: the caller's, freed by orl_fit_model_done. Once made, it may be read by many threads.
 */
#ifndef ORL_BSDF_FIT_FIT_MODEL_H
#define ORL_BSDF_FIT_FIT_MODEL_H

#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/fit/raster.h"
#include "bsdf/fit/transport/interpolate.h"

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

#endif

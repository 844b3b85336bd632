/*
 * All scans of one component (light from the front or the back, reflected or transmitted) made
 * ready to be asked for any incident direction: shapes, their mirror images, the mesh of them, and
 * the plans between those that are needed.
 *
 * Ownership: the caller's, orl_fit_model_done. Many threads may ask once it is made.
 */
#ifndef ORL_FIT_MODEL_H
#define ORL_FIT_MODEL_H

#include <oriel/bsdf_fit.h>

#include "fit/blend.h"
#include "fit/screen.h"

struct orl_fit_model {
    bool front, transmitted;
    enum orl_bsdf_fit_symmetry symmetry;
    struct orl_fit_shape *shapes; /* own ones, then images; owned */
    size_t n_own, n;
    uint32_t *image_of; /* by shape; owned */
    struct orl_fit_mesh mesh;
    struct orl_fit_plans plans;
};

/* Takes over the shapes, also when it fails. */
int orl_fit_model_make(struct orl_fit_shape *shapes, size_t n, enum orl_bsdf_fit_symmetry symmetry,
                       struct orl_fit_model *ret_model, struct orl_error *err);
void orl_fit_model_done(struct orl_fit_model *model);

/* The mirrors (of orl_fit_shape_mirror) that a symmetry has beside none: so many in the list. */
size_t orl_fit_mirrors(enum orl_bsdf_fit_symmetry symmetry, unsigned ret_mirrors[3]);

/* Leaves every direction out that has others around it, one at a time, and sets what scans say of
 * it. scans: in the order of the model's own shapes. */
int orl_fit_leave_out(const struct orl_fit_model *model, const struct orl_bsdf_make_env *env,
                      struct orl_bsdf_fitted_scan *scans, struct orl_error *err);

#endif

/*
 * The measured sample: a panel read from scene texts, with its unit cell, or a BSDF's file
 * (resample_bsdf.h). Immutable once loaded, shared by all threads.
 */
#ifndef ORL_BSDF_MAKE_PANEL_PANEL_SAMPLE_H
#define ORL_BSDF_MAKE_PANEL_PANEL_SAMPLE_H

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_make.h>

#include "bsdf/make/panel/unit_cell.h"

struct orl_gonio_sample {
    /* A BSDF's file, borrowed; NULL: the sample is a panel. With a file only source and depth are
     * set. */
    const struct orl_bsdf *file;
    const char *source;              /* description of the file; borrowed */
    struct orl_lit_scene *lit_scene; /* owned; without lights */
    struct orl_gonio_unit_cell cell;
    double sides[4], depth[2]; /* extents of the cell without margins, in the files' coordinates */
};

/* Loads a panel; errors as for orl_bsdf_make. */
int orl_gonio_sample_load(const struct orl_bsdf_make_request *request,
                          const struct orl_bsdf_make_env *env, struct orl_gonio_sample *ret_sample,
                          struct orl_error *err);
void orl_gonio_sample_done(struct orl_gonio_sample *sample);

#endif

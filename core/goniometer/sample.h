/*
 * The measured sample: a panel read from scene texts, with its unit cell, or a BSDF's file
 * (reading.h). Immutable once loaded, shared by all threads.
 */
#ifndef ORL_GONIOMETER_SAMPLE_H
#define ORL_GONIOMETER_SAMPLE_H

#include <oriel/bsdf.h>
#include <oriel/bsdf_make.h>

#include "goniometer/cell.h"

struct orl_gonio_sample {
    /* A BSDF's file, borrowed; NULL: the sample is a panel. With a file only source and depth are
     * set. */
    const struct orl_bsdf *file;
    const char *source;      /* description of the file; borrowed */
    struct orl_world *world; /* owned; without lights */
    struct orl_gonio_cell cell;
    double sides[4], depth[2]; /* extents of the cell without margins, in the files' coordinates */
};

/* Loads a panel; errors as for orl_bsdf_make. */
int orl_gonio_sample_load(const struct orl_bsdf_make_request *request,
                          const struct orl_bsdf_make_env *env, struct orl_gonio_sample *ret_sample,
                          struct orl_error *err);
void orl_gonio_sample_done(struct orl_gonio_sample *sample);

#endif

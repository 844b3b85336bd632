/*
 * What lies on the goniophotometer's table: a panel read from scene texts, with its cell, or a
 * BSDF's file (reading.h). Immutable once loaded, shared by all threads.
 */
#ifndef ORL_GONIOMETER_SAMPLE_H
#define ORL_GONIOMETER_SAMPLE_H

#include <oriel/bsdf.h>
#include <oriel/bsdf_make.h>

#include "goniometer/cell.h"

struct orl_gonio_sample {
    const struct orl_bsdf *file; /* borrowed; NULL: a panel. Else nothing but depth and source */
    const char *source;          /* what that is, in words; borrowed */
    struct orl_world *world;     /* owned; it has no lights */
    struct orl_gonio_cell cell;
    double sides[4], depth[2]; /* of the cell, without margins: the files' coordinates */
};

/* As orl_bsdf_make has it. */
int orl_gonio_sample_load(const struct orl_bsdf_make_request *request,
                          const struct orl_bsdf_make_env *env, struct orl_gonio_sample *ret_sample,
                          struct orl_error *err);
void orl_gonio_sample_done(struct orl_gonio_sample *sample);

#endif

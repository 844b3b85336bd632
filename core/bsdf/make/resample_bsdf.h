/*
 * Reads a BSDF's file in place of measuring a panel: values of light from an incident cell, as
 * means over cells out.
 */
#ifndef ORL_BSDF_MAKE_RESAMPLE_BSDF_H
#define ORL_BSDF_MAKE_RESAMPLE_BSDF_H

#include <oriel/bsdf/bsdf.h>

#include "bsdf/make/klems/exit_histogram.h"
#include "bsdf/make/trees/probe.h"

/* Sets a tree's finest cell a to leaves without errors, like orl_gonio_probe_estimate. Adds to the
 * probe's totals. */
void orl_gonio_resample_cell(struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf, uint32_t a,
                             struct orl_gonio_cells ret_cells);

/* Sets an item of a matrix, as if measured by one path in each batch. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_gonio_resample_item(struct orl_gonio_histogram *histogram, const struct orl_bsdf *bsdf,
                            size_t item);

#endif

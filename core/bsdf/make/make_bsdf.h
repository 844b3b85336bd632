/*
 * Functions shared by the makers of BSDFs. Checks of requests and the XML are also used by
 * bsdf/fit. The makers of matrices and of trees measure a panel, or read a BSDF's file in its
 * place.
 */
#ifndef ORL_BSDF_MAKE_MAKE_BSDF_H
#define ORL_BSDF_MAKE_MAKE_BSDF_H

#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/bsdf/bsdf.h>

#include "base/sampling/sampling.h"
#include "bsdf/make/klems/exit_histogram.h"
#include "bsdf/make/panel/panel.h"
#include "bsdf/make/trees/measure_subtrees.h"
#include "bsdf/xml/bsdf_xml.h"

/* ---- Requests (panel_request.c) -------------------------------------------------------------- */

/* Sets an error at the given member; returns code. */
int orl_gonio_refuse(struct orl_error *err, int code, const char *member, const char *message);

/* Checks the parameters of tensor trees. Returns 0 or ORL_ERR_RANGE. */
int orl_gonio_check_tree(uint32_t resolution, double cull, struct orl_error *err);

/* Returns the name of a Klems basis in a file. */
const char *orl_gonio_klems_name(enum orl_bsdf_basis basis);

/* Estimated seconds of one core per path, for panels with a few surfaces. */
#define ORL_GONIO_PATH_S 4e-6

/* ---- Makers ---------------------------------------------------------------------------------- */

/* Measures a sample in the requested basis, and resolves a symmetry that is auto. Errors are as for
 * orl_bsdf_make. */
int orl_gonio_measure(const struct orl_bsdf_make_request *request,
                      const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                      struct orl_bsdf_make_result *ret_result, struct orl_error *err);

/* Measures matrices of a panel in a Klems basis: rounds of paths until the accuracy is reached.
 * Fills all of *result, or only a part of it after an error. */
int orl_gonio_make_klems(const struct orl_gonio_measurement *measurement,
                         struct orl_bsdf_make_result *result, struct orl_error *err);

/* Makes tensor trees of a panel: measures subtrees, merges cells from the finest up, and writes the
 * file. *result is as for orl_gonio_make_klems. */
int orl_gonio_make_trees(const struct orl_gonio_measurement *measurement,
                         struct orl_bsdf_make_result *result, struct orl_error *err);

/* A task of a distributed BSDF has this many items or subtrees (oriel/bsdf/bsdf_store.h). */
enum { ORL_GONIO_TASK_ITEMS = 4 };
static inline size_t orl_gonio_task_size(size_t n_items, size_t task)
{
    const size_t left = n_items - task * ORL_GONIO_TASK_ITEMS;
    return left < ORL_GONIO_TASK_ITEMS ? left : ORL_GONIO_TASK_ITEMS;
}

/* ---- A BSDF's file read in place of a panel (resample_bsdf.c) -------------------------------- */

/* Sets a tree's finest incident cell a to leaves without errors: means over cells out. Adds to the
 * probe's totals. The cells are as for orl_gonio_probe_estimate. */
void orl_gonio_resample_cell(struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf, uint32_t a,
                             struct orl_gonio_cells ret_cells);

/* Sets an item of a matrix, as if measured by one path in each batch. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_gonio_resample_item(struct orl_gonio_histogram *histogram, const struct orl_bsdf *bsdf,
                            size_t item);

/* ---- XML of a panel, with a comment on how it was made (panel_xml.c) ------------------------- */

/* Component of the file by [light from the front][transmitted]. Light from the back is Front in the
 * file. */
extern const enum orl_component_kind orl_gonio_component_of[2][2];

/* Sets result->xml, or result->errors_xml from a document of errors; the result's other fields must
 * be set. write_part: writes trees (bsdf/xml/bsdf_xml.h). Returns 0 or ORL_ERR_NOMEM. */
int orl_gonio_write(struct orl_document *document, orl_bsdf_write_part *write_part, void *ctx,
                    const struct orl_gonio_measurement *measurement, bool errors,
                    struct orl_bsdf_make_result *result);

#endif

/*
 * A BSDF's file on the goniophotometer's table in place of a panel: what it says of light from an
 * incident cell, as means over cells out.
 */
#ifndef ORL_GONIOMETER_READING_H
#define ORL_GONIOMETER_READING_H

#include <oriel/bsdf.h>

#include "goniometer/probe.h"
#include "goniometer/sheet.h"

/* Of a tree's finest cell a: leaves without errors, as orl_gonio_probe_tell has them. Adds to the
 * probe's totals. */
void orl_gonio_read_cell(struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf, uint32_t a,
                         struct orl_gonio_cells ret_cells);

/* Of an item of matrices: as if by one path of each batch. 0 or ORL_ERR_NOMEM. */
int orl_gonio_read_item(struct orl_gonio_sheet *sheet, const struct orl_bsdf *bsdf, size_t item);

#endif

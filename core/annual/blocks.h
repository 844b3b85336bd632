/*
 * A year's sensors, block by block: paths from them, the sun straight to them, and both times the
 * skies and suns of all hours.
 */
#ifndef ORL_ANNUAL_BLOCKS_H
#define ORL_ANNUAL_BLOCKS_H

#include "annual/year.h"

/* Of a year that is prepared: all its sensors, into the result or to whoever asked for rows.
 * Returns 0, ORL_ERR_NOMEM, _CANCELLED, or what that one returned. */
int orl_year_run_blocks(struct orl_year *y, struct orl_error *err);
/* NULL and half-filled are fine. */
void orl_year_blocks_done(struct orl_year *y);

#endif

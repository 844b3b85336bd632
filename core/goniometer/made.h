/* Figures of a result for a panel measured in a Klems basis. */
#ifndef ORL_GONIOMETER_MADE_H
#define ORL_GONIOMETER_MADE_H

#include "goniometer/sheet.h"

/* Fills *made except xml and the cell's place. Returns 0 or ORL_ERR_NOMEM. */
int orl_gonio_tell(const struct orl_gonio_sheet *sheet, struct orl_bsdf_made *made,
                   struct orl_error *err);

/* Returns the largest relative error of an item, over values of at least a hundredth of the peaks.
 * peaks: reflected, transmitted. */
double orl_gonio_worst(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2]);
/* Returns orl_gonio_worst as predicted for twice as many paths. It includes values that may be
 * large enough within two of their errors. */
double orl_gonio_foreseen(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2]);
/* Returns the largest values of light from that side, 1/sr: reflected, transmitted. */
void orl_gonio_peaks(const struct orl_gonio_sheet *sheet, bool front, double ret_peaks[2]);

#endif

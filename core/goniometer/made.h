/* What is told of a panel measured in a Klems basis: the figures of a result. */
#ifndef ORL_GONIOMETER_MADE_H
#define ORL_GONIOMETER_MADE_H

#include "goniometer/sheet.h"

/* All of made but xml and where the cell is: 0 or ORL_ERR_NOMEM. */
int orl_gonio_tell(const struct orl_gonio_sheet *sheet, struct orl_bsdf_made *made,
                   struct orl_error *err);

/* The largest share that an item's errors have in values of at least a hundredth of peaks, which
 * are by reflected and transmitted. */
double orl_gonio_worst(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2]);
/* The same as it is foreseen once there are twice as many paths; of values that may be of that
 * size, by two of their errors. */
double orl_gonio_foreseen(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2]);
/* The largest values of light from that side. */
void orl_gonio_peaks(const struct orl_gonio_sheet *sheet, bool front, double ret_peaks[2]);

#endif

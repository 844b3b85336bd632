/* What is told of a measured panel: the figures of a result, and its XML with how it was made. */
#ifndef ORL_GONIOMETER_MADE_H
#define ORL_GONIOMETER_MADE_H

#include "goniometer/sheet.h"

/* All but xml; ret_made is emptied first, and to be passed to orl_bsdf_made_done, whatever comes
 * of it: 0 or ORL_ERR_NOMEM. */
int orl_gonio_tell(const struct orl_gonio_sheet *sheet, const struct orl_gonio_sample *sample,
                   struct orl_bsdf_made *ret_made, struct orl_error *err);

/* The largest share that an item's errors have in values of at least a hundredth of peaks, which
 * are by reflected and transmitted. */
double orl_gonio_worst(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2]);
/* The largest values of light from that side. */
void orl_gonio_peaks(const struct orl_gonio_sheet *sheet, bool front, double ret_peaks[2]);

/* Sets made->xml; 0 or ORL_ERR_NOMEM. */
int orl_gonio_write(const struct orl_gonio_sheet *sheet, const struct orl_gonio_sample *sample,
                    const struct orl_bsdf_make_request *request, struct orl_bsdf_made *made,
                    struct orl_error *err);

#endif

/* Figures of a result for a panel measured in a Klems basis. */
#ifndef ORL_BSDF_MAKE_KLEMS_KLEMS_SUMMARY_H
#define ORL_BSDF_MAKE_KLEMS_KLEMS_SUMMARY_H

#include "bsdf/make/klems/exit_histogram.h"

/* Fills *made except xml and the cell's place. Returns 0 or ORL_ERR_NOMEM. */
int orl_gonio_summarize(const struct orl_gonio_histogram *histogram,
                        struct orl_bsdf_make_result *result, struct orl_error *err);

/* Returns the largest relative error of an item, over values of at least a hundredth of the peaks.
 * peaks: reflected, transmitted. */
double orl_gonio_max_error(const struct orl_gonio_histogram *histogram, size_t item,
                           const double peaks[2]);
/* Returns orl_gonio_max_error as predicted for twice as many paths. It includes values that may be
 * large enough within two of their errors. */
double orl_gonio_item_predicted_error(const struct orl_gonio_histogram *histogram, size_t item,
                                      const double peaks[2]);
/* Returns the largest values of light from that side, 1/sr: reflected, transmitted. */
void orl_gonio_peaks(const struct orl_gonio_histogram *histogram, bool front, double ret_peaks[2]);

#endif

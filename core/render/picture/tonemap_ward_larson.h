/*
 * Tone mapping by histogram adjustment, which keeps the visibility of contrasts as in the real
 * scene.
 *
 * The ceiling of the histogram is human contrast sensitivity: Ward Larson, Rushmeier and Piatko
 * 1997, sections 3 and 4.1, with the thresholds of Ferwerda, Pattanaik, Shirley and Greenberg 1996.
 * The display has a range of 100 to 1, up to 100 cd/m2. If the scene's range is no larger, or
 * nothing must be trimmed, the mapping is linear.
 *
 * The histogram is in logarithms of luminance. Foveal samples and pixels enter with equal total
 * weight, so that small bright things are represented.
 */
#ifndef ORL_RENDER_PICTURE_TONEMAP_WARD_LARSON_H
#define ORL_RENDER_PICTURE_TONEMAP_WARD_LARSON_H

#include <stdbool.h>

#include "render/picture/fovea.h"

enum { ORL_TONEMAP_BINS = 100 };

struct orl_tonemap {
    double factor;    /* factor of luminance; if above 0 the mapping is linear */
    double low, high; /* range of the bins, logarithms of luminance in cd/m2 */
    /* Share of the display's range, logarithmic, below each bin. */
    double share[ORL_TONEMAP_BINS + 1];
};

void orl_tonemap_make(struct orl_tonemap *tonemap, const struct orl_film *film,
                      const struct orl_fovea *fovea);

/*
 * A histogram shared by several pictures, so that equal luminances look alike. Every picture is
 * read twice: by orl_tonemap_histogram_extend for the range and by orl_tonemap_histogram_add for
 * the bins. Zero at first.
 */
struct orl_tonemap_histogram {
    double least, most; /* range of luminance, valid if any */
    bool any;
    double low, high, bins[ORL_TONEMAP_BINS], total, sum; /* sum: of logarithms */
};
void orl_tonemap_histogram_extend(struct orl_tonemap_histogram *histogram,
                                  const struct orl_film *film, const struct orl_fovea *fovea);
void orl_tonemap_histogram_add(struct orl_tonemap_histogram *histogram, const struct orl_film *film,
                               const struct orl_fovea *fovea);
/* Sets the range after orl_tonemap_histogram_extend and before orl_tonemap_histogram_add. Returns
 * false if there is nothing to count. */
bool orl_tonemap_histogram_range(struct orl_tonemap_histogram *histogram);
void orl_tonemap_from_histogram(struct orl_tonemap *tonemap,
                                struct orl_tonemap_histogram *histogram);

/* Returns the display value of a luminance, cd/m2: 0 is its black, 1 its white; a linear mapping
 * may exceed 1. */
double orl_tonemap_apply(const struct orl_tonemap *tonemap, double luminance);

/* Returns the luminance of a pixel, cd/m2; 0 if it is not finite or negative. */
double orl_luminance(const float rgb[3]);

/* Returns the threshold luminance difference for eyes adapted to a luminance; both cd/m2. */
double orl_visible_difference(double luminance);

/* Returns the finest visible pattern for eyes adapted to a luminance, cycles per degree: Shlaer's
 * data of 1937, fitted as in the paper. */
double orl_acuity(double luminance);

#endif

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
#ifndef ORL_RENDER_PICTURE_HUMAN_H
#define ORL_RENDER_PICTURE_HUMAN_H

#include <stdbool.h>

#include "render/picture/fovea.h"

enum { ORL_HUMAN_BINS = 100 };

struct orl_human {
    double factor;    /* factor of luminance; if above 0 the mapping is linear */
    double low, high; /* range of the bins, logarithms of luminance in cd/m2 */
    /* Share of the display's range, logarithmic, below each bin. */
    double share[ORL_HUMAN_BINS + 1];
};

void orl_human_make(struct orl_human *human, const struct orl_film *film,
                    const struct orl_fovea *fovea);

/*
 * A histogram shared by several pictures, so that equal luminances look alike. Every picture is
 * read twice: by orl_human_look for the range and by orl_human_count for the bins. Zero at first.
 */
struct orl_human_tally {
    double least, most; /* range of luminance, valid if any */
    bool any;
    double low, high, bins[ORL_HUMAN_BINS], total, sum; /* sum: of logarithms */
};
void orl_human_look(struct orl_human_tally *tally, const struct orl_film *film,
                    const struct orl_fovea *fovea);
void orl_human_count(struct orl_human_tally *tally, const struct orl_film *film,
                     const struct orl_fovea *fovea);
/* Sets the range after orl_human_look and before orl_human_count. Returns false if there is nothing
 * to count. */
bool orl_human_find_range(struct orl_human_tally *tally);
void orl_human_settle(struct orl_human *human, struct orl_human_tally *tally);

/* Returns the display value of a luminance, cd/m2: 0 is its black, 1 its white; a linear mapping
 * may exceed 1. */
double orl_human_show(const struct orl_human *human, double luminance);

/* Returns the luminance of a pixel, cd/m2; 0 if it is not finite or negative. */
double orl_luminance(const float rgb[3]);

/* Returns the threshold luminance difference for eyes adapted to a luminance; both cd/m2. */
double orl_least_difference(double luminance);

/* Returns the finest visible pattern for eyes adapted to a luminance, cycles per degree: Shlaer's
 * data of 1937, fitted as in the paper. */
double orl_acuity(double luminance);

#endif

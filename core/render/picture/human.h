/*
 * How bright a picture shows what luminance, so that as much is seen of it as would be in place.
 *
 * Histogram adjustment with the human contrast sensitivity as its ceiling: Ward Larson, Rushmeier
 * and Piatko 1997, sections 3 and 4.1, with the thresholds of Ferwerda, Pattanaik, Shirley and
 * Greenberg 1996. The display has a range of 100 to 1, up to 100 cd/m2. Where the scene's range is
 * no larger, or nothing has to be trimmed, the picture is in proportion.
 *
 * The histogram is that of the foveal samples, and with the same weight that of all pixels, so that
 * what is small and bright keeps its place; in logarithms of luminance.
 */
#ifndef ORL_RENDER_PICTURE_HUMAN_H
#define ORL_RENDER_PICTURE_HUMAN_H

#include <stdbool.h>

#include "render/picture/fovea.h"

enum { ORL_HUMAN_BINS = 100 };

struct orl_human {
    double factor;    /* of luminance, when above 0: the picture is in proportion */
    double low, high; /* logarithms of luminance, cd/m2, that the bins lie between */
    double share[ORL_HUMAN_BINS + 1]; /* of the display's range, logarithmic, below each bin */
};

void orl_human_make(struct orl_human *human, const struct orl_film *film,
                    const struct orl_fovea *fovea);

/*
 * The same of several pictures that are to be compared, so that a luminance looks alike in all of
 * them: their histograms as one. Every picture is looked at twice, for the range and for what is in
 * it. All zero at first.
 */
struct orl_human_tally {
    double least, most; /* luminances, once one was looked at */
    bool any;
    double low, high, bins[ORL_HUMAN_BINS], total, sum; /* sum: of logarithms */
};
void orl_human_look(struct orl_human_tally *tally, const struct orl_film *film,
                    const struct orl_fovea *fovea);
void orl_human_count(struct orl_human_tally *tally, const struct orl_film *film,
                     const struct orl_fovea *fovea);
/* Between the two. False: there is nothing to count. */
bool orl_human_find_range(struct orl_human_tally *tally);
void orl_human_settle(struct orl_human *human, struct orl_human_tally *tally);

/* What the display shows of a luminance, cd/m2: 0 is its black, 1 its white; in proportion it may
 * be more. */
double orl_human_show(const struct orl_human *human, double luminance);

/* Luminance of a pixel, cd/m2; 0 of what is none. */
double orl_luminance(const float rgb[3]);

/* The least difference of luminance that is seen, of eyes used to a luminance; both cd/m2. */
double orl_least_difference(double luminance);

/* The finest pattern that eyes tell apart when used to a luminance, cycles per degree: Shlaer's
 * data of 1937, as the paper fits them. */
double orl_acuity(double luminance);

#endif

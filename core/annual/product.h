/*
 * From a sensor's coefficients to its hours: sky by bins, the sun by nodes, and what came straight.
 */
#ifndef ORL_ANNUAL_PRODUCT_H
#define ORL_ANNUAL_PRODUCT_H

#include "annual/hours.h"
#include "annual/terms.h"

/* Coefficients of a sensor, of each batch: sums over its samples (trace.h). */
struct orl_annual_coefficients {
    uint32_t samples;
    float *bins; /* [ORL_ANNUAL_BATCHES][ORL_BINS] */
    double *sun; /* [ORL_ANNUAL_BATCHES][n_sun]: nodes, then beams */
    float *lots; /* [ORL_ANNUAL_BATCHES][ORL_SUN_MAP_LOTS][n_beams]: of beams, by each lot alone */
    size_t n_sun, n_beams;
};

/* Direct sunlight, and what mirrors send, are given by sun (sunlight.h, panels.h); the columns'
 * light comes of it. */
struct orl_annual_row {
    const float *by_sun, *mirrored, *squares;
    float *total, *direct, *se;
};

/*
 * A sensor's coefficients, made ready. What batches differ by in the sky is told by coarse bins.
 */
struct orl_annual_factors {
    float bins[ORL_BINS];                              /* the mean of all batches */
    float coarse[ORL_ANNUAL_BATCHES][ORL_BINS_COARSE]; /* of each, less the mean */
    double *sun;                                       /* [node or beam][batch]; borrowed */
    double *sun_means;                                 /* [node or beam]; borrowed */
    double *lots;                                      /* [beam][lot]; borrowed */
    size_t n_nodes;                                    /* which beams come after */
    bool has_beams;
};

/* sun has room for as many as the coefficients have, and their means after them; lots, for beams,
 * by lot. */
void orl_annual_factors_fill(struct orl_annual_factors *factors, const struct orl_bins *bins,
                             const struct orl_annual_coefficients *coefficients, double *sun,
                             double *lots);

/* Daylight coefficients (oriel/annual.h): [ORL_ANNUAL_PATCHES]. */
void orl_annual_factors_tell(const struct orl_annual_factors *factors, float *ret_coefficients);

/* Of one tile of columns, for some sensors: a tile's sky serves all of them while it is at hand.
 * terms: of the sun. */
void orl_annual_multiply(const struct orl_annual_factors *const *factors, size_t count,
                         const struct orl_hours *hours, const struct orl_sun_terms *terms,
                         size_t tile, const struct orl_annual_row *rows);

#endif

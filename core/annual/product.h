/*
 * From a sensor's coefficients to its hours: sky by bins, the sun by nodes and beams, and what came
 * straight. Light of several parts of the windows (parts.h) is added up, of each part in the
 * columns in which it is wanted.
 */
#ifndef ORL_ANNUAL_PRODUCT_H
#define ORL_ANNUAL_PRODUCT_H

#include "annual/coherence.h"
#include "annual/hours.h"
#include "annual/terms.h"

/* Sums over the samples of each of a sensor's batches (sums.h), of one part. NULL: all are 0. */
struct orl_annual_coefficients {
    uint32_t samples;                        /* of a batch */
    const float *bins[ORL_ANNUAL_BATCHES];   /* [ORL_BINS] */
    const double *nodes[ORL_ANNUAL_BATCHES]; /* [n_nodes] */
    size_t n_nodes;
};

/* Sums of beams. A beam has one part. */
struct orl_annual_beam_coefficients {
    uint32_t samples;
    const double *beams[ORL_ANNUAL_BATCHES];
    const float *lots[ORL_ANNUAL_BATCHES]; /* [n_beams][ORL_SUN_MAP_LOTS]: by each lot alone */
    const uint32_t *which;                 /* those to be made ready */
    size_t n_which, n_beams;
};

/* Coefficients of a part, divided by samples. Most parts light a sensor from a few bins only, so
 * these are listed, in their order. Differences between batches are kept by coarse bins. */
struct orl_annual_factors {
    uint16_t n_bins, n_coarse;
    uint16_t which[ORL_BINS];
    float bins[ORL_BINS]; /* of those listed: the mean of all batches */
    uint16_t which_coarse[ORL_BINS_COARSE];
    float coarse[ORL_BINS_COARSE][ORL_ANNUAL_BATCHES]; /* of those: of each batch, less the mean */
    double *nodes;                                     /* [node][batch]; borrowed */
    double *node_means;                                /* [node]; borrowed */
};
/* nodes has room for n_nodes of all batches, and their means after them. */
void orl_annual_factors_fill(struct orl_annual_factors *factors, const struct orl_bins *bins,
                             const struct orl_annual_coefficients *coefficients, double *nodes);

struct orl_annual_beams {
    double *sums;  /* [beam][batch]; borrowed */
    double *means; /* [beam]; borrowed */
    double *lots;  /* [beam][lot]; borrowed */
};
/* sums has room for all beams of all batches, and their means after them; what of it is of other
 * beams than those asked for is not set. */
void orl_annual_beams_fill(struct orl_annual_beams *beams,
                           const struct orl_annual_beam_coefficients *coefficients, double *sums,
                           double *lots);

/* Daylight coefficients (oriel/annual.h): [ORL_ANNUAL_PATCHES]. */
void orl_annual_factors_tell(const struct orl_annual_factors *factors, float *ret_coefficients);

/* A sensor's columns, all 0 before. Direct sunlight is that of all parts, wanted or not. */
struct orl_annual_row {
    float *total, *direct, *se;
    float *between;              /* of coherence.h, of columns with sun */
    struct orl_error_sums *sums; /* [band]: of the tile; all 0 before */
};

/* Light of a part at a sensor. */
struct orl_annual_share {
    uint32_t part;
    const struct orl_annual_factors *factors; /* NULL: none */
    const struct orl_annual_beams *beams;     /* of all parts */
    /* By sun (sun_rows.h); NULL: none. */
    const float *by_sun, *mirrored, *squares;
    const unsigned char *wanted; /* by column; NULL: in all */
};

/* Fills one tile of a sensor's columns. The tile's sky stays in the cache if all sensors of a tile
 * follow each other. terms: of the sun. */
void orl_annual_multiply(const struct orl_annual_row *row, const struct orl_annual_share *lights,
                         size_t count, const struct orl_hours *hours,
                         const struct orl_sun_terms *terms, size_t tile);

#endif

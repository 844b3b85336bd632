/*
 * Converts a sensor's coefficients to its hours: sky by bins, the sun by nodes and beams, and
 * direct sunlight. Light of the window groups (window_group_ports.h) is added up, for each window
 * group in the columns that want it.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_APPLY_WEATHER_H
#define ORL_ANNUAL_COEFFICIENTS_APPLY_WEATHER_H

#include "annual/coefficients/coherence.h"
#include "annual/sky/hours.h"
#include "annual/sun/sun_weights.h"

/* Path sums of each of a sensor's batches (path_sums.h), for one window group. NULL: all are 0. */
struct orl_annual_coefficients {
    uint32_t samples;                        /* per batch */
    const float *bins[ORL_ANNUAL_BATCHES];   /* [ORL_BINS] */
    const double *nodes[ORL_ANNUAL_BATCHES]; /* [n_nodes] */
    size_t n_nodes;
};

/* Path sums of beams. A beam belongs to one window group. */
struct orl_annual_beam_coefficients {
    uint32_t samples;
    const double *beams[ORL_ANNUAL_BATCHES];
    /* [n_beams][ORL_SUN_PHOTON_BATCHES]: estimate by each photon batch alone. */
    const float *photon_batches[ORL_ANNUAL_BATCHES];
    const uint32_t *which; /* beams to convert */
    size_t n_which, n_beams;
};

/* Coefficients of a window group, divided by the number of samples. Most window groups light a
 * sensor from a few bins only, so these are listed in order. Differences between batches are kept
 * by coarse bins. */
struct orl_sparse_coefficients {
    uint16_t n_bins, n_coarse;
    uint16_t which[ORL_BINS];
    float bins[ORL_BINS]; /* by listed bin: mean of all batches */
    uint16_t which_coarse[ORL_BINS_COARSE];
    /* By listed coarse bin: each batch less the mean. */
    float coarse[ORL_BINS_COARSE][ORL_ANNUAL_BATCHES];
    double *nodes;      /* [node][batch]; borrowed */
    double *node_means; /* [node]; borrowed */
};
/* Fills the coefficients. nodes has room for the n_nodes of all batches, followed by their means.
 */
void orl_sparse_coefficients_fill(struct orl_sparse_coefficients *sparse,
                                  const struct orl_bins *bins,
                                  const struct orl_annual_coefficients *coefficients,
                                  double *nodes);

struct orl_annual_beams {
    double *sums;           /* [beam][batch]; borrowed */
    double *means;          /* [beam]; borrowed */
    double *photon_batches; /* [beam][photon batch]; borrowed */
};
/* Fills the beams. sums has room for all beams of all batches, followed by their means. Entries of
 * beams that coefficients does not list are left unset. */
void orl_annual_beams_fill(struct orl_annual_beams *beams,
                           const struct orl_annual_beam_coefficients *coefficients, double *sums,
                           double *photon_batches);

/* Writes daylight coefficients (oriel/annual/annual.h): [ORL_ANNUAL_PATCHES]. */
void orl_sparse_coefficients_expand(const struct orl_sparse_coefficients *sparse,
                                    float *ret_coefficients);

/* Output columns of a sensor, initially 0. Direct sunlight is that of all window groups, wanted or
 * not. */
struct orl_annual_columns {
    float *total, *direct, *se;
    float *interpolation_error;  /* relative error of interpolation, in columns with sun
                                    (coherence.h) */
    struct orl_error_sums *sums; /* [band], for the tile; initially 0 */
};

/* Light of one window group at a sensor. */
struct orl_window_group_light {
    uint32_t window_group;
    const struct orl_sparse_coefficients *sparse; /* NULL: none */
    const struct orl_annual_beams *beams;         /* beams of all window groups */
    /* By sun (sensor_sunlight.h); NULL: no direct sunlight. */
    const float *by_sun, *mirrored, *squares;
    /* By column: nonzero if the window group's light is added there; NULL: in all columns. */
    const unsigned char *wanted;
};

/* Fills one tile of a sensor's columns. For cache efficiency, process all sensors of a tile in
 * sequence. sun_weights: interpolation weights of the suns. */
void orl_annual_apply_weather(const struct orl_annual_columns *row,
                              const struct orl_window_group_light *lights, size_t count,
                              const struct orl_hours *hours,
                              const struct orl_sun_weights *sun_weights, size_t tile);

#endif

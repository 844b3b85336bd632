/* Coefficients of a sensor (trace_sensor.h) under the skies and suns of a year. */
#ifndef ORL_ANNUAL_COEFFICIENTS_APPLY_WEATHER_H
#define ORL_ANNUAL_COEFFICIENTS_APPLY_WEATHER_H

#include <math.h>

#include <oriel/annual/annual.h>

#include "annual/sky/hours.h"
#include "annual/sun/sun_weights.h"
#include "annual/sun_map/sun_beams.h"
#include "base/memory/memory.h"

/*
 * Coherence: the degree to which the errors of a sensor's hours add up. Each hour has its own
 * standard error. A metric counts many hours, and its error depends on how their errors are
 * correlated. Under the sky alone errors are almost fully correlated: the paths are the same, and
 * skies of different hours are similar. Hours with sun have it in different places, so they depend
 * on different paths and photons. Errors of interpolation have either sign.
 *
 * The coherence of a sensor is the standard error of the sum of its relative errors over hours with
 * sun. It is divided by the sum of their relative standard errors, the value for full correlation.
 * Hours of similar illuminance are summed in a band, because a threshold separates such hours. The
 * result is the root mean square over bands, weighted by their errors.
 *
 * It combines the sources of each standard error:
 *   - paths: relative deviations of a batch are summed over hours; the spread of the sums counts;
 *   - photons: likewise for their photon batches;
 *   - interpolation: errors between the same nodes of the sun add up, others are independent;
 *   - sampling of panes and of the sun's disc: independent from hour to hour.
 *
 * Errors: 0 or ORL_ERR_NOMEM. Threads: any, if each handles other sensors or tiles.
 */

/* Bands of illuminance, each a factor of two wide except the first and the last. */
enum { ORL_ERROR_BANDS = 8 };
static inline int orl_error_band(double lx)
{
    const double octave = floor(log2(fmax(lx, 1) / 75));
    return (int)fmin(fmax(octave + 1, 0), ORL_ERROR_BANDS - 1);
}

/* Sums over some columns with sun in a band, relative to the light of each hour. */
struct orl_error_sums {
    double errors;  /* sum of standard errors */
    double squares; /* sum of squares of errors that are independent from hour to hour */
    float batches[ORL_ANNUAL_BATCHES];            /* deviations from the mean of all batches */
    float photon_batches[ORL_SUN_PHOTON_BATCHES]; /* deviations of photon batches from their mean */
};

/* Columns with sun, sorted so that those between the same nodes of the sun are adjacent. */
struct orl_sun_cells {
    uint32_t *columns, *cells; /* [count]; cells[i] is the first node of columns[i] */
    size_t count;
};
/* The lists are owned by `arrays`. Returns 0 or ORL_ERR_NOMEM. */
int orl_sun_cells_init(struct orl_sun_cells *cells, struct orl_arrays *arrays,
                       const struct orl_hours *hours, const struct orl_sun_weights *sun_weights);

/* sums: [tile * stride][band]. total: lx by column. interpolation_error: relative error of
 * interpolation by column; used in columns with sun. Returns a number from 0 to 1; 0 if hours with
 * sun have no errors. */
float orl_coherence_of(const struct orl_error_sums *sums, size_t n_tiles, size_t stride,
                       const float *total, const float *interpolation_error,
                       const struct orl_sun_cells *cells);

/*
 * Converts a sensor's coefficients to its hours: sky by bins, the sun by nodes and beams, and
 * direct sunlight. Light of the window groups (annual_scene.h) is added up, for each window
 * group in the columns that want it.
 */

/* Path sums of each of a sensor's batches (trace_sensor.h), for one window group. NULL: all are 0.
 */
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
 * sensor from a few bins only, so these are listed in order. Differences between batches are stored
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
    float *interpolation_error;  /* relative error of interpolation, in columns with sun */
    struct orl_error_sums *sums; /* [band], for the tile; initially 0 */
};

/* Light of one window group at a sensor. */
struct orl_window_group_light {
    uint32_t window_group;
    const struct orl_sparse_coefficients *sparse; /* NULL: none */
    const struct orl_annual_beams *beams;         /* beams of all window groups */
    /* By sun (sunlight.h); NULL: no direct sunlight. */
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

/*
 * Light of a sensor under the CIE overcast sky, from the coefficients shared by all hours. It
 * yields the daylight factor without more rays.
 *
 * The sky's luminance at the horizon is a third of that at the zenith (Moon and Spencer 1942; CIE S
 * 011/E:2003, type 16). It gives a horizontal plane ORL_OVERCAST_LX and lights the ground, a
 * diffuse reflector. Each bin has its mean luminance; no bin crosses the horizon.
 */

struct orl_overcast {
    double luminance[ORL_BINS]; /* cd/m2 */
};

void orl_overcast_init(struct orl_overcast *overcast, const struct orl_bins *bins,
                       double ground_reflectance);

/* Adds the illuminance by a window group's coefficients to each batch, lx. */
void orl_overcast_add(const struct orl_overcast *overcast,
                      const struct orl_annual_coefficients *coefficients,
                      double batches[ORL_ANNUAL_BATCHES]);
/* Computes the mean of the batches, and its standard error. */
void orl_overcast_illuminance(const double batches[ORL_ANNUAL_BATCHES], float *ret_lx,
                              float *ret_se);

#endif

/*
 * Sums of a chunk of sensors: those of their paths by batch (trace_sensor.h), and direct sunlight
 * (sunlight.h). Both can be packed into bytes and unpacked; only lit window groups are packed.
 *
 * Threads may write to different batches, or sensors, at the same time.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_CHUNK_SUMS_H
#define ORL_ANNUAL_COEFFICIENTS_CHUNK_SUMS_H

#include <oriel/annual/annual.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/sun/sunlight.h"
#include "annual/sun_map/sun_beams.h"

struct orl_chunk_sums {
    size_t n_sensors, n_window_groups, n_nodes, n_beams, n_suns;
    unsigned char *lit;     /* [sensor][batch][window group] */
    float *bins;            /* [sensor][batch][window group][bin] */
    double *nodes;          /* [sensor][batch][window group][node] */
    double *beams;          /* [sensor][batch][beam] */
    float *photon_batches;  /* [sensor][batch][photon batch][beam] */
    unsigned char *sun_lit; /* [sensor][window group] */
    float *suns;            /* [sensor][window group][ORL_SUNLIGHT_ROWS][sun] */
};

/* Allocates the arrays; the caller has set the counts. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_chunk_sums_done in either case. */
int orl_chunk_sums_init(struct orl_chunk_sums *sums);
void orl_chunk_sums_done(struct orl_chunk_sums *sums);

/* Clear the path sums, or the sunlight, of the first count sensors. */
void orl_chunk_sums_clear_paths(struct orl_chunk_sums *sums, size_t count);
void orl_chunk_sums_clear_suns(struct orl_chunk_sums *sums, size_t count);

struct orl_path_sums orl_chunk_sums_of(const struct orl_chunk_sums *sums, size_t sensor,
                                       uint32_t batch);
/* The caller sets wanted, direct_only and disc_points of the returned rows. */
struct orl_sensor_sunlight orl_chunk_suns_of(const struct orl_chunk_sums *sums, size_t sensor);

/* Pack paths or sunlight of the first count sensors. ret_data is owned by the caller; size is a
 * multiple of 4 bytes. Return 0 or ORL_ERR_NOMEM. */
int orl_chunk_sums_pack_paths(const struct orl_chunk_sums *sums, size_t count, void **ret_data,
                              size_t *ret_size);
int orl_chunk_sums_pack_suns(const struct orl_chunk_sums *sums, size_t count, void **ret_data,
                             size_t *ret_size);
/* Unpack paths or sunlight. Return true if the data has the size that its flags require; otherwise
 * they clear the sums and return false. */
bool orl_chunk_sums_unpack_paths(struct orl_chunk_sums *sums, size_t count, const void *data,
                                 size_t size);
bool orl_chunk_sums_unpack_suns(struct orl_chunk_sums *sums, size_t count, const void *data,
                                size_t size);

#endif

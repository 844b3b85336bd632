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
#include "base/memory/memory.h"

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

/* Allocates the arrays, owned by `arrays`; the caller has set the counts. */
void orl_chunk_sums_init(struct orl_chunk_sums *sums, struct orl_arrays *arrays);

/* Sums of paths, or direct sunlight. */
enum orl_chunk_part { ORL_CHUNK_PATHS, ORL_CHUNK_SUNS };

/* Clears a part of the first count sensors. */
void orl_chunk_sums_clear(struct orl_chunk_sums *sums, enum orl_chunk_part part, size_t count);

struct orl_path_sums orl_chunk_sums_of(const struct orl_chunk_sums *sums, size_t sensor,
                                       uint32_t batch);
/* The caller sets wanted, direct_only and disc_points of the returned rows. */
struct orl_sensor_sunlight orl_chunk_suns_of(const struct orl_chunk_sums *sums, size_t sensor);

/* Packs a part of the first count sensors. Returns data owned by the caller, of a multiple of 4
 * bytes; NULL when out of memory. */
void *orl_chunk_sums_pack(const struct orl_chunk_sums *sums, enum orl_chunk_part part, size_t count,
                          size_t *ret_size);
/* Unpacks a part. Returns true if the data has the size that its flags require; otherwise clears
 * the part and returns false. */
bool orl_chunk_sums_unpack(struct orl_chunk_sums *sums, enum orl_chunk_part part, size_t count,
                           const void *data, size_t size);

#endif

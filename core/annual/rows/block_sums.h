/*
 * Sums of a block of sensors: those of their paths by batch (sums.h), and direct sunlight
 * (sun_rows.h). Both can be packed into bytes and unpacked; only lit parts are packed.
 *
 * Threads may write to different batches, or sensors, at the same time.
 */
#ifndef ORL_ANNUAL_ROWS_BLOCK_SUMS_H
#define ORL_ANNUAL_ROWS_BLOCK_SUMS_H

#include <oriel/annual.h>

#include "annual/rows/sums.h"
#include "annual/sun/sun_rows.h"
#include "annual/sun_map/sun_photons.h"

struct orl_block_sums {
    size_t n_sensors, n_parts, n_nodes, n_beams, n_suns;
    unsigned char *lit;     /* [sensor][batch][part] */
    float *bins;            /* [sensor][batch][part][bin] */
    double *nodes;          /* [sensor][batch][part][node] */
    double *beams;          /* [sensor][batch][beam] */
    float *lots;            /* [sensor][batch][lot][beam] */
    unsigned char *sun_lit; /* [sensor][part] */
    float *suns;            /* [sensor][part][ORL_SUN_ROWS][sun] */
};

/* Allocates the arrays; the caller has set the counts. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_block_sums_done in either case. */
int orl_block_sums_init(struct orl_block_sums *sums);
void orl_block_sums_done(struct orl_block_sums *sums);

/* Clear the path sums, or the sunlight, of the first count sensors. */
void orl_block_sums_clear_paths(struct orl_block_sums *sums, size_t count);
void orl_block_sums_clear_suns(struct orl_block_sums *sums, size_t count);

struct orl_annual_sums orl_block_sums_of(const struct orl_block_sums *sums, size_t sensor,
                                         uint32_t batch);
/* The caller sets wanted, direct_only and disc_points of the returned rows. */
struct orl_sun_rows orl_block_suns_of(const struct orl_block_sums *sums, size_t sensor);

/* Pack paths or sunlight of the first count sensors. ret_data is owned by the caller; size is a
 * multiple of 4 bytes. Return 0 or ORL_ERR_NOMEM. */
int orl_block_sums_pack_paths(const struct orl_block_sums *sums, size_t count, void **ret_data,
                              size_t *ret_size);
int orl_block_sums_pack_suns(const struct orl_block_sums *sums, size_t count, void **ret_data,
                             size_t *ret_size);
/* Unpack paths or sunlight. Return true if the data has the size that its flags require; otherwise
 * they clear the sums and return false. */
bool orl_block_sums_unpack_paths(struct orl_block_sums *sums, size_t count, const void *data,
                                 size_t size);
bool orl_block_sums_unpack_suns(struct orl_block_sums *sums, size_t count, const void *data,
                                size_t size);

#endif

/*
 * The order of a map's photons: by the bin of their normal (normal_code.h), then along the Morton
 * curve. The code of a point finds the leaf whose photons are around it, without a search of boxes.
 *
 * Threads: an index is immutable once made.
 */
#ifndef ORL_PHOTON_MAP_ZORDER_H
#define ORL_PHOTON_MAP_ZORDER_H

#include "photon/map/map_layout.h"

enum { ORL_ZORDER_FANOUT = 8, ORL_ZORDER_LEVELS = 10, ORL_ZORDER_POSITION_BITS = 57 };

/* Spreads 20 bits to every third bit. */
static inline uint64_t orl_zorder_spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

/* Returns the code of a cell and a normal. It uses 19 of the 20 bits of each axis, to leave room
 * for the bin above them. */
static inline uint64_t orl_zorder_code(const uint32_t cell[3], uint16_t normal)
{
    return (uint64_t)orl_normal_bin(normal) << ORL_ZORDER_POSITION_BITS |
           orl_zorder_spread(cell[0] >> 1) | orl_zorder_spread(cell[1] >> 1) << 1 |
           orl_zorder_spread(cell[2] >> 1) << 2;
}

/* The first code of each leaf; above them, level by level, that of every eighth entry. */
struct orl_zorder {
    uint64_t *codes[ORL_ZORDER_LEVELS];
    uint64_t counts[ORL_ZORDER_LEVELS];
    uint32_t levels;
};

/* Returns 0 or ORL_ERR_NOMEM. */
int orl_zorder_init(struct orl_zorder *order, const struct orl_photon_map *map);
void orl_zorder_done(struct orl_zorder *order); /* a struct that is all zero is allowed */

/* Returns the last leaf whose first code is not greater than `code`, or the first leaf if there
 * is none. The map must have photons. */
uint64_t orl_zorder_find(const struct orl_zorder *order, uint64_t code);

#endif

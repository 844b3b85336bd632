/* Morton codes of points in space: the bits of three coordinates, interleaved. */
#ifndef ORL_BASE_MORTON_H
#define ORL_BASE_MORTON_H

#include <stdint.h>

/* Inserts two zero bits between the 21 low bits. */
static inline uint64_t orl_morton_spread_21(uint64_t x)
{
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

/* Returns the code of coordinates of at most 21 bits each. Without its 3 n lowest bits it is the
 * code of a grid that is coarser by 2^n. */
static inline uint64_t orl_morton_code(uint64_t x, uint64_t y, uint64_t z)
{
    return orl_morton_spread_21(x) | orl_morton_spread_21(y) << 1 | orl_morton_spread_21(z) << 2;
}

#endif

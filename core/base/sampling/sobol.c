#include "base/sampling/sampling.h"

#include "base/multiversion.h"

/* Degree, coefficients and initial direction numbers per dimension; dimension 0 is bit reversal. */
static const struct {
    uint32_t degree, coefficients, initial[5];
} polynomials[ORL_SOBOL_DIMENSIONS] = {
    {0, 0, {0}},       {1, 0, {1}},       {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}},
};

static inline uint32_t reverse_bits(uint32_t x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffU) << 8) | ((x & 0xff00ff00U) >> 8);
    x = ((x & 0x0f0f0f0fU) << 4) | ((x & 0xf0f0f0f0U) >> 4);
    x = ((x & 0x33333333U) << 2) | ((x & 0xccccccccU) >> 2);
    return ((x & 0x55555555U) << 1) | ((x & 0xaaaaaaaaU) >> 1);
}

/* Owen scramble of the reversed bits: each bit is flipped by a hash of the bits above it. */
static inline uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= (seed >> 16) | 1U;
    x ^= x * 0x05526c56U;
    x ^= x * 0x53a22864U;
    return x;
}

static inline uint32_t hash32(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x21f0aaadU;
    x ^= x >> 15;
    x *= 0xd35a2d97U;
    return x ^ (x >> 15);
}

/* Direction numbers by the recurrence of Bratley and Fox 1988. */
static void make_directions(uint32_t dimension, uint32_t v[32])
{
    const uint32_t degree = polynomials[dimension].degree;
    for (uint32_t i = 0; i < 32; i++) {
        if (dimension == 0) {
            v[i] = 1U << (31 - i);
            continue;
        }
        if (i < degree) {
            v[i] = polynomials[dimension].initial[i] << (31 - i);
            continue;
        }
        v[i] = v[i - degree] ^ (v[i - degree] >> degree);
        for (uint32_t k = 1; k < degree; k++)
            if ((polynomials[dimension].coefficients >> (degree - 1 - k)) & 1U)
                v[i] ^= v[i - k];
    }
}

void orl_sobol_init(struct orl_sobol *sobol)
{
    for (uint32_t d = 0; d < ORL_SOBOL_DIMENSIONS; d++) {
        uint32_t v[32];
        make_directions(d, v);
        for (uint32_t byte = 0; byte < 4; byte++) {
            for (uint32_t value = 0; value < 256; value++) {
                uint32_t sum = 0;
                for (uint32_t bit = 0; bit < 8; bit++)
                    if (value >> bit & 1U)
                        sum ^= v[31 - (8 * byte + bit)];
                sobol->by_byte[d][byte][value] = reverse_bits(sum);
            }
        }
    }
}

/* Returns x * 2^-32, converted from a signed number, which any machine does in one step. */
static double unit_of(uint32_t x)
{
    return ((double)(int32_t)(x ^ 0x80000000U) + 0x1p31) * 0x1p-32;
}

static inline uint32_t point_of(const uint32_t table[4][256], uint32_t shuffled)
{
    return table[0][shuffled & 255] ^ table[1][shuffled >> 8 & 255] ^
           table[2][shuffled >> 16 & 255] ^ table[3][shuffled >> 24];
}

static inline uint32_t seed_of(uint32_t seed, uint32_t dimension)
{
    return hash32(seed ^ (0x9e3779b9U * (dimension + 1)));
}

/* Both scrambles, and the steps between them, work on reversed bits. */
void orl_sobol_point(const struct orl_sobol *sobol, uint32_t index, uint32_t seed, uint32_t count,
                     double *ret_point)
{
    const uint32_t shuffled = scramble_reversed(reverse_bits(index), hash32(seed));
    for (uint32_t d = 0; d < count; d++)
        ret_point[d] = unit_of(reverse_bits(
            scramble_reversed(point_of(sobol->by_byte[d], shuffled), seed_of(seed, d))));
}

/* Uses only integers and exact conversions, so that both compiled forms give the same result. */
ORL_FOR_WIDE_VECTORS
void orl_sobol_block(const struct orl_sobol *sobol, uint32_t index,
                     const uint32_t seeds[ORL_SOBOL_BLOCK], struct orl_sobol_block *ret_block)
{
    const uint32_t reversed = reverse_bits(index);
    uint32_t at[ORL_SOBOL_BLOCK], shuffled[ORL_SOBOL_BLOCK];
    for (int i = 0; i < ORL_SOBOL_BLOCK; i++)
        shuffled[i] = scramble_reversed(reversed, hash32(seeds[i]));
    for (uint32_t d = 0; d < ORL_SOBOL_DIMENSIONS; d++) {
        for (int i = 0; i < ORL_SOBOL_BLOCK; i++)
            at[i] = point_of(sobol->by_byte[d], shuffled[i]);
        for (int i = 0; i < ORL_SOBOL_BLOCK; i++)
            at[i] = reverse_bits(scramble_reversed(at[i], seed_of(seeds[i], d)));
        for (int i = 0; i < ORL_SOBOL_BLOCK; i++)
            ret_block->at[d][i] = unit_of(at[i]);
    }
}

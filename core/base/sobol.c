#include "base/sobol.h"

/* Degree, coefficients and initial direction numbers per dimension; dimension 0 is bit reversal. */
static const struct {
    uint32_t degree, coefficients, initial[5];
} polynomials[ORL_SOBOL_DIMENSIONS] = {
    {0, 0, {0}},          {1, 0, {1}},          {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},    {3, 2, {1, 1, 1}},    {4, 1, {1, 1, 3, 3}},
};

static uint32_t reverse_bits(uint32_t x)
{
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffU) << 8) | ((x & 0xff00ff00U) >> 8);
    x = ((x & 0x0f0f0f0fU) << 4) | ((x & 0xf0f0f0f0U) >> 4);
    x = ((x & 0x33333333U) << 2) | ((x & 0xccccccccU) >> 2);
    return ((x & 0x55555555U) << 1) | ((x & 0xaaaaaaaaU) >> 1);
}

/* An Owen scramble of the reversed bits: each bit is flipped by a hash of those above it. */
static uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= (seed >> 16) | 1U;
    x ^= x * 0x05526c56U;
    x ^= x * 0x53a22864U;
    return x;
}

static uint32_t hash32(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x21f0aaadU;
    x ^= x >> 15;
    x *= 0xd35a2d97U;
    return x ^ (x >> 15);
}

/* Direction numbers by the recurrence of Bratley and Fox 1988. */
void orl_sobol_init(struct orl_sobol *sobol)
{
    for (uint32_t i = 0; i < 32; i++)
        sobol->direction[0][i] = 1U << (31 - i);
    for (uint32_t d = 1; d < ORL_SOBOL_DIMENSIONS; d++) {
        uint32_t *const v = sobol->direction[d];
        const uint32_t degree = polynomials[d].degree;
        for (uint32_t i = 0; i < 32; i++) {
            if (i < degree) {
                v[i] = polynomials[d].initial[i] << (31 - i);
                continue;
            }
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            for (uint32_t k = 1; k < degree; k++)
                if ((polynomials[d].coefficients >> (degree - 1 - k)) & 1U)
                    v[i] ^= v[i - k];
        }
    }
}

void orl_sobol_point(const struct orl_sobol *sobol, uint32_t index, uint32_t seed, uint32_t count,
                     double *ret_point)
{
    const uint32_t shuffled = reverse_bits(scramble_reversed(reverse_bits(index), hash32(seed)));
    for (uint32_t d = 0; d < count; d++) {
        uint32_t point = 0;
        for (uint32_t bits = shuffled, i = 0; bits; bits >>= 1, i++)
            if (bits & 1U)
                point ^= sobol->direction[d][i];
        point = reverse_bits(
            scramble_reversed(reverse_bits(point), hash32(seed ^ (0x9e3779b9U * (d + 1)))));
        ret_point[d] = point * 0x1p-32;
    }
}

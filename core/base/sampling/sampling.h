/*
 * Numbers for sampling: random streams, Sobol points, sines and cosines, reservoirs, an order of
 * tasks.
 *
 * Random numbers are counter-based. A stream is keyed by (seed, purpose, index), never by a thread,
 * so that photon 17 or pixel (3, 4) gets the same numbers wherever and whenever it is computed. The
 * generator is SplitMix64 (Steele, Lea, Flood 2014) started at a hashed position.
 */
#ifndef ORL_BASE_SAMPLING_SAMPLING_H
#define ORL_BASE_SAMPLING_SAMPLING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct orl_random {
    uint64_t state;
};

/* Purpose of a stream; streams of different purposes are independent. */
enum orl_purpose {
    ORL_PURPOSE_PILOT = 1,
    ORL_PURPOSE_PHOTON,
    ORL_PURPOSE_DITHER,
    ORL_PURPOSE_SENSOR,
    ORL_PURPOSE_PIXEL,
    ORL_PURPOSE_RECORD,
    ORL_PURPOSE_GUIDE,
    ORL_PURPOSE_BENCH,
    ORL_PURPOSE_REFIT,
    ORL_PURPOSE_FIRST,
    ORL_PURPOSE_ANNUAL,
    ORL_PURPOSE_SUN_MAP,
    ORL_PURPOSE_GLOSS,
    ORL_PURPOSE_LEAF,
    ORL_PURPOSE_GONIOMETER,
    ORL_PURPOSE_CROSS_CHECK,
};

static inline uint64_t orl_mix64(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

static inline struct orl_random orl_random_stream(uint64_t seed, enum orl_purpose purpose,
                                                  uint64_t index)
{
    const uint64_t a = orl_mix64(seed + 0x9e3779b97f4a7c15ULL * (uint64_t)purpose);
    return (struct orl_random){orl_mix64(a ^ orl_mix64(index + 0x632be59bd9b4e019ULL))};
}

static inline uint64_t orl_random_bits(struct orl_random *random)
{
    random->state += 0x9e3779b97f4a7c15ULL;
    return orl_mix64(random->state);
}

/* Returns a uniform number in [0, 1), 53 bits. */
static inline double orl_random_uniform(struct orl_random *random)
{
    return (double)(orl_random_bits(random) >> 11) * 0x1p-53;
}

/*
 * Owen-scrambled Sobol points for the first few dimensions of an emission or of a hemisphere.
 * Points are keyed by index, as orl_random streams are.
 *
 * Generator matrices are built from the primitive polynomials and initial numbers of Joe and Kuo
 * 2008. The scramble is the hash of Laine and Karras 2011 as improved by Vegdahl 2021, with the
 * index shuffled likewise for independent sequences (Burley 2020).
 */

enum { ORL_SOBOL_DIMENSIONS = 6, ORL_SOBOL_BLOCK = 16 };

/* Generator tables: constant after orl_sobol_init, shared by all threads. */
struct orl_sobol {
    /* Bit-reversed sums of direction numbers, for every byte of a bit-reversed index. */
    uint32_t by_byte[ORL_SOBOL_DIMENSIONS][4][256];
};

void orl_sobol_init(struct orl_sobol *sobol);

/* Fills ret_point with the first count coordinates, in [0, 1), of point index of sequence seed. */
void orl_sobol_point(const struct orl_sobol *sobol, uint32_t index, uint32_t seed, uint32_t count,
                     double *ret_point);

/* All coordinates of one index in several sequences at once: at[dimension][sequence]. */
struct orl_sobol_block {
    double at[ORL_SOBOL_DIMENSIONS][ORL_SOBOL_BLOCK];
};
void orl_sobol_block(const struct orl_sobol *sobol, uint32_t index,
                     const uint32_t seeds[ORL_SOBOL_BLOCK], struct orl_sobol_block *ret_block);

/*
 * Sines and cosines for sampling: inlined, without tables, and with the same bits on any machine
 * (the results of a C library vary with the processor's instructions). Taylor series up to the last
 * bit of an eighth of a turn; errors are within 3e-16.
 */

struct orl_sincos {
    double cosine, sine;
};

/* Returns cosine and sine of an angle in radians, -pi / 4 to pi / 4. */
static inline struct orl_sincos orl_sincos_small(double angle)
{
    const double a = angle * angle, b = a * a, c = b * b;
    const double sine = ((1 - a * (1.0 / 6)) + b * (1.0 / 120 - a * (1.0 / 5040))) +
                        c * ((1.0 / 362880 - a * (1.0 / 39916800)) +
                             b * (1.0 / 6227020800.0 - a * (1.0 / 1307674368000.0)));
    const double cosine =
        ((1 - 0.5 * a) + b * (1.0 / 24 - a * (1.0 / 720))) +
        c * ((1.0 / 40320 - a * (1.0 / 3628800)) +
             b * ((1.0 / 479001600.0 - a * (1.0 / 87178291200.0)) + b * (1.0 / 20922789888000.0)));
    return (struct orl_sincos){cosine, angle * sine};
}

/* Returns cosine and sine of a share of a whole turn, 0 to 1. */
static inline struct orl_sincos orl_sincos_turn(double turn)
{
    const int quarter = (int)(4 * turn + 0.5);
    const struct orl_sincos near = orl_sincos_small((turn - 0.25 * quarter) * 6.283185307179586);
    const double sign = quarter & 2 ? -1 : 1;
    return quarter & 1 ? (struct orl_sincos){-sign * near.sine, sign * near.cosine}
                       : (struct orl_sincos){sign * near.cosine, sign * near.sine};
}

/*
 * Weighted reservoir sampling (Chao 1982, Biometrika 69, 653): one of several candidates is sampled
 * by weight in one pass, with one random number.
 */

struct orl_reservoir {
    double weight_sum;
    double u; /* rescaled to a uniform number after each decision */
};

static inline struct orl_reservoir orl_reservoir_begin(uint64_t bits)
{
    return (struct orl_reservoir){0, (double)(bits >> 11) * 0x1p-53};
}

/* Returns true if the candidate replaces the one that was chosen before. */
static inline bool orl_reservoir_add(struct orl_reservoir *r, double weight)
{
    const double before = r->weight_sum;
    if (!(weight > 0))
        return false;
    r->weight_sum = before + weight;
    const double at = r->u * r->weight_sum;
    r->u = at < weight ? at / weight : (at - weight) / before;
    return at < weight;
}

/*
 * Low-discrepancy order of numbers, in which every range of indices is spread evenly over all
 * numbers. It consists of multiples of a stride that is near the golden section of their count, and
 * coprime to it. Work done in this order is representative at any time, so that the remaining time
 * can be estimated.
 */

/* Returns the stride for a count. */
static inline size_t orl_golden_stride(size_t count)
{
    size_t stride = (size_t)(0.6180339887498949 * (double)count);
    for (; stride > 1; stride--) {
        size_t a = count, b = stride;
        while (b > 0) {
            const size_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return stride;
    }
    return 1;
}

/* Returns the number at an index. Counts are below 2^32. */
static inline size_t orl_golden_order(size_t index, size_t stride, size_t count)
{
    return (index * stride) % count;
}

#endif

/*
 * Counter-based random numbers. A stream is keyed by (seed, purpose, index), never by a thread, so
 * that photon 17 or pixel (3, 4) gets the same numbers wherever and whenever it is computed. The
 * generator is SplitMix64 (Steele, Lea, Flood 2014) started at a hashed position.
 */
#ifndef ORL_BASE_SAMPLING_RANDOM_H
#define ORL_BASE_SAMPLING_RANDOM_H

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

#endif

/*
 * Owen-scrambled Sobol points for the first few dimensions of an emission or of a hemisphere.
 * Points are keyed by index, as orl_random streams are.
 *
 * Generator matrices are built from the primitive polynomials and initial numbers of Joe and Kuo
 * 2008. The scramble is the hash of Laine and Karras 2011 as improved by Vegdahl 2021, with the
 * index shuffled likewise for independent sequences (Burley 2020).
 */
#ifndef ORL_BASE_SAMPLING_SOBOL_H
#define ORL_BASE_SAMPLING_SOBOL_H

#include <stdint.h>

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

#endif

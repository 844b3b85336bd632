/*
 * Owen-scrambled Sobol points: the first few dimensions of an emission or of a hemisphere, filled
 * evenly. Points are named by index, as orl_random streams are.
 *
 * Generator matrices are made from the primitive polynomials and initial numbers of Joe and Kuo
 * 2008; the scramble is the hash of Laine and Karras 2011 as improved by Vegdahl 2021, with the
 * index shuffled likewise for independent sequences (Burley 2020).
 */
#ifndef ORL_BASE_SOBOL_H
#define ORL_BASE_SOBOL_H

#include <stdint.h>

enum { ORL_SOBOL_DIMENSIONS = 6 };

/* Constant once made, shared by all threads. */
struct orl_sobol {
    uint32_t by_byte[ORL_SOBOL_DIMENSIONS][4][256]; /* direction numbers, summed for every byte */
};

void orl_sobol_init(struct orl_sobol *sobol);

/* Fills ret_point with the first count coordinates, in [0, 1), of point index of sequence seed. */
void orl_sobol_point(const struct orl_sobol *sobol, uint32_t index, uint32_t seed, uint32_t count,
                     double *ret_point);

#endif

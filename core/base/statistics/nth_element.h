/* Selection of the k-th smallest number, in linear time (Hoare 1961). */
#ifndef ORL_BASE_STATISTICS_NTH_ELEMENT_H
#define ORL_BASE_STATISTICS_NTH_ELEMENT_H

#include <stddef.h>

/* Returns the k-th smallest of n values, k from 0 to n - 1. Reorders the values, which must not be
 * NaN. */
double orl_nth_element(double *values, size_t n, size_t k);

#endif

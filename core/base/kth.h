/* Selection of the k-th smallest number, in linear time (Hoare 1961). */
#ifndef ORL_BASE_KTH_H
#define ORL_BASE_KTH_H

#include <stddef.h>

/* Returns the k-th smallest of n values, k from 0 to n - 1. Reorders the values, which must not be
 * NaN. */
double orl_find_kth(double *values, size_t n, size_t k);

#endif

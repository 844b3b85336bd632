/* The k-th of some numbers, in time that grows with how many there are (Hoare 1961). */
#ifndef ORL_BASE_KTH_H
#define ORL_BASE_KTH_H

#include <stddef.h>

/* The k-th of n values from below, k from 0 to n - 1; they are put in another order. None is NaN.
 */
double orl_find_kth(double *values, size_t n, size_t k);

#endif

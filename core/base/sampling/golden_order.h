/*
 * Low-discrepancy order of numbers, in which every range of indices is spread evenly over all
 * numbers. It consists of multiples of a stride that is near the golden section of their count, and
 * coprime to it. Work done in this order is representative at any time, so that the remaining time
 * can be estimated.
 */
#ifndef ORL_BASE_SAMPLING_GOLDEN_ORDER_H
#define ORL_BASE_SAMPLING_GOLDEN_ORDER_H

#include <stddef.h>

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

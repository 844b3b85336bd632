#include "base/statistics/nth_element.h"

double orl_nth_element(double *values, size_t n, size_t k)
{
    size_t first = 0, last = n - 1;
    while (first < last) {
        const double pivot = values[first + (last - first) / 2];
        size_t low = first, high = last;
        for (;; low++, high--) {
            while (values[low] < pivot)
                low++;
            while (values[high] > pivot)
                high--;
            if (low >= high)
                break;
            const double swap = values[low];
            values[low] = values[high];
            values[high] = swap;
        }
        if (k <= high)
            last = high;
        else
            first = high + 1;
    }
    return values[k];
}

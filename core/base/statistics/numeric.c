#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

#include "base/statistics/numeric.h"

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

/* Block size for qsort. glibc's qsort is a merge sort, and stable, for blocks of this size; it uses
 * another method only if they would need a quarter of the memory. */
enum { BLOCK = 1 << 14 };

struct merge {
    size_t size;
    int (*compare)(const void *, const void *);
    const atomic_bool *cancel;
};

/* Merges [from, middle) and [middle, to) of source into target. Returns false if cancelled. */
static bool merge_runs(const struct merge *m, const char *source, char *target, size_t from,
                       size_t middle, size_t to)
{
    size_t a = from, b = middle;
    for (size_t at = from; at < to; at++) {
        if ((at - from) % BLOCK == 0 && orl_is_cancelled(m->cancel))
            return false;
        const bool first =
            b >= to || (a < middle && m->compare(source + a * m->size, source + b * m->size) <= 0);
        memcpy(target + at * m->size, source + (first ? a++ : b++) * m->size, m->size);
    }
    return true;
}

int orl_sort(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
             const atomic_bool *cancel)
{
    const struct merge m = {size, compare, cancel};
    char *source = items, *target = n > BLOCK ? malloc(n * size) : NULL, *const room = target;
    if (n > BLOCK && !target)
        return ORL_ERR_NOMEM;
    bool goes_on = !orl_is_cancelled(cancel);
    for (size_t at = 0; at < n && goes_on; at += BLOCK) {
        qsort(source + at * size, n - at < BLOCK ? n - at : BLOCK, size, compare);
        goes_on = !orl_is_cancelled(cancel);
    }
    for (size_t width = BLOCK; width < n && goes_on; width *= 2) {
        for (size_t from = 0; from < n && goes_on; from += 2 * width) {
            const size_t middle = n - from < width ? n : from + width;
            const size_t to = n - from < 2 * width ? n : from + 2 * width;
            goes_on = merge_runs(&m, source, target, from, middle, to);
        }
        char *const other = source;
        source = target;
        target = other;
    }
    if (goes_on && source != items)
        memcpy(items, source, n * size);
    free(room);
    return goes_on ? 0 : ORL_ERR_CANCELLED;
}

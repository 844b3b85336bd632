#include "bench/compare.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/base/vec.h>

#include "bench/bench.h"
#include "support/hdr.h"

void bench_reference_done(struct bench_reference *reference)
{
    free(reference->a);
    free(reference->b);
    *reference = (struct bench_reference){0};
}

static double at(const struct bench_reference *r, size_t i)
{
    return (r->a[i] + r->b[i]) / 2;
}

static double mean(const struct bench_reference *r)
{
    double sum = 0;
    for (size_t i = 0; i < r->n; i++)
        sum += at(r, i);
    return sum / (double)r->n;
}

static int falling(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Returns the root mean of the squares without the largest n_without. Reorders squares. */
static double root_mean(double *squares, size_t n, size_t n_without)
{
    double sum = 0;
    qsort(squares, n, sizeof *squares, falling);
    for (size_t i = n_without; i < n; i++)
        sum += squares[i];
    return n > n_without && sum > 0 ? sqrt(sum / (double)(n - n_without)) : 0;
}

struct bench_deviation bench_compare(const struct bench_reference *reference, const double *values,
                                     double darkest)
{
    const double least = darkest * mean(reference);
    struct bench_deviation d = {0};
    double *squares = malloc(reference->n * sizeof *squares), sum = 0;
    size_t n = 0;
    if (!squares)
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < reference->n; i++) {
        const double r = at(reference, i), x = values[i];
        if (!(r > least))
            continue;
        squares[n++] = (x - reference->a[i]) * (x - reference->b[i]) / (r * r);
        sum += (x - r) / r;
        if (fabs(x - r) / r > fabs(d.worst)) {
            d.worst = (x - r) / r;
            d.worst_at = i;
        }
    }
    d.rms = root_mean(squares, n, 0);
    d.rms_99 = root_mean(squares, n, (n + 99) / 100);
    d.bias = n > 0 ? sum / (double)n : 0;
    free(squares);
    return d;
}

double bench_reference_noise(const struct bench_reference *reference, double darkest)
{
    const double least = darkest * mean(reference);
    double squares = 0, n = 0;
    for (size_t i = 0; i < reference->n; i++) {
        const double r = at(reference, i), half = (reference->a[i] - reference->b[i]) / 2;
        if (!(r > least))
            continue;
        squares += half * half / (r * r);
        n++;
    }
    return n > 0 ? sqrt(squares / n) : 0;
}

/* Returns the mean of the pixels around one. */
static double local_mean(const struct bench_reference *r, int width, int x, int y)
{
    enum { ABOUT = 2 };
    const int height = (int)(r->n / (size_t)width);
    double sum = 0;
    int n = 0;
    for (int v = y - ABOUT; v <= y + ABOUT; v++) {
        for (int u = x - ABOUT; u <= x + ABOUT; u++) {
            if (u < 0 || v < 0 || u >= width || v >= height)
                continue;
            sum += at(r, (size_t)v * (size_t)width + (size_t)u);
            n++;
        }
    }
    return sum / n;
}

double bench_worst_pixels(const struct bench_reference *reference, const double *values, int width,
                          double percentile, double *ret_unsure)
{
    double *off = malloc(reference->n * sizeof *off);
    size_t unsure = 0;
    if (!off)
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < reference->n; i++) {
        const double local =
            local_mean(reference, width, (int)(i % (size_t)width), (int)(i / (size_t)width));
        const double noise = fabs(reference->a[i] - reference->b[i]) / 2;
        const bool sure = noise <= BENCH_UNSURE * local;
        const double by = values ? fabs(values[i] - at(reference, i)) : noise;
        off[i] = local > 0 && sure ? by / local : 0;
        unsure += !sure;
    }
    if (ret_unsure)
        *ret_unsure = (double)unsure / (double)reference->n;
    qsort(off, reference->n, sizeof *off, falling);
    const double worst = off[(size_t)((1 - percentile / 100) * (double)reference->n)];
    free(off);
    return worst;
}

double bench_bias_of_mean(const struct bench_reference *reference, const double *values)
{
    double sum = 0;
    for (size_t i = 0; i < reference->n; i++)
        sum += values[i];
    return sum / (double)reference->n / mean(reference) - 1;
}

double *bench_read_luminances(const char *path, int width, int height)
{
    const size_t n = (size_t)width * (size_t)height;
    double(*rgb)[3] = malloc(n * sizeof *rgb), *values = malloc(n * sizeof *values);
    if (!rgb || !values)
        bench_fail("out of memory", NULL);
    hdr_read(path, width, height, rgb);
    for (size_t i = 0; i < n; i++)
        values[i] =
            ORL_EFFICACY_LM_PER_W * orl_luma((struct orl_rgb){rgb[i][0], rgb[i][1], rgb[i][2]});
    free(rgb);
    return values;
}

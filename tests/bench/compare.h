/*
 * Errors of sensors and images against a reference that is itself noisy.
 *
 * The reference comes in two halves, A and B, rendered independently. With X the result, T the
 * truth and the halves' noises independent of each other and of X, the mean of (X - A)(X - B) is
 * the mean of (X - T)^2: the reference's own noise drops out, whatever it is. So errors are taken
 * relative to R = (A + B) / 2:
 *   rms  = sqrt(mean over places of (X - A)(X - B) / R^2)
 *   bias = sum(X - R) / sum(R) for images, mean((X - R) / R) for sensors
 *   own  = sqrt(mean(((A - B) / 2)^2 / R^2)), the standard error of R itself, for printing beside.
 * An rms far below `own` is uncertain: where the mean comes out negative it is given as 0.
 */
#ifndef ORL_TESTS_BENCH_COMPARE_H
#define ORL_TESTS_BENCH_COMPARE_H

#include <stddef.h>

struct bench_reference {
    double *a, *b; /* the halves; owned */
    size_t n;
};

struct bench_deviation {
    double rms, bias;
    double rms_99; /* without the worst hundredth of places: what a few at edges do not decide */
    double worst;  /* the largest (X - R) / R, with its sign */
    size_t worst_at;
};

void bench_reference_done(struct bench_reference *reference);

/* Places darker than that share of the mean are left out, and so are no places when it is 0. */
struct bench_deviation bench_compare(const struct bench_reference *reference, const double *values,
                                     double darkest);
/* `own` above. */
double bench_reference_noise(const struct bench_reference *reference, double darkest);

/*
 * Of an image: stitches and specks are few pixels that are far off what is about them. Every
 * pixel's |X - R| over the mean of R in the 5 x 5 pixels about it (fewer at the border), and of
 * these the percentile. R's own noise is in it; with values NULL it is that alone: |A - B| / 2.
 * Pixels where that is more than BENCH_UNSURE tell nothing of X and count as if they were met:
 * where a few of a thousand paths find the sun, R is whatever it is by chance. ret_unsure, or NULL:
 * how many of all they are.
 */
#define BENCH_UNSURE 0.1
double bench_worst_pixels(const struct bench_reference *reference, const double *values, int width,
                          double percentile, double *ret_unsure);

/* The bias of an image: of its mean. */
double bench_bias_of_mean(const struct bench_reference *reference, const double *values);

/* Luminances, cd/m2, of an HDR image of that size; the caller's to free. */
double *bench_read_luminances(const char *path, int width, int height);

#endif

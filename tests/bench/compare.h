/*
 * Errors of sensors and images against a noisy reference.
 *
 * The reference comes in two halves, A and B, rendered independently. X is the result, T the truth;
 * the noises of the halves are independent of each other and of X. Then the mean of (X - A)(X - B)
 * is the mean of (X - T)^2: the reference's own noise drops out, whatever it is. So errors are
 * taken relative to R = (A + B) / 2:
 *
 * rms  = sqrt(mean over places of (X - A)(X - B) / R^2)
 * bias = sum(X - R) / sum(R) for images, mean((X - R) / R) for sensors
 * own  = sqrt(mean(((A - B) / 2)^2 / R^2)), the standard error of R itself, printed beside these
 *
 * An rms far below `own` is uncertain: a negative mean is reported as 0.
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
    double rms_99; /* rms without the worst hundredth of places, so that few places at edges do not
                      dominate */
    double worst;  /* the largest (X - R) / R, with its sign */
    size_t worst_at;
};

void bench_reference_done(struct bench_reference *reference);

/* Compares values with the reference. Places darker than that share of the mean are left out; 0
 * keeps all. */
struct bench_deviation bench_compare(const struct bench_reference *reference, const double *values,
                                     double darkest);
/* Returns `own` of the head comment. */
double bench_reference_noise(const struct bench_reference *reference, double darkest);

/*
 * Outliers of an image: stitches and specks are few pixels far off their neighbourhood. Returns a
 * percentile of |X - R| over the mean of R in the 5 x 5 pixels around each pixel (fewer at the
 * border). R's own noise is included; with values NULL it is the only part: |A - B| / 2. Pixels
 * where that noise exceeds BENCH_UNSURE carry no information on X and count as correct: if few of a
 * thousand paths find the sun, R is arbitrary there. ret_unsure (may be NULL): their number.
 */
#define BENCH_UNSURE 0.1
double bench_worst_pixels(const struct bench_reference *reference, const double *values, int width,
                          double percentile, double *ret_unsure);

/* Returns the bias of an image's mean. */
double bench_bias_of_mean(const struct bench_reference *reference, const double *values);

/* Returns the luminances, cd/m2, of an HDR image of that size; the caller frees them. */
double *bench_read_luminances(const char *path, int width, int height);

#endif

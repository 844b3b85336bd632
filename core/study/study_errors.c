#include "study/study_errors.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics/numeric.h"

/* Lower bound of the divisor of differences, as a share of the mean. */
static const double sensor_floor = 1e-3, pixel_floor = 0.1;
/* Sensors with a larger relative error of the reference are left out. */
static const double worst_known = 0.01;
/* Share of rms^2 above which the reference's own noise is reported to matter. */
static const double reference_share = 0.25;

void orl_reference_done(struct orl_reference *reference)
{
    free(reference->value);
    free(reference->error);
    free(reference->scale);
    *reference = (struct orl_reference){0};
}

static double mean_of(const double *values, size_t count)
{
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < count; i++)
        orl_sum_add(&sum, values[i]);
    return orl_sum_value(&sum) / (double)count;
}

/* Computes mean and standard error of value k over the runs. */
static void combine_runs(struct orl_reference *reference, size_t k, double *const *runs,
                         size_t n_runs)
{
    const double n = (double)n_runs;
    double sum = 0, squares = 0;
    for (size_t i = 0; i < n_runs; i++)
        sum += runs[i][k];
    for (size_t i = 0; i < n_runs; i++)
        squares += (runs[i][k] - sum / n) * (runs[i][k] - sum / n);
    reference->value[k] = sum / n;
    reference->error[k] = n_runs > 1 ? sqrt(squares / (n * (n - 1))) : 0;
}

static void choose_scales(struct orl_reference *reference, bool of_views)
{
    const double mean = mean_of(reference->value, reference->count);
    const double least = mean * (of_views ? pixel_floor : sensor_floor);
    for (size_t k = 0; k < reference->count; k++) {
        const double scale = fmax(reference->value[k], least);
        const bool known = isfinite(scale) && scale > 0 &&
                           (of_views || reference->error[k] <= worst_known * scale);
        reference->scale[k] = known ? scale : 0;
        reference->used += known;
    }
}

int orl_reference_make(struct orl_reference *ret_reference, double *const *runs, size_t n_runs,
                       const double *errors, size_t count, bool of_views, struct orl_error *err)
{
    struct orl_reference reference = {.count = count,
                                      .value = calloc(count + 1, sizeof(double)),
                                      .error = calloc(count + 1, sizeof(double)),
                                      .scale = calloc(count + 1, sizeof(double))};
    if (!reference.value || !reference.error || !reference.scale) {
        orl_reference_done(&reference);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a reference");
    }
    for (size_t k = 0; k < count; k++) {
        combine_runs(&reference, k, runs, n_runs);
        if (errors)
            reference.error[k] = errors[k];
    }
    choose_scales(&reference, of_views);
    if (reference.used == 0) {
        orl_reference_done(&reference);
        orl_error_set(err, ORL_ERR_INVALID,
                      "no value of the reference is accurate enough for a comparison");
        orl_error_hint(err, "Give the reference more samples, or add light to the scene");
        return ORL_ERR_INVALID;
    }
    *ret_reference = reference;
    return 0;
}

/* Mean of s^2, the squared relative errors of the reference. */
static double own_share(const struct orl_reference *reference)
{
    struct orl_sum sum = {0, 0};
    for (size_t k = 0; k < reference->count; k++) {
        const double s = reference->scale[k] > 0 ? reference->error[k] / reference->scale[k] : 0;
        orl_sum_add(&sum, s * s);
    }
    return orl_sum_value(&sum) / (double)reference->used;
}

void orl_reference_describe(const struct orl_reference *reference, struct orl_study_reference *ret)
{
    ret->values = reference->used;
    ret->left_out = reference->count - reference->used;
    ret->standard_error = sqrt(own_share(reference));
    ret->worst = 0;
    for (size_t k = 0; k < reference->count; k++)
        if (reference->scale[k] > 0)
            ret->worst = fmax(ret->worst, reference->error[k] / reference->scale[k]);
}

/* Errors of all runs, without values that are left out; run i starts at i * used. */
struct errors {
    const struct orl_reference *reference;
    size_t used, n_runs;
    double *e;       /* owned */
    double *scratch; /* owned; same size */
};

static int errors_init(struct errors *errors, const struct orl_reference *reference,
                       double *const *runs, size_t n_runs, struct orl_error *err)
{
    const size_t used = reference->used;
    *errors = (struct errors){reference, used, n_runs, calloc(used * n_runs, sizeof(double)),
                              calloc(used * n_runs, sizeof(double))};
    if (!errors->e || !errors->scratch)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for errors");
    for (size_t i = 0; i < n_runs; i++)
        for (size_t k = 0, at = 0; k < reference->count; k++)
            if (reference->scale[k] > 0)
                errors->e[i * used + at++] =
                    (runs[i][k] - reference->value[k]) / reference->scale[k];
    return 0;
}

/* Returns the value below which that share of |e| lies. */
static double percentile(struct errors *errors, double share)
{
    const size_t count = errors->used * errors->n_runs;
    for (size_t i = 0; i < count; i++)
        errors->scratch[i] = fabs(errors->e[i]);
    return orl_nth_element(errors->scratch, count, (size_t)ceil(share * (double)count) - 1);
}

/* Returns the mean over seeds of the largest |e| in the brightest percent of the reference. */
static double peak_error(struct errors *errors)
{
    const struct orl_reference *reference = errors->reference;
    const size_t n = errors->used;
    double sum = 0;
    size_t at = 0;
    for (size_t k = 0; k < reference->count; k++)
        if (reference->scale[k] > 0)
            errors->scratch[at++] = reference->value[k];
    const double bright = orl_nth_element(errors->scratch, n, n - (n + 99) / 100);
    for (size_t i = 0; i < errors->n_runs; i++) {
        double most = 0;
        at = 0;
        for (size_t k = 0; k < reference->count; k++) {
            if (reference->scale[k] <= 0)
                continue;
            const double e = fabs(errors->e[i * n + at++]);
            most = reference->value[k] >= bright ? fmax(most, e) : most;
        }
        sum += most;
    }
    return sum / (double)errors->n_runs;
}

/* Returns the mean over values of the variance between runs. */
static double variance_between(const struct errors *errors)
{
    const double runs = (double)errors->n_runs;
    struct orl_sum sum = {0, 0};
    if (errors->n_runs < 2)
        return NAN;
    for (size_t k = 0; k < errors->used; k++) {
        double mean = 0, squares = 0;
        for (size_t i = 0; i < errors->n_runs; i++)
            mean += errors->e[i * errors->used + k] / runs;
        for (size_t i = 0; i < errors->n_runs; i++) {
            const double d = errors->e[i * errors->used + k] - mean;
            squares += d * d;
        }
        orl_sum_add(&sum, squares / (runs - 1));
    }
    return orl_sum_value(&sum) / (double)errors->used;
}

/* Standard error of the mean of a few numbers; NaN for one number. */
static double error_of_mean(const double *values, size_t count)
{
    const double mean = mean_of(values, count);
    double squares = 0;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    return count > 1 ? sqrt(squares / ((double)count * (double)(count - 1))) : NAN;
}

/* Computes the mean of e, and the mean of e^2, for each run. */
static void compute_means(const struct errors *errors, double *biases, double *squares)
{
    for (size_t i = 0; i < errors->n_runs; i++) {
        const double *e = errors->e + i * errors->used;
        struct orl_sum sum = {0, 0}, sum2 = {0, 0};
        for (size_t k = 0; k < errors->used; k++) {
            orl_sum_add(&sum, e[k]);
            orl_sum_add(&sum2, e[k] * e[k]);
        }
        biases[i] = orl_sum_value(&sum) / (double)errors->used;
        squares[i] = orl_sum_value(&sum2) / (double)errors->used;
    }
}

static void fill_point(struct errors *errors, const double *biases, const double *squares,
                       bool of_views, struct orl_study_point *point)
{
    const double own = own_share(errors->reference), all = mean_of(squares, errors->n_runs);
    /* The lower bound is the variance between seeds. The difference of two means may be negative by
     * chance, a variance is not. */
    const double variance = variance_between(errors);
    const double least = isnan(variance) ? 0 : variance;
    point->rms = sqrt(fmax(all - own, fmin(least, all)));
    point->reference_shows = own > reference_share * point->rms * point->rms;
    /* rms^2 is a mean over seeds; d rms = d rms^2 / (2 rms). */
    point->rms_error =
        point->rms > 0 ? error_of_mean(squares, errors->n_runs) / (2 * point->rms) : NAN;
    point->bias = mean_of(biases, errors->n_runs);
    const double seeds = error_of_mean(biases, errors->n_runs);
    point->bias_error = sqrt(seeds * seeds + own / (double)errors->used);
    point->noise = sqrt(variance);
    point->p95 = percentile(errors, 0.95);
    point->peak = of_views ? peak_error(errors) : NAN;
}

int orl_study_compute_errors(const struct orl_reference *reference, double *const *runs,
                             size_t n_runs, bool of_views, struct orl_study_point *point,
                             struct orl_error *err)
{
    struct errors errors;
    double *biases = calloc(2 * n_runs, sizeof(double));
    if (!biases)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const int code = errors_init(&errors, reference, runs, n_runs, err);
    if (code == 0) {
        compute_means(&errors, biases, biases + n_runs);
        fill_point(&errors, biases, biases + n_runs, of_views, point);
    }
    free(errors.e);
    free(errors.scratch);
    free(biases);
    return code;
}

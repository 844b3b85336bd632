#include "study/error_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/random.h"

enum { REFITS = 400, PASSES = 8 };
static const double least_uncertainty = 0.1;

const char *orl_fit_term_name(enum orl_fit_term term)
{
    static const char *const names[ORL_FIT_TERMS] = {"kernel", "spread", "bias", "samples"};
    return names[term];
}

/* Returns the factor of the term's coefficient in the model. */
static double factor_of(enum orl_fit_term term, const struct orl_study_setting *setting)
{
    const double n = (double)setting->photons, s = setting->samples;
    switch (term) {
    case ORL_FIT_SPREAD:
        return 1 / n;
    case ORL_FIT_BIAS:
        return 1 / (n * n);
    case ORL_FIT_SAMPLES:
        return 1 / s;
    default:
        return 1;
    }
}

double orl_study_fit_predict(const struct orl_study_fit *fit,
                             const struct orl_study_setting *setting)
{
    double sum = 0;
    for (int t = 0; t < ORL_FIT_TERMS; t++)
        if (!isnan(fit->terms[t]))
            sum += fit->terms[t] * factor_of((enum orl_fit_term)t, setting);
    return isfinite(sum) ? sqrt(sum) : NAN;
}

/* Least-squares problem for the points of one technique. */
struct problem {
    size_t rows, columns;
    enum orl_fit_term terms[ORL_FIT_TERMS]; /* by column */
    struct orl_study_setting *settings;     /* owned, like y, whose block holds the arrays below */
    double *y, *s;                          /* rms^2, and its relative uncertainty */
    double *a, *b;                          /* scratch: the weighted problem */
    double *model;
};

static void problem_done(struct problem *p)
{
    free(p->settings);
    free(p->y);
}

/* Counts distinct values; more than 3 count as 3. */
static size_t count_distinct(const struct problem *p, bool of_samples)
{
    double seen[3] = {0};
    size_t n = 0;
    for (size_t i = 0; i < p->rows && n < 3; i++) {
        const struct orl_study_setting *s = &p->settings[i];
        const double value = of_samples ? (double)s->samples : (double)s->photons;
        bool known = !(value > 0);
        for (size_t k = 0; k < n; k++)
            known = known || seen[k] == value;
        if (!known)
            seen[n++] = value;
    }
    return n;
}

static void choose_terms(struct problem *p)
{
    const size_t photons = count_distinct(p, false), samples = count_distinct(p, true);
    p->terms[p->columns++] = ORL_FIT_KERNEL;
    if (photons > 1)
        p->terms[p->columns++] = ORL_FIT_SPREAD;
    if (photons > 2)
        p->terms[p->columns++] = ORL_FIT_BIAS;
    if (samples > 1)
        p->terms[p->columns++] = ORL_FIT_SAMPLES;
}

static int problem_init(struct problem *p, const struct orl_study_point *points, size_t n,
                        enum orl_technique technique, struct orl_error *err)
{
    memset(p, 0, sizeof *p);
    p->settings = calloc(n + 1, sizeof *p->settings);
    p->y = calloc((n + 1) * (4 + ORL_FIT_TERMS), sizeof(double));
    if (!p->settings || !p->y)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a fit");
    p->s = p->y + n;
    p->b = p->s + n;
    p->model = p->b + n;
    p->a = p->model + n;
    for (size_t i = 0; i < n; i++) {
        if (points[i].setting.technique != technique || !(points[i].rms > 0))
            continue;
        const double s = 2 * points[i].rms_error / points[i].rms;
        p->settings[p->rows] = points[i].setting;
        p->y[p->rows] = points[i].rms * points[i].rms;
        p->s[p->rows++] = s > least_uncertainty ? s : least_uncertainty;
    }
    choose_terms(p);
    return 0;
}

static void evaluate_model(struct problem *p, const double *x)
{
    for (size_t i = 0; i < p->rows; i++) {
        p->model[i] = 0;
        for (size_t c = 0; c < p->columns; c++)
            p->model[i] += x[c] * factor_of(p->terms[c], &p->settings[i]);
    }
}

/* Fits coefficients to the data y, which need not be the problem's own. */
static void fit_coefficients(struct problem *p, const double *y, double x[ORL_FIT_TERMS])
{
    double largest[ORL_FIT_TERMS];
    memcpy(p->model, y, p->rows * sizeof(double));
    for (int pass = 0; pass < PASSES; pass++) {
        for (size_t c = 0; c < p->columns; c++)
            largest[c] = 0;
        for (size_t i = 0; i < p->rows; i++) {
            const double w = 1 / (p->s[i] * p->model[i]);
            p->b[i] = w * y[i];
            for (size_t c = 0; c < p->columns; c++) {
                p->a[i * p->columns + c] = w * factor_of(p->terms[c], &p->settings[i]);
                largest[c] = fmax(largest[c], p->a[i * p->columns + c]);
            }
        }
        /* Columns differ by many powers of ten, so they are scaled to equal size. */
        for (size_t i = 0; i < p->rows * p->columns; i++)
            p->a[i] /= largest[i % p->columns];
        orl_nnls(p->a, p->b, p->rows, p->columns, x);
        for (size_t c = 0; c < p->columns; c++)
            x[c] /= largest[c];
        evaluate_model(p, x);
    }
}

/* Returns a standard normal variate, by Box and Muller. */
static double draw_normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(2 * ORL_PI * v);
}

/* Computes the spread of coefficients over refits to data redrawn around the model. */
static void bootstrap_errors(struct problem *p, const double *x, double widened,
                             double ret_errors[ORL_FIT_TERMS], double *scratch)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_REFIT, p->rows);
    double *const mean = scratch, *const y = scratch + p->rows;
    double again[ORL_FIT_TERMS];
    evaluate_model(p, x);
    memcpy(mean, p->model, p->rows * sizeof(double));
    memset(ret_errors, 0, ORL_FIT_TERMS * sizeof(double));
    for (int refit = 0; refit < REFITS; refit++) {
        for (size_t i = 0; i < p->rows; i++) {
            /* log-normal, because a square cannot be negative */
            const double s = widened * p->s[i];
            y[i] = mean[i] * exp(s * draw_normal(&random) - 0.5 * s * s);
        }
        fit_coefficients(p, y, again);
        for (size_t c = 0; c < p->columns; c++)
            ret_errors[c] += (again[c] - x[c]) * (again[c] - x[c]) / REFITS;
    }
    for (size_t c = 0; c < p->columns; c++)
        ret_errors[c] = sqrt(ret_errors[c]);
}

static void compute_residuals(struct problem *p, const double *x, struct orl_study_fit *fit)
{
    double chi2 = 0, logs = 0;
    evaluate_model(p, x);
    for (size_t i = 0; i < p->rows; i++) {
        const double d = (p->y[i] / p->model[i] - 1) / p->s[i];
        chi2 += d * d;
        logs += log(p->y[i] / p->model[i]) * log(p->y[i] / p->model[i]);
    }
    fit->chi2 = p->rows > p->columns ? chi2 / (double)(p->rows - p->columns) : NAN;
    fit->residual = sqrt(logs / (double)p->rows);
}

int orl_study_fit_make(const struct orl_study_point *points, size_t n_points,
                       enum orl_technique technique, struct orl_study_fit *ret_fit,
                       struct orl_error *err)
{
    struct problem p;
    struct orl_study_fit fit = {.technique = technique};
    double x[ORL_FIT_TERMS], errors[ORL_FIT_TERMS], *scratch = NULL;
    int code = problem_init(&p, points, n_points, technique, err);
    if (code < 0 || p.rows < 2 || p.rows < p.columns)
        goto done;
    scratch = calloc(2 * p.rows, sizeof(double));
    if (!scratch) {
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a fit");
        goto done;
    }
    fit_coefficients(&p, p.y, x);
    compute_residuals(&p, x, &fit);
    bootstrap_errors(&p, x, fit.chi2 > 1 ? sqrt(fit.chi2) : 1, errors, scratch);
    fit.points = p.rows;
    for (int t = 0; t < ORL_FIT_TERMS; t++)
        fit.terms[t] = fit.errors[t] = NAN;
    for (size_t c = 0; c < p.columns; c++) {
        fit.terms[p.terms[c]] = x[c];
        fit.errors[p.terms[c]] = errors[c];
    }
    *ret_fit = fit;
    code = 1;
done:
    free(scratch);
    problem_done(&p);
    return code;
}

void orl_study_mark_front(struct orl_study_point *points, size_t n_points)
{
    for (size_t i = 0; i < n_points; i++) {
        const struct orl_study_point *p = &points[i];
        bool beaten = !isfinite(p->rms) || !isfinite(p->total_s);
        for (size_t k = 0; k < n_points && !beaten; k++) {
            const struct orl_study_point *q = &points[k];
            /* The first of several equal points stays. */
            const bool better = q->total_s < p->total_s || q->rms < p->rms || k < i;
            beaten = k != i && q->total_s <= p->total_s && q->rms <= p->rms && better;
        }
        points[i].on_front = !beaten;
    }
}

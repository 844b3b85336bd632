/* Error model of a technique, fitted by non-negative least squares; the Pareto front. */
#include "study/study_errors.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"

/* ---- Least squares --------------------------------------------------------------------------- */

/*
 * Non-negative least squares for a few columns, by the active-set method of Lawson and Hanson
 * (1974, chapter 23). Columns enter one by one, the steepest descent first. They leave when the
 * unconstrained solution would make them negative.
 */
struct nnls {
    size_t n;
    double gram[ORL_NNLS_COLUMNS][ORL_NNLS_COLUMNS]; /* A^T A */
    double right[ORL_NNLS_COLUMNS];                  /* A^T b */
    bool free[ORL_NNLS_COLUMNS];                     /* true if the column is not held at zero */
};

static void form_normal_equations(struct nnls *s, const double *a, const double *b, size_t rows,
                                  size_t columns)
{
    memset(s, 0, sizeof *s);
    s->n = columns;
    for (size_t i = 0; i < rows; i++) {
        const double *row = a + i * columns;
        for (size_t j = 0; j < columns; j++) {
            s->right[j] += row[j] * b[i];
            for (size_t k = 0; k < columns; k++)
                s->gram[j][k] += row[j] * row[k];
        }
    }
}

/* Solves the normal equations of the free columns by Cholesky decomposition. A column that depends
 * linearly on those before it gets 0. */
static void solve_free(const struct nnls *s, double z[ORL_NNLS_COLUMNS])
{
    double l[ORL_NNLS_COLUMNS][ORL_NNLS_COLUMNS] = {{0}}, y[ORL_NNLS_COLUMNS];
    size_t index[ORL_NNLS_COLUMNS], m = 0;
    for (size_t j = 0; j < s->n; j++) {
        z[j] = 0;
        if (!s->free[j])
            continue;
        double rest = s->gram[j][j], right = s->right[j];
        for (size_t k = 0; k < m; k++) {
            double dot = s->gram[j][index[k]];
            for (size_t i = 0; i < k; i++)
                dot -= l[m][i] * l[k][i];
            l[m][k] = dot / l[k][k];
            rest -= l[m][k] * l[m][k];
            right -= l[m][k] * y[k];
        }
        if (rest <= 64 * DBL_EPSILON * s->gram[j][j])
            continue;
        l[m][m] = sqrt(rest);
        y[m] = right / l[m][m];
        index[m++] = j;
    }
    for (size_t k = m; k-- > 0;) {
        double rest = y[k];
        for (size_t i = k + 1; i < m; i++)
            rest -= l[i][k] * z[index[i]];
        z[index[k]] = rest / l[k][k];
    }
}

/* Frees the column along which the sum of squares decreases most; returns false at the minimum. */
static bool set_free(struct nnls *s, const double *x)
{
    double most = 0;
    size_t best = s->n;
    for (size_t j = 0; j < s->n; j++) {
        double descent = s->right[j];
        for (size_t k = 0; k < s->n; k++)
            descent -= s->gram[j][k] * x[k];
        descent /= sqrt(fmax(s->gram[j][j], DBL_MIN));
        if (!s->free[j] && descent > most) {
            most = descent;
            best = j;
        }
    }
    /* A remainder due to rounding in A^T b is no descent. */
    if (best == s->n || most <= 1e-12 * fabs(s->right[best]) / sqrt(s->gram[best][best]))
        return false;
    s->free[best] = true;
    return true;
}

/* Moves x towards z until the first free column reaches zero, and holds that column. Returns true
 * if none did. */
static bool advance_to_bound(struct nnls *s, double *x, const double *z)
{
    double step = 1;
    size_t first = s->n;
    for (size_t j = 0; j < s->n; j++) {
        if (!s->free[j] || z[j] > 0)
            continue;
        const double t = x[j] > 0 ? x[j] / (x[j] - z[j]) : 0;
        if (first == s->n || t < step) {
            step = t;
            first = j;
        }
    }
    for (size_t j = 0; j < s->n; j++)
        x[j] += s->free[j] ? step * (z[j] - x[j]) : 0;
    if (first == s->n)
        return true;
    s->free[first] = false;
    x[first] = 0;
    return false;
}

void orl_nnls(const double *a, const double *b, size_t rows, size_t columns, double *ret_x)
{
    struct nnls s;
    double z[ORL_NNLS_COLUMNS];
    form_normal_equations(&s, a, b, rows, columns);
    for (size_t j = 0; j < columns; j++)
        ret_x[j] = 0;
    /* Every pass ends with a different set of columns. Rounding may repeat one, so the number of
     * passes is limited. */
    for (size_t pass = 0; pass < 4 * columns && set_free(&s, ret_x); pass++) {
        do
            solve_free(&s, z);
        while (!advance_to_bound(&s, ret_x, z));
    }
}

/* ---- The model ------------------------------------------------------------------------------- */

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

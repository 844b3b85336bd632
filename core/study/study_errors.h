/* Errors of a study: measures against the reference, and the error model fitted to them. */
#ifndef ORL_STUDY_STUDY_ERRORS_H
#define ORL_STUDY_STUDY_ERRORS_H

#include <oriel/job/study.h>

/*
 * Errors of runs against a reference: the measures that oriel/job/study.h defines.
 *
 * Values are arrays of equal length, one value per sensor (lux) or pixel (luminance). A reference
 * is made from one run with known standard errors, or from several whose spread gives them.
 */

struct orl_reference {
    size_t count;
    double *value, *error; /* owned; error: standard error of value */
    double *scale;         /* owned; divisor of differences; 0: the value is left out */
    size_t used;           /* number of values not left out */
};

/* Accepts a reference that is all zeros. */
void orl_reference_done(struct orl_reference *reference);

/*
 * Makes a reference from runs[i][k], value k of run i: the means, with standard errors from the
 * runs' spread. If there is one run, its standard errors are in errors. Copies all values. Returns
 * 0, ORL_ERR_NOMEM, or ORL_ERR_INVALID if all values are dark or too uncertain for a comparison.
 */
int orl_reference_make(struct orl_reference *ret_reference, double *const *runs, size_t n_runs,
                       const double *errors, size_t count, bool of_views, struct orl_error *err);

/* Fills in standard_error, worst, values and left_out. */
void orl_reference_describe(const struct orl_reference *reference, struct orl_study_reference *ret);

/* Fills in the point's measures of error, from n_runs runs. Returns 0 or ORL_ERR_NOMEM. */
int orl_study_compute_errors(const struct orl_reference *reference, double *const *runs,
                             size_t n_runs, bool of_views, struct orl_study_point *point,
                             struct orl_error *err);

/*
 * Error model of a technique, fitted to measured points.
 *
 * The theory of density estimates (Silverman 1986; Hachisuka et al. 2010) has, for N photons and a
 * kernel of radius r,  rms^2 = a / (N r^2) + b r^4. Monte Carlo over S samples adds c / S. A study
 * knows N and S, but not r. Estimates use the k photons nearest to a point, with k fixed. Hence r^2
 * = k / (pi rho), where the photon density rho is proportional to N. This gives:
 *     a / (N r^2)  becomes a constant: k photons have the same noise at any N   "kernel"
 *     b r^4        becomes b' / N^2                                             "bias"
 *     c / S        stays                                                        "samples"
 * A final gather sees whole surfaces: it averages kernels over areas that do not shrink with N. For
 * those areas r is fixed:
 *     a / (N r^2)  becomes a' / N                                               "spread"
 * The model has these four terms, none of them negative. "kernel" also contains all errors that
 * neither photons nor samples reduce. For the backward technique only S varies, and "kernel"
 * contains everything except "samples". Terms that a study cannot separate are absent, and the
 * others include their share. With one N these are spread and bias, with two N bias, and with one S
 * samples.
 *
 * A technique that widens its kernel by the optimum r^2 ~ N^(-1/3) has rms^2 ~ N^(-2/3) throughout.
 * The terms then approximate that over the measured range, and the residual shows how well.
 *
 * The fit minimises the squares of (y - m) / (m s). Here y is the measured rms^2, m the model's,
 * and s the relative uncertainty of y. Division by y instead of m would favour points that are low
 * by chance. m starts as y and is updated over a few passes. Each pass is a problem of non-negative
 * least squares (Lawson and Hanson 1974, chapter 23). Uncertainties are the spread of terms over
 * refits to data redrawn around the model (parametric bootstrap, fixed seed). Unlike a covariance
 * matrix, they respect the bound at zero.
 */

/* Non-negative least squares: minimises |A x - b| with x >= 0. A is rows x columns, stored
 * by rows. */
enum { ORL_NNLS_COLUMNS = 8 };
void orl_nnls(const double *a, const double *b, size_t rows, size_t columns, double *ret_x);

/*
 * Fits the points of the given technique. s is twice the relative error of rms, and at least 10 %,
 * also if that error is not known. A spread over few seeds is itself uncertain. Returns 1 after a
 * fit (at least as many points as terms), 0 if there were too few points, or ORL_ERR_NOMEM.
 */
int orl_study_fit_make(const struct orl_study_point *points, size_t n_points,
                       enum orl_technique technique, struct orl_study_fit *ret_fit,
                       struct orl_error *err);

/* Marks the Pareto front: the points that no other one beats in both time and rms. */
void orl_study_mark_front(struct orl_study_point *points, size_t n_points);

#endif

/*
 * What a technique's error is made of, fitted to measured points.
 *
 * The theory of density estimates (Silverman 1986; Hachisuka et al. 2010) has, for N photons and a
 * kernel of radius r,  rms^2 = a / (N r^2) + b r^4,  and Monte Carlo over S samples adds c / S. A
 * study knows N and S, but no r: estimates take the k photons nearest to a point, with k fixed, so
 * that r^2 = k / (pi rho), rho being the photons' density, in proportion to N. Put in:
 *     a / (N r^2)  becomes a constant: k photons are as noisy at any N          "kernel"
 *     b r^4        becomes b' / N^2                                             "bias"
 *     c / S        stays                                                        "samples"
 * A final gather looks at whole surfaces: it averages kernels over areas that do not shrink with
 * N. For those r is fixed, and a / (N r^2) becomes a' / N                       "spread"
 * That is the model: four terms, none of them negative. "kernel" also holds whatever neither
 * photons nor samples mend; of the backward technique, whose S varies alone, all but "samples". A
 * study at one N cannot tell spread or bias from kernel, one at two cannot tell bias from spread,
 * one at one S cannot tell samples: such terms are absent, and the others hold what is theirs.
 *
 * A technique that widens its kernel by the optimum r^2 ~ N^(-1/3) has rms^2 ~ N^(-2/3) throughout;
 * the terms then imitate that over the range measured, and the residual tells how well.
 *
 * Least squares of (y - m) / (m s), y = rms^2 measured, m the model's and s the relative
 * uncertainty of y: dividing by what was measured would favour points that are low by chance. m
 * starts as y and is found again a few times. Each pass is a problem of non-negative least squares
 * (Lawson and Hanson 1974, chapter 23). Uncertainties are the spread of terms over refits to data
 * redrawn about the model (parametric bootstrap, fixed seed), which unlike a covariance
 * matrix knows of the bound at zero.
 */
#ifndef ORL_STUDY_FIT_H
#define ORL_STUDY_FIT_H

#include <oriel/study.h>

/* Non-negative least squares: minimises |A x - b|, x >= 0, of rows x columns, A by rows. */
enum { ORL_NNLS_COLUMNS = 8 };
void orl_nnls(const double *a, const double *b, size_t rows, size_t columns, double *ret_x);

/*
 * Fits the points that are of the technique. s is twice the relative error of rms, or 10 % where
 * that is smaller or not known: seeds are few, and their spread is itself uncertain.
 * Returns 1 when there was something to fit (at least as many points as terms), 0 when not, or
 * ORL_ERR_NOMEM.
 */
int orl_study_fit_make(const struct orl_study_point *points, size_t n_points,
                       enum orl_technique technique, struct orl_study_fit *ret_fit,
                       struct orl_error *err);

/* Marks the points that no other one beats in both time and rms. */
void orl_study_mark_front(struct orl_study_point *points, size_t n_points);

#endif

/*
 * Errors of runs against a reference: the measures that oriel/job/study.h defines.
 *
 * Values are arrays of equal length, one value per sensor (lux) or pixel (luminance). A reference
 * is made from one run with known standard errors, or from several whose spread gives them.
 */
#ifndef ORL_STUDY_STUDY_ERRORS_H
#define ORL_STUDY_STUDY_ERRORS_H

#include <oriel/job/study.h>

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

#endif

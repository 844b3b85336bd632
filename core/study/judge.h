/*
 * Values of runs against values of a reference: the measures that oriel/study.h defines.
 *
 * Both are arrays of the same length, a value per sensor (lux) or pixel (luminance). A reference is
 * gathered from one run that knows its standard errors, or from several whose spread tells them.
 */
#ifndef ORL_STUDY_JUDGE_H
#define ORL_STUDY_JUDGE_H

#include <oriel/study.h>

struct orl_reference {
    size_t count;
    double *value, *error; /* owned; error: standard error of value */
    double *scale;         /* owned; what differences are divided by; 0: left out */
    size_t used;           /* those not left out */
};

/* All zeros is a reference of nothing, which done accepts. */
void orl_reference_done(struct orl_reference *reference);

/*
 * From runs[i][k], value k of run i: means, and standard errors by the runs' spread; or, of one
 * run, with the standard errors that it knew. Copies. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_INVALID
 * when all is dark or known too badly to compare with.
 */
int orl_reference_make(struct orl_reference *ret_reference, double *const *runs, size_t n_runs,
                       const double *errors, size_t count, bool of_views, struct orl_error *err);

/* Fills in standard_error, worst, values and left_out. */
void orl_reference_describe(const struct orl_reference *reference, struct orl_study_reference *ret);

/* Fills in the point's measures of error from that many runs. Returns 0 or ORL_ERR_NOMEM. */
int orl_study_judge(const struct orl_reference *reference, double *const *runs, size_t n_runs,
                    bool of_views, struct orl_study_point *point, struct orl_error *err);

#endif

/* Runs a fit: from files through scans, shapes and models to XML. Entry point. */
#include <oriel/bsdf/bsdf_fit.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/fit/fit.h"
#include "bsdf/fit/measurements/measurements.h"

/* ---- Files ----------------------------------------------------------------------------------- */

static void report_progress(const struct orl_bsdf_make_env *env, double fraction)
{
    if (env->progress)
        env->progress(env->ctx, 1, fraction);
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

struct shape_fitting {
    const struct orl_bsdf_fit_request *request;
    const struct orl_bsdf_make_env *env;
    struct orl_fit_data *data;
    unsigned levels[2];                /* levels of lobes, the largest lobes and the smallest */
    struct orl_fit_shape *shapes;      /* one per scan */
    struct orl_bsdf_fit_scan *reports; /* one per scan */
    struct orl_bsdf_outlier *outliers; /* ORL_BSDF_FIT_MAX_OUTLIERS per scan */
    struct orl_error *errors;          /* one per scan */
    int *codes;
};

static void report_scan(const struct shape_fitting *s, size_t i, const struct orl_fit_rbf *centers)
{
    const struct orl_fit_scan *scan = &s->data->scans[i];
    const struct orl_fit_shape *shape = &s->shapes[i];
    const double phi = atan2(shape->peak.y, shape->peak.x) / ORL_DEG_TO_RAD;
    s->reports[i] = (struct orl_bsdf_fit_scan){
        .front = scan->front,
        .transmitted = scan->transmitted,
        .theta_deg = scan->theta_deg,
        .phi_deg = scan->phi_deg,
        .rows = scan->n_measured,
        .outliers = centers->n_outliers,
        .centers = centers->n,
        .covered = centers->covered,
        .hidden_deg = centers->hidden_rad / ORL_DEG_TO_RAD,
        .noise = centers->noise,
        .total = shape->total,
        .total_error = shape->total_error,
        .peak = shape->peak_value,
        .peak_theta_deg =
            atan2(hypot(shape->peak.x, shape->peak.y), shape->peak.z) / ORL_DEG_TO_RAD,
        .peak_phi_deg = phi < 0 ? phi + 360 : phi};
}

static void shape_scan(void *arg, size_t index, uint32_t member)
{
    const struct shape_fitting *s = arg;
    const struct orl_fit_rbf_options options = {s->request->keep_outliers,
                                                s->outliers + index * ORL_BSDF_FIT_MAX_OUTLIERS,
                                                ORL_BSDF_FIT_MAX_OUTLIERS, s->env->cancel};
    struct orl_fit_scan *scan = &s->data->scans[index];
    struct orl_fit_rbf centers;
    (void)member;
    s->codes[index] = orl_fit_rbf_make(scan, &options, &centers, &s->errors[index]);
    if (s->codes[index] < 0)
        return;
    s->codes[index] = orl_fit_shape_make(&centers, scan->in, s->levels, s->env->cancel,
                                         &s->shapes[index], &s->errors[index]);
    if (s->codes[index] == 0)
        report_scan(s, index, &centers);
    orl_fit_rbf_done(&centers);
    free(scan->rows);
    scan->rows = NULL;
}

static void gather_outliers(const struct shape_fitting *s, struct orl_bsdf_fit_result *result)
{
    size_t reports = 0;
    for (size_t i = 0; i < s->data->n_scans; i++) {
        const size_t n = s->reports[i].outliers;
        for (size_t k = 0; k < n && k < ORL_BSDF_FIT_MAX_OUTLIERS; k++)
            if (reports < ORL_BSDF_FIT_MAX_OUTLIERS)
                result->outliers[reports++] = s->outliers[i * ORL_BSDF_FIT_MAX_OUTLIERS + k];
        result->n_outliers += n;
    }
}

static int shape_all(struct shape_fitting *s, struct orl_bsdf_fit_result *result,
                     struct orl_error *err)
{
    const size_t n = s->data->n_scans;
    s->shapes = calloc(n, sizeof *s->shapes);
    s->reports = calloc(n, sizeof *s->reports);
    s->outliers = calloc(n * ORL_BSDF_FIT_MAX_OUTLIERS, sizeof *s->outliers);
    s->errors = calloc(n, sizeof *s->errors);
    s->codes = calloc(n, sizeof *s->codes);
    if (!s->shapes || !s->reports || !s->outliers || !s->errors || !s->codes)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    if (orl_parallel_try(s->env->pool, n, shape_scan, s) < 0)
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    for (size_t i = 0; i < n; i++)
        if (s->codes[i] < 0) {
            if (err) {
                *err = s->errors[i];
                if (err->line > 0)
                    orl_error_at(err, s->request->files[s->data->scans[i].file], err->line, NULL);
            }
            return s->codes[i];
        }
    gather_outliers(s, result);
    return 0;
}

static void shape_fitting_done(struct shape_fitting *s)
{
    for (size_t i = 0; s->shapes && i < s->data->n_scans; i++)
        orl_fit_shape_done(&s->shapes[i]);
    free(s->shapes);
    free(s->reports);
    free(s->outliers);
    free(s->errors);
    free(s->codes);
}

/* ---- Models ---------------------------------------------------------------------------------- */

/* Returns the mean total of scans at the angle. Sets the largest angle that is clearly less, or
 * -1. */
static double total_at(const struct orl_bsdf_fit_scan *scans, size_t n, double theta_deg,
                       double *ret_next_deg)
{
    const double same_deg = 0.5;
    double sum = 0;
    size_t count = 0;
    *ret_next_deg = -1;
    for (size_t i = 0; i < n; i++) {
        if (fabs(scans[i].theta_deg - theta_deg) <= same_deg) {
            sum += scans[i].total;
            count++;
        } else if (scans[i].theta_deg < theta_deg) {
            *ret_next_deg = fmax(*ret_next_deg, scans[i].theta_deg);
        }
    }
    return sum / (double)count;
}

/* Returns the error of diffuse light that comes from beyond the last direction. The total there may
 * continue its change up to that direction instead of staying constant. The mean angle lies a third
 * of the way to the surface. */
static double error_beyond(const struct orl_bsdf_fit_scan *scans, size_t n, double most_deg)
{
    const double cosine = cos(most_deg * ORL_DEG_TO_RAD);
    double before_deg, unused;
    const double last = total_at(scans, n, most_deg, &before_deg);
    if (before_deg < 0)
        return cosine * cosine * last; /* one angle gives no information on a change */
    const double before = total_at(scans, n, before_deg, &unused);
    const double by = fmin(1, (90 - most_deg) / 3 / (most_deg - before_deg));
    return cosine * cosine * fabs(last - before) * by;
}

/* Fills the leave-one-out errors of one component. */
static void report_component(struct orl_bsdf_fit_result *f, const struct orl_bsdf_fit_scan *scans,
                             size_t n, int front, int t)
{
    double squares = 0, misplaced = 0, most = 0;
    size_t left = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, scans[i].theta_deg);
        if (!scans[i].left_out)
            continue;
        squares += (scans[i].predicted - scans[i].total) * (scans[i].predicted - scans[i].total);
        misplaced += scans[i].misplaced;
        left++;
    }
    f->has[front][t] = true;
    f->theta_most_deg[front][t] = most;
    f->diffuse[front][t].error =
        hypot(left > 0 ? sqrt(squares / (double)left) : 0, error_beyond(scans, n, most));
    f->misplaced[front][t] = left > 0 ? misplaced / (double)left : -1;
}

/* Makes the model of a component. Its scans become adjacent in result->scans; the model takes its
 * shapes. */
static int make_model(struct shape_fitting *s, int front, int t, struct orl_bsdf_fit_result *result,
                      struct orl_fit_model *model, bool *ret_any, struct orl_error *err)
{
    const size_t first = result->n_scans;
    size_t n = 0;
    struct orl_fit_shape *shapes = malloc(s->data->n_scans * sizeof *shapes);
    if (!shapes || !s->reports) {
        free(shapes);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    }
    for (size_t i = 0; i < s->data->n_scans; i++) {
        if (s->data->scans[i].front != front || s->data->scans[i].transmitted != t)
            continue;
        result->scans[first + n] = s->reports[i];
        shapes[n++] = s->shapes[i];
        s->shapes[i] = (struct orl_fit_shape){0};
    }
    *ret_any = n > 0;
    if (n == 0) {
        free(shapes);
        return 0;
    }
    int code = orl_fit_model_make(shapes, n, result->symmetry, model, err);
    if (code < 0)
        return code;
    code = orl_fit_leave_one_out(model, s->env, result->scans + first, err);
    result->n_scans = first + n;
    report_component(result, result->scans + first, n, front, t);
    return code;
}

static int write_out(struct shape_fitting *s, struct orl_bsdf_fit_result *result,
                     struct orl_error *err)
{
    struct orl_fit_model models[2][2] = {{{0}}};
    struct orl_fit_models given = {0};
    int code = 0;
    for (int i = 0; i < 4 && code == 0; i++) {
        bool any = false;
        code = make_model(s, i / 2, i % 2, result, &models[i / 2][i % 2], &any, err);
        given.of[i / 2][i % 2] = any ? &models[i / 2][i % 2] : NULL;
    }
    report_progress(s->env, orl_fit_prepared_share);
    if (code == 0)
        code = orl_bsdf_basis_is_tree(result->basis)
                   ? orl_fit_write_trees(s->request, s->env, &given, result, err)
                   : orl_fit_write_klems(s->request, s->env, &given, result, err);
    for (int i = 0; i < 4; i++)
        orl_fit_model_done(&models[i / 2][i % 2]);
    return code;
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* Sets the levels of lobes. Bright lobes are as narrow as cells out. A tree of rank 4 has very many
 * cells. In a peak lobes are much narrower, because a peak may lie on the border of cells. */
static void set_levels(const struct orl_bsdf_fit_request *request, enum orl_bsdf_basis basis,
                       unsigned levels[2])
{
    const bool many = basis != ORL_BSDF_TENSOR_TREE_3;
    unsigned level = 2;
    while (orl_bsdf_basis_is_tree(basis) && 1U << level < request->resolution)
        level++;
    level += many ? 3 : 5;
    levels[0] = many ? 6 : 7;
    levels[1] = level < 9 ? 9 : level;
}

static int run_fit(const struct orl_bsdf_fit_request *request, const struct orl_bsdf_make_env *env,
                   struct orl_fit_data *data, struct orl_bsdf_fit_result *result,
                   struct orl_error *err)
{
    struct shape_fitting shape_fitting = {.request = request, .env = env, .data = data};
    const struct orl_fit_read_options options = {request->reversed, request->grazing_deg,
                                                 env->cancel};
    int code = 0;
    for (uint32_t i = 0; i < request->n_files && code == 0; i++)
        code = orl_fit_read_file(env->files, request->files[i], i, &options, data, err);
    report_progress(env, 0.1);
    if (code < 0)
        return code;
    result->rows = data->n_rows;
    result->color_left_out = data->color_left_out;
    snprintf(result->sample, sizeof result->sample, "%s", data->name);
    code = orl_fit_sort_scans(data, request->symmetry, &result->symmetry, err);
    if (code < 0)
        return code;
    const bool isotropic = result->symmetry == ORL_BSDF_FIT_ISOTROPIC;
    result->basis = request->has_basis ? request->basis
                    : isotropic        ? ORL_BSDF_TENSOR_TREE_3
                                       : ORL_BSDF_TENSOR_TREE_4;
    if (!isotropic && result->basis == ORL_BSDF_TENSOR_TREE_3)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a tensor tree of rank 3 needs an isotropic sample, but the incident "
                             "directions have several azimuths");
    result->scans = calloc(data->n_scans, sizeof *result->scans);
    set_levels(request, result->basis, shape_fitting.levels);
    code = result->scans ? shape_all(&shape_fitting, result, err)
                         : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    report_progress(env, 0.25);
    if (code == 0)
        code = write_out(&shape_fitting, result, err);
    shape_fitting_done(&shape_fitting);
    return code;
}

int orl_bsdf_fit(const struct orl_bsdf_fit_request *request, const struct orl_bsdf_make_env *env,
                 struct orl_bsdf_fit_result *ret_fitted, struct orl_error *err)
{
    struct orl_bsdf_fit_result result = {0};
    struct orl_fit_data data = {0};
    int code = orl_bsdf_fit_validate(request, err);
    if (code < 0)
        return code;
    if (request->n_files == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "no measurement file is given");
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    code = run_fit(request, env, &data, &result, err);
    orl_thread_pool_set_cancel(env->pool, NULL);
    orl_fit_data_done(&data);
    if (code == 0)
        *ret_fitted = result;
    else
        orl_bsdf_fit_result_done(&result);
    return code;
}

void orl_bsdf_fit_result_done(struct orl_bsdf_fit_result *result)
{
    if (!result)
        return;
    free(result->xml);
    free(result->scans);
    memset(result, 0, sizeof *result);
}

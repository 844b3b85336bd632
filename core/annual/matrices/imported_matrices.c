#include "annual/matrices/imported_matrices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf.h>

#include "annual/year/annual_year.h"

/* ---- Files ----------------------------------------------------------------------------------- */

struct matrix_sum {
    const struct orl_annual_request *request;
    const struct orl_run_env *run;
    struct orl_annual_result *result;
    double *sums;     /* [sensor][column], lx */
    const char *name; /* name of the sky read last, borrowed; NULL: none */
    struct orl_rgb_matrix sky;
    struct orl_error *err;
};

static bool is_xml(const char *name)
{
    const size_t length = strlen(name);
    return length > 4 && strcasecmp(name + length - 4, ".xml") == 0;
}

static int read_transmission(const struct orl_run_env *run, const char *name,
                             const struct orl_file *file, struct orl_rgb_matrix *ret_matrix,
                             struct orl_error *err)
{
    const struct orl_bsdf_xml xml = {.name = name,
                                     .data = file->data,
                                     .size = file->size,
                                     .cancel = run->cancel,
                                     .pool = run->pool};
    struct orl_rgb_matrix matrix = {.rows = 0};
    struct orl_bsdf *bsdf = NULL;
    int code = orl_bsdf_load(&xml, &bsdf, err);
    if (code == 0) {
        code = orl_bsdf_transmission(bsdf, &matrix.rows, &matrix.columns, &matrix.values, err);
        if (code < 0)
            orl_error_at(err, name, 0, "BSDF");
    }
    orl_bsdf_unref(bsdf);
    if (code == 0)
        *ret_matrix = matrix;
    return code;
}

static int read_file(const struct orl_run_env *run, const char *name, bool transmission,
                     struct orl_rgb_matrix *ret_matrix, struct orl_error *err)
{
    const struct orl_files *files = run->files;
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = transmission && is_xml(name)
               ? read_transmission(run, name, &file, ret_matrix, err)
               : orl_rgb_matrix_read(name, file.data, file.size, ret_matrix, err);
    files->close(files->ctx, &file);
    return code;
}

static int read_matrix(const struct matrix_sum *s, const char *name, bool transmission,
                       struct orl_rgb_matrix *ret_matrix)
{
    if (orl_is_cancelled(s->run->cancel))
        return orl_year_cancelled(s->err);
    return read_file(s->run, name, transmission, ret_matrix, s->err);
}

/* ---- Sizes ----------------------------------------------------------------------------------- */

/* Measures the size of a file's matrix by reading it; without a file the size is 0. */
static int measure_file(const struct orl_run_env *run, const char *name, bool transmission,
                        struct orl_rgb_matrix *ret_size, struct orl_error *err)
{
    *ret_size = (struct orl_rgb_matrix){.rows = 0};
    const int code = name ? read_file(run, name, transmission, ret_size, err) : 0;
    free(ret_size->values);
    ret_size->values = NULL;
    return code;
}

static uint64_t count_values(const struct orl_rgb_matrix *size)
{
    return (uint64_t)size->rows * size->columns;
}

/* Counts the values of a term's files and of its products. sky: the sky of the previous term, which
 * is not read again if it is the same. */
static int measure_term(const struct orl_run_env *run, const struct orl_matrix_term *term,
                        const char **sky_name, struct orl_rgb_matrix *sky, uint64_t *ret_values,
                        struct orl_error *err)
{
    const char *const names[] = {term->coefficients, term->view, term->transmission,
                                 term->daylight};
    enum { COEFFICIENTS, VIEW, TRANSMISSION, DAYLIGHT, FILES };
    struct orl_rgb_matrix sizes[FILES];
    uint64_t values = 0;
    int code = 0;
    for (int i = 0; i < FILES && code == 0; i++) {
        code = measure_file(run, names[i], i == TRANSMISSION, &sizes[i], err);
        values += code == 0 ? count_values(&sizes[i]) : 0;
    }
    if (code == 0 && (!*sky_name || strcmp(*sky_name, term->sky) != 0)) {
        code = measure_file(run, term->sky, false, sky, err);
        *sky_name = term->sky;
    }
    if (code == 0)
        *ret_values =
            values + count_values(sky) +
            (uint64_t)sizes[VIEW].rows * (sizes[TRANSMISSION].columns + sizes[DAYLIGHT].columns);
    return code;
}

int orl_matrix_terms_measure(const struct orl_matrix_term *terms, size_t count,
                             const struct orl_files *files, uint64_t *ret_bytes,
                             struct orl_error *err)
{
    const struct orl_run_env run = {.files = files};
    struct orl_rgb_matrix sky = {.rows = 0};
    const char *sky_name = NULL;
    uint64_t most = 0, values = 0;
    int code = 0;
    for (size_t i = 0; i < count && code == 0; i++) {
        code = measure_term(&run, &terms[i], &sky_name, &sky, &values, err);
        most = code == 0 && values > most ? values : most;
    }
    if (code == 0)
        *ret_bytes = most * 3 * sizeof(float);
    return code;
}

static int fail_size(const struct matrix_sum *s, const char *name, const char *what, size_t has,
                     size_t wanted, const char *of)
{
    orl_error_set(s->err, ORL_ERR_RANGE, "it has %zu %s, but %zu are needed to match %.100s", has,
                  what, wanted, of);
    orl_error_at(s->err, name, 0, "matrix");
    return ORL_ERR_RANGE;
}

/* Reads the sky, unless the previous term had the same one: skies are large. */
static int need_sky(struct matrix_sum *s, const char *name)
{
    if (s->name && strcmp(s->name, name) == 0)
        return 0;
    orl_rgb_matrix_done(&s->sky);
    s->name = NULL;
    const int code = read_matrix(s, name, false, &s->sky);
    if (code < 0)
        return code;
    s->name = name;
    if (s->sky.columns == s->result->n_steps)
        return 0;
    fail_size(s, name, "columns", s->sky.columns, s->result->n_steps,
              "the rows of the weather file");
    orl_error_hint(s->err, "run gendaymtx for all rows of the weather file: -u leaves dark hours "
                           "out, and other options select other hours");
    return ORL_ERR_RANGE;
}

/* ---- Products -------------------------------------------------------------------------------- */

/* Replaces *matrix by its product with the file's matrix. */
static int multiply_by(const struct matrix_sum *s, const char *before, const char *name,
                       bool transmission, struct orl_rgb_matrix *matrix)
{
    struct orl_rgb_matrix by = {.rows = 0}, product = {.rows = 0};
    int code = read_matrix(s, name, transmission, &by);
    if (code == 0 && by.rows != matrix->columns)
        code = fail_size(s, name, "rows", by.rows, matrix->columns, before);
    if (code == 0)
        code = orl_rgb_matrix_multiply(matrix, &by, s->run->pool, &product, s->err);
    orl_rgb_matrix_done(&by);
    if (code < 0)
        return code;
    orl_rgb_matrix_done(matrix);
    *matrix = product;
    return 0;
}

/* Computes the matrix from sensors to patches of sky. */
static int make_coefficients(const struct matrix_sum *s, const struct orl_matrix_term *term,
                             struct orl_rgb_matrix *ret_matrix)
{
    if (term->coefficients)
        return read_matrix(s, term->coefficients, false, ret_matrix);
    int code = read_matrix(s, term->view, false, ret_matrix);
    if (code == 0)
        code = multiply_by(s, term->view, term->transmission, true, ret_matrix);
    return code < 0 ? code : multiply_by(s, term->transmission, term->daylight, false, ret_matrix);
}

struct term_sum {
    const struct matrix_sum *s;
    const struct orl_rgb_matrix *coefficients;
    size_t first; /* first sensor */
    double sign;
};

static void add_sensor(void *arg, size_t index, uint32_t member)
{
    static const double luma[3] = {ORL_LUMA_R, ORL_LUMA_G, ORL_LUMA_B};
    const struct term_sum *a = arg;
    const struct orl_rgb_matrix *sky = &a->s->sky;
    const struct orl_annual_result *result = a->s->result;
    double *sums = a->s->sums + (a->first + index) * result->n_columns;
    (void)member;
    for (size_t p = 0; p < sky->rows; p++)
        for (size_t k = 0; k < 3; k++) {
            const double by =
                a->sign * ORL_EFFICACY_LM_PER_W * luma[k] *
                (double)a->coefficients->values[3 * (index * a->coefficients->columns + p) + k];
            const float *of = sky->values + 3 * p * sky->columns + k;
            for (size_t c = 0; by != 0 && c < result->n_columns; c++)
                sums[c] +=
                    by * (double)of[3 * orl_annual_row_of_step(result, result->step_of_column[c])];
        }
}

static int add_term(struct matrix_sum *s, const struct orl_matrix_term *term)
{
    struct orl_annual_grid all;
    const struct orl_annual_grid *grid = orl_matrix_term_grid(s->request, term, &all);
    const char *first = term->coefficients ? term->coefficients : term->view;
    const char *last = term->coefficients ? term->coefficients : term->daylight;
    struct orl_rgb_matrix coefficients = {.rows = 0};
    int code = need_sky(s, term->sky);
    if (code == 0)
        code = make_coefficients(s, term, &coefficients);
    if (code == 0 && coefficients.rows != grid->count)
        code =
            fail_size(s, first, "rows", coefficients.rows, grid->count, "the sensors of its grid");
    if (code == 0 && coefficients.columns != s->sky.rows)
        code = fail_size(s, last, "columns", coefficients.columns, s->sky.rows, term->sky);
    const struct term_sum term_sum = {s, &coefficients, grid->first, term->subtract ? -1 : 1};
    if (code == 0 &&
        orl_parallel_try(s->run->pool, grid->count, add_sensor, (void *)(uintptr_t)&term_sum) < 0)
        code = orl_year_cancelled(s->err);
    orl_rgb_matrix_done(&coefficients);
    return code;
}

static int sum_terms(struct matrix_sum *s)
{
    const size_t n = s->result->n_sensors * s->result->n_columns;
    int code = 0;
    s->sums = calloc(n + 1, sizeof *s->sums);
    if (!s->sums)
        return orl_year_no_memory(s->err);
    for (size_t i = 0; i < s->request->n_terms && code == 0; i++)
        code = add_term(s, &s->request->terms[i]);
    for (size_t i = 0; i < n && code == 0; i++)
        s->result->total[i] = (float)fmax(0, s->sums[i]);
    orl_rgb_matrix_done(&s->sky);
    free(s->sums);
    return code;
}

/* ---- The year -------------------------------------------------------------------------------- */

int orl_annual_run_matrices(const struct orl_annual_request *request,
                            const struct orl_annual_env *env, struct orl_annual_result *ret_result,
                            struct orl_error *err)
{
    const struct orl_year_overrides direct = {.sun_only = true};
    struct orl_annual_env own = *env;
    struct orl_annual_result result = {.n_sensors = 0};
    if (env->row)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "a year computed from matrices has no row callback");
    own.restored = NULL; /* callbacks for rows by paths */
    own.done = NULL;
    int code = orl_year_run(request, &own, &direct, &result, err);
    struct matrix_sum s = {.request = request, .run = env->run, .result = &result, .err = err};
    orl_thread_pool_set_cancel(env->run->pool, env->run->cancel);
    if (code == 0)
        code = sum_terms(&s);
    orl_thread_pool_set_cancel(env->run->pool, NULL);
    free(result.se);
    free(result.overcast);
    free(result.overcast_se);
    free(result.coherence);
    result.se = result.overcast = result.overcast_se = result.coherence = NULL;
    if (code < 0)
        orl_annual_done(&result);
    else
        *ret_result = result;
    return code;
}

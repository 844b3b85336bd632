#include "annual/matrices/imported_matrices.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>
#include <oriel/base/thread_pool.h>

enum format { FORMAT_NONE, FORMAT_ASCII, FORMAT_FLOAT, FORMAT_DOUBLE };

struct reader {
    struct orl_scanner scanner;
    size_t rows, columns, parts; /* parts: components per value */
    enum format format;
    bool swapped;
    double exposure[3];
    struct orl_error *err;
};

int orl_rgb_matrix_init(struct orl_rgb_matrix *matrix, size_t rows, size_t columns,
                        struct orl_error *err)
{
    *matrix = (struct orl_rgb_matrix){.rows = rows, .columns = columns};
    if (rows == 0 || columns == 0 || rows > ORL_LIMIT_MATRIX_CELLS / columns) {
        return orl_error_set(
            err, ORL_ERR_LIMIT,
            "a matrix of %zu rows and %zu columns is too large: the limit is %lu values", rows,
            columns, ORL_LIMIT_MATRIX_CELLS);
    }
    matrix->values = calloc(rows * columns, 3 * sizeof *matrix->values);
    if (matrix->values)
        return 0;
    orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a matrix");
    return ORL_ERR_NOMEM;
}

void orl_rgb_matrix_done(struct orl_rgb_matrix *matrix)
{
    free(matrix->values);
    *matrix = (struct orl_rgb_matrix){.rows = 0};
}

/* ---- Header ---------------------------------------------------------------------------------- */

static int fail_in_matrix(const struct reader *r, int code, const char *what)
{
    orl_scanner_fail(&r->scanner, code, r->err, "%s", what);
    orl_error_at(r->err, NULL, 0, "matrix");
    return code;
}

/* Reads the n numbers behind a key; NAN replaces invalid ones. Returns false if the line has
 * another key. */
static inline bool read_key(const struct reader *r, struct orl_slice line, const char *key,
                            double *ret_values, size_t n)
{
    if (!orl_slice_begins(line, key))
        return false;
    line.text += strlen(key);
    line.length -= strlen(key);
    for (size_t i = 0; i < n; i++)
        if (orl_scanner_number(&r->scanner, orl_slice_take_word(&line), key, &ret_values[i], NULL))
            ret_values[i] = NAN;
    return true;
}

static int read_format(struct reader *r, struct orl_slice word)
{
    static const char *const names[] = {"ascii", "float", "double"};
    for (int i = 0; i < 3; i++)
        if (orl_slice_is(word, names[i])) {
            r->format = (enum format)(i + 1);
            return 0;
        }
    return fail_in_matrix(r, ORL_ERR_UNSUPPORTED, "FORMAT must be ascii, float or double");
}

static int read_line(struct reader *r, struct orl_slice line)
{
    static const char format[] = "FORMAT=";
    double value[3] = {0};
    if (orl_slice_begins(line, format)) { /* in gendaymtx's output padding may follow the format */
        line.text += sizeof format - 1;
        line.length -= sizeof format - 1;
        return read_format(r, orl_slice_trim(line));
    }
    if (read_key(r, line, "EXPOSURE=", value, 1) || read_key(r, line, "COLORCORR=", value, 3)) {
        const bool all = line.text[0] == 'E';
        bool sound = true;
        for (int i = 0; i < 3; i++) {
            r->exposure[i] *= value[all ? 0 : i];
            sound = sound && r->exposure[i] > 0 && isfinite(r->exposure[i]);
        }
        return sound ? 0
                     : fail_in_matrix(r, ORL_ERR_RANGE, "an exposure must be finite and above 0");
    }
    if (read_key(r, line, "BigEndian=", value, 1)) {
        const bool big = value[0] > 0;
        r->swapped = big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
        return 0;
    }
    size_t *const counts[] = {&r->rows, &r->columns, &r->parts};
    static const char *const keys[] = {"NROWS=", "NCOLS=", "NCOMP="};
    for (int i = 0; i < 3; i++)
        if (read_key(r, line, keys[i], value, 1)) {
            if (!(value[0] >= 1 && value[0] <= 1e9 && value[0] == floor(value[0])))
                return fail_in_matrix(r, ORL_ERR_SYNTAX,
                                      "NROWS, NCOLS and NCOMP must be whole numbers of at least 1");
            *counts[i] = (size_t)value[0];
        }
    return 0;
}

static int read_header(struct reader *r)
{
    struct orl_slice line = {NULL, 0};
    int code = 0;
    if (!orl_scanner_line(&r->scanner, &line) || !orl_slice_begins(line, "#?"))
        return fail_in_matrix(r, ORL_ERR_SYNTAX, "a matrix must begin with \"#?RADIANCE\"");
    while (code == 0 && line.length > 0)
        code = orl_scanner_line(&r->scanner, &line)
                   ? read_line(r, line)
                   : fail_in_matrix(r, ORL_ERR_SYNTAX, "the matrix ends within its header");
    if (code < 0)
        return code;
    orl_scanner_next_line(&r->scanner); /* to the first value */
    if (r->format == FORMAT_NONE || r->columns == 0)
        return fail_in_matrix(r, ORL_ERR_SYNTAX,
                              "the header of a matrix must give NCOLS and FORMAT");
    return r->parts == 1 || r->parts == 3
               ? 0
               : fail_in_matrix(r, ORL_ERR_UNSUPPORTED,
                                "the values of a matrix must have 3 components, or 1");
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* Determines the number of rows if the header does not give it; otherwise checks it. */
static int find_rows(struct reader *r)
{
    const size_t bytes = r->format == FORMAT_DOUBLE ? sizeof(double) : sizeof(float);
    const size_t row = r->columns * r->parts, left = (size_t)(r->scanner.end - r->scanner.at);
    const size_t n =
        r->format == FORMAT_ASCII ? orl_scanner_count_words(&r->scanner) : left / bytes;
    if (r->rows == 0 && (n % row != 0 || (r->format != FORMAT_ASCII && left % bytes != 0)))
        return fail_in_matrix(r, ORL_ERR_SYNTAX, "its size is not a whole number of rows");
    if (r->rows == 0)
        r->rows = n / row;
    if (r->rows == 0 || r->rows > n / row)
        return fail_in_matrix(r, ORL_ERR_SYNTAX, "it ends before its last row");
    return r->rows < n / row ? fail_in_matrix(r, ORL_ERR_SYNTAX, "it goes on after its last row")
                             : 0;
}

static int read_binary(struct reader *r, double *ret_value)
{
    unsigned char bytes[sizeof(double)], turned[sizeof(double)];
    const size_t size = r->format == FORMAT_DOUBLE ? sizeof(double) : sizeof(float);
    float single;
    memcpy(bytes, r->scanner.at, size);
    r->scanner.at += size;
    for (size_t i = 0; i < size; i++)
        turned[i] = bytes[r->swapped ? size - 1 - i : i];
    if (r->format == FORMAT_DOUBLE) {
        memcpy(ret_value, turned, sizeof *ret_value);
    } else {
        memcpy(&single, turned, sizeof single);
        *ret_value = (double)single;
    }
    return isfinite(*ret_value)
               ? 0
               : fail_in_matrix(r, ORL_ERR_RANGE, "a value is not a finite number");
}

static int read_text(struct reader *r, double *ret_value)
{
    struct orl_slice word = {NULL, 0};
    if (!orl_scanner_word(&r->scanner, &word))
        return fail_in_matrix(r, ORL_ERR_SYNTAX, "it ends before its last value");
    const int code = orl_scanner_number(&r->scanner, word, NULL, ret_value, r->err);
    if (code < 0)
        orl_error_at(r->err, NULL, 0, "matrix");
    return code;
}

static int read_values(struct reader *r, struct orl_rgb_matrix *matrix)
{
    int code = 0;
    for (size_t i = 0; i < matrix->rows * matrix->columns; i++)
        for (size_t k = 0; k < 3; k++) {
            double value = 0;
            if (k < r->parts)
                code = r->format == FORMAT_ASCII ? read_text(r, &value) : read_binary(r, &value);
            if (code < 0)
                return code;
            float *at = &matrix->values[3 * i + k];
            *at = k < r->parts ? (float)(value / r->exposure[k]) : at[-1];
            if (!isfinite(*at))
                return fail_in_matrix(r, ORL_ERR_RANGE, "a value is too large");
        }
    return 0;
}

int orl_rgb_matrix_read(const char *name, const char *text, size_t size,
                        struct orl_rgb_matrix *ret_matrix, struct orl_error *err)
{
    struct reader r = {.parts = 3, .exposure = {1, 1, 1}, .err = err};
    struct orl_rgb_matrix matrix = {.rows = 0};
    int code = orl_scanner_init(&r.scanner, name, text, size, ORL_SCANNER_TEXT_HEADER, err);
    if (code == 0)
        code = read_header(&r);
    if (code == 0 && r.format == FORMAT_ASCII)
        code = orl_scanner_rest_is_text(&r.scanner, err);
    if (code == 0)
        code = find_rows(&r);
    if (code == 0) {
        code = orl_rgb_matrix_init(&matrix, r.rows, r.columns, err);
        if (code < 0)
            orl_error_at(err, name, 0, "matrix");
    }
    if (code == 0)
        code = read_values(&r, &matrix);
    if (code < 0)
        orl_rgb_matrix_done(&matrix);
    else
        *ret_matrix = matrix;
    return code;
}

/* ---- Products -------------------------------------------------------------------------------- */

struct product {
    const struct orl_rgb_matrix *a, *b;
    struct orl_rgb_matrix *product;
    double *sums; /* one row per thread */
};

static void multiply_row(void *arg, size_t row, uint32_t member)
{
    const struct product *p = arg;
    const size_t n = 3 * p->b->columns;
    double *sums = p->sums + member * n;
    memset(sums, 0, n * sizeof *sums);
    for (size_t i = 0; i < p->a->columns; i++) {
        const float *by = &p->a->values[3 * (row * p->a->columns + i)];
        const float *of = &p->b->values[i * n];
        if (by[0] == 0 && by[1] == 0 && by[2] == 0)
            continue;
        for (size_t k = 0; k < n; k += 3)
            for (size_t c = 0; c < 3; c++)
                sums[k + c] += (double)by[c] * (double)of[k + c];
    }
    for (size_t k = 0; k < n; k++)
        p->product->values[row * n + k] = (float)sums[k];
}

int orl_rgb_matrix_multiply(const struct orl_rgb_matrix *a, const struct orl_rgb_matrix *b,
                            struct orl_thread_pool *pool, struct orl_rgb_matrix *ret_product,
                            struct orl_error *err)
{
    struct orl_rgb_matrix made;
    struct product p = {a, b, &made, NULL};
    int code = orl_rgb_matrix_init(&made, a->rows, b->columns, err);
    if (code < 0)
        return code;
    p.sums = calloc(orl_thread_pool_size(pool) * b->columns, 3 * sizeof *p.sums);
    if (!p.sums)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a matrix");
    else if (orl_parallel_try(pool, a->rows, multiply_row, &p) < 0)
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    free(p.sums);
    if (code < 0)
        orl_rgb_matrix_done(&made);
    else
        *ret_product = made;
    return code;
}

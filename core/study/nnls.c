/*
 * Non-negative least squares for a few columns, by the active-set method of Lawson and Hanson
 * (1974, chapter 23). Columns enter one by one, the steepest descent first. They leave when the
 * unconstrained solution would make them negative.
 */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "study/error_model.h"

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

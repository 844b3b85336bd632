/* Parses the numbers of a BSDF matrix into their places. */
#include "bsdf/xml/data_text.h"

#include <string.h>

void orl_matrix_text_init(struct orl_matrix_text *text, struct orl_matrix *matrix, bool by_rows)
{
    memset(text, 0, sizeof *text);
    orl_scan_init(&text->scan);
    text->matrix = matrix;
    text->by_rows = by_rows;
}

static size_t count_values(const struct orl_matrix *m)
{
    return (size_t)m->basis[ORL_AXIS_A].n_cells * (size_t)m->basis[ORL_AXIS_B].n_cells;
}

/* Returns the index of the next value. Columns: the incident direction varies fastest. Rows: the
 * exitant one. */
static size_t place_of(const struct orl_matrix_text *text)
{
    const size_t n_a = (size_t)text->matrix->basis[ORL_AXIS_A].n_cells;
    const size_t n_b = (size_t)text->matrix->basis[ORL_AXIS_B].n_cells;
    if (text->by_rows)
        return text->count;
    return text->count % n_a * n_b + text->count / n_a;
}

static int parse_values(struct orl_matrix_text *text, struct orl_error *err)
{
    for (;;) {
        double number = 0;
        const int code = orl_scan_next(&text->scan, &number, err);
        if (code <= ORL_TOKEN_NONE)
            return code;
        if (code != ORL_TOKEN_NUMBER)
            return orl_error_set(err, ORL_ERR_SYNTAX, "a brace in the data of a matrix");
        if (text->count == count_values(text->matrix)) {
            orl_error_set(err, ORL_ERR_SYNTAX, "more than the %zu values of the matrix",
                          text->count);
            orl_error_hint(err, "decimal commas would do that: write 0.5, not 0,5");
            return ORL_ERR_SYNTAX;
        }
        text->matrix->values[place_of(text)] = orl_bsdf_value(number, &text->matrix->clamped);
        text->count++;
    }
}

int orl_matrix_text_feed(struct orl_matrix_text *text, const char *piece, size_t size,
                         struct orl_error *err)
{
    orl_scan_feed(&text->scan, piece, size);
    return parse_values(text, err);
}

int orl_matrix_text_finish(struct orl_matrix_text *text, struct orl_error *err)
{
    int code;
    orl_scan_finish(&text->scan);
    code = parse_values(text, err);
    if (code < 0)
        return code;
    if (text->count != count_values(text->matrix))
        return orl_error_set(err, ORL_ERR_SYNTAX, "%zu values where the matrix has %zu",
                             text->count, count_values(text->matrix));
    return orl_matrix_finish(text->matrix, err);
}

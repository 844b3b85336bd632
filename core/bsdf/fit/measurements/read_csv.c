/* Measurements as CSV: a line of column names, then rows. */
#include "bsdf/fit/measurements/rows.h"

#include <string.h>

enum { THETA_IN, PHI_IN, THETA_OUT, PHI_OUT, BSDF, DSF, UP, KINDS, COLUMNS_MAX = 16 };

static const char *const names[KINDS] = {"theta_in", "phi_in", "theta_out", "phi_out",
                                         "bsdf",     "dsf",    "up"};

struct table {
    char separator;
    size_t n_columns;
    int kinds[COLUMNS_MAX]; /* kind of each column */
    bool has[KINDS];
};

static char separator_of(struct orl_slice line)
{
    static const char separators[] = {';', '\t', ','};
    for (size_t i = 0; i < sizeof separators; i++)
        if (memchr(line.text, separators[i], line.length))
            return separators[i];
    return ',';
}

static int read_name(const struct orl_fit_lines *lines, struct orl_slice field, struct table *table,
                     struct orl_error *err)
{
    for (int kind = 0; kind < KINDS; kind++) {
        if (!orl_slice_is_nocase(field, names[kind]))
            continue;
        if (table->has[kind])
            return orl_fit_fail(lines, ORL_ERR_SYNTAX, err, "the column %s comes twice",
                                names[kind]);
        table->has[kind] = true;
        table->kinds[table->n_columns++] = kind;
        return 0;
    }
    return orl_fit_fail(lines, ORL_ERR_SYNTAX, err,
                        "\"%.*s\" is no column: they are theta_in, phi_in, theta_out, phi_out, "
                        "bsdf or dsf, and up",
                        (int)(field.length < 40 ? field.length : 40), field.text);
}

static int read_names(const struct orl_fit_lines *lines, struct orl_slice line, struct table *table,
                      struct orl_error *err)
{
    struct orl_slice field;
    table->separator = separator_of(line);
    while (orl_slice_take_cell(&line, table->separator, &field)) {
        const int code = read_name(lines, field, table, err);
        if (code < 0)
            return code;
    }
    for (int kind = 0; kind <= PHI_OUT; kind++)
        if (!table->has[kind])
            return orl_fit_fail(lines, ORL_ERR_SYNTAX, err, "there is no column %s", names[kind]);
    if (table->has[BSDF] == table->has[DSF])
        return orl_fit_fail(lines, ORL_ERR_SYNTAX, err,
                            "one column of bsdf or dsf is wanted, and one alone");
    return 0;
}

static int read_row(const struct orl_fit_lines *lines, struct orl_slice line,
                    const struct table *table, struct orl_fit_data *data, struct orl_error *err)
{
    double values[KINDS] = {[UP] = 90};
    struct orl_slice field;
    size_t column = 0;
    for (; orl_slice_take_cell(&line, table->separator, &field); column++) {
        if (column >= table->n_columns)
            continue;
        const int kind = table->kinds[column];
        const int code = orl_fit_number(lines, field, names[kind], &values[kind], err);
        if (code < 0)
            return code;
    }
    if (column != table->n_columns)
        return orl_fit_fail(lines, ORL_ERR_SYNTAX, err,
                            "a row has %zu columns here, not fewer or more", table->n_columns);
    const struct orl_fit_angles angles = {values[THETA_IN], values[PHI_IN], values[THETA_OUT],
                                          values[PHI_OUT], values[UP]};
    return orl_fit_add_row(lines, data, &angles, values[table->has[DSF] ? DSF : BSDF],
                           table->has[DSF], err);
}

int orl_fit_read_csv(struct orl_fit_lines *lines, struct orl_fit_data *data, struct orl_error *err)
{
    struct table table = {0};
    struct orl_slice line;
    bool more, any = false;
    int code;
    while ((code = orl_fit_next_line(lines, &line, &more, err)) == 0 && more) {
        struct orl_slice rest = line;
        const struct orl_slice first = orl_slice_take_word(&rest);
        if (first.length == 0 || first.text[0] == '#')
            continue;
        if (table.n_columns == 0) {
            code = read_names(lines, line, &table, err);
        } else {
            code = read_row(lines, line, &table, data, err);
            any = true;
        }
        if (code < 0)
            return code;
    }
    if (code == 0 && !any)
        code = orl_fit_fail(lines, ORL_ERR_SYNTAX, err, "there is no row of measurements");
    return code;
}

/*
 * Radiance data files: the number of axes; for each axis its ends and its number of points, or 0 0,
 * the number of points and their coordinates; then the values, the last axis changing fastest. '#'
 * begins a comment.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "base/text/words.h"
#include "scene/grid/ies.h"

struct reading {
    struct orl_scanner scanner;
    struct orl_grid *grid;
};

static int fail(const struct reading *r, int code, struct orl_error *err, const char *what)
{
    orl_scanner_fail(&r->scanner, code, err, "%s", what);
    return code;
}

static int read_number(struct reading *r, double *ret_value, struct orl_error *err)
{
    struct orl_slice word;
    if (!orl_scanner_word(&r->scanner, &word))
        return fail(r, ORL_ERR_SYNTAX, err, "the data file ends before its last number");
    return orl_scanner_number(&r->scanner, word, NULL, ret_value, err);
}

static int read_count(struct reading *r, int least, int most, int *ret_count, struct orl_error *err)
{
    struct orl_slice word = {NULL, 0};
    if (!orl_scanner_word(&r->scanner, &word) ||
        orl_number_read_int(word.text, word.length, ret_count) != ORL_NUMBER_OK ||
        *ret_count < least || *ret_count > most)
        return fail(r, ORL_ERR_SYNTAX, err,
                    least == 1 ? "a data file must begin with the number of its axes, 1 to 5"
                               : "the number of points of an axis is expected here, at least 2");
    return 0;
}

/* Returns true if so many numbers may follow: each takes two bytes of the file, so memory is
 * bounded by the file's size. */
static bool may_hold(const struct reading *r, size_t numbers)
{
    return numbers <= ORL_GRID_VALUES &&
           numbers <= (size_t)(r->scanner.end - r->scanner.at) / 2 + 1;
}

static int read_places(struct reading *r, struct orl_grid_axis *axis, struct orl_error *err)
{
    int code = 0;
    axis->places = malloc(axis->n * sizeof *axis->places);
    if (!axis->places)
        return fail(r, ORL_ERR_NOMEM, err, "out of memory for a data file");
    for (uint32_t i = 0; i < axis->n && code == 0; i++)
        code = read_number(r, &axis->places[i], err);
    if (code < 0)
        return code;
    axis->origin = axis->places[0];
    axis->size = axis->places[axis->n - 1] - axis->origin;
    for (uint32_t i = 1; i < axis->n; i++)
        if (!(axis->size > 0 ? axis->places[i] > axis->places[i - 1]
                             : axis->places[i] < axis->places[i - 1]))
            return fail(r, ORL_ERR_SYNTAX, err, "an axis' points are not in order");
    return 0;
}

static int read_axis(struct reading *r, struct orl_grid_axis *axis, struct orl_error *err)
{
    double last = 0;
    int n = 0, code = read_number(r, &axis->origin, err);
    if (code == 0)
        code = read_number(r, &last, err);
    if (code == 0)
        code = read_count(r, 2, INT32_MAX, &n, err);
    if (code != 0)
        return code;
    axis->n = (uint32_t)n;
    axis->size = last - axis->origin;
    if (!may_hold(r, axis->n))
        return fail(r, ORL_ERR_SYNTAX, err, "an axis has more points than the file has numbers");
    return axis->size == 0 ? read_places(r, axis, err) : 0;
}

static int read_grid(struct reading *r, struct orl_error *err)
{
    struct orl_grid *const grid = r->grid;
    int n_axes = 0, code = read_count(r, 1, ORL_GRID_AXES, &n_axes, err);
    grid->n_values = grid->channels = 1;
    for (int i = 0; code == 0 && i < n_axes; i++) {
        code = read_axis(r, &grid->axes[grid->n_axes++], err);
        grid->n_values *= code == 0 ? grid->axes[i].n : 1;
        if (code == 0 && !may_hold(r, grid->n_values))
            return fail(r, ORL_ERR_SYNTAX, err,
                        "the axes have more points than the file has numbers");
    }
    if (code != 0)
        return code;
    grid->values = malloc(grid->n_values * sizeof *grid->values);
    if (!grid->values)
        return fail(r, ORL_ERR_NOMEM, err, "out of memory for a data file");
    for (size_t i = 0; code == 0 && i < grid->n_values; i++) {
        double value = 0;
        code = read_number(r, &value, err);
        grid->values[i] = (float)value;
        if (code == 0 && !(value >= -3e38 && value <= 3e38))
            code = fail(r, ORL_ERR_SYNTAX, err, "a number is too large");
    }
    return code;
}

int orl_grid_read_data(const char *name, const char *text, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err)
{
    if (size >= 2 && memcmp(text, "#?", 2) == 0)
        return orl_grid_read_spectra(name, text, size, ret_grid, err);
    if (orl_ies_detect(text, size)) {
        struct orl_ies ies;
        const int code = orl_ies_read(name, text, size, &ies, err);
        if (code < 0)
            return code;
        const int made = orl_ies_grid(&ies, ret_grid, err);
        orl_ies_done(&ies);
        return made;
    }
    struct reading r = {.grid = NULL};
    int code = orl_scanner_init(&r.scanner, name, text, size,
                                ORL_SCANNER_COMMENTS | ORL_SCANNER_COMMENTS_IN_WORDS, err);
    if (code < 0)
        return code;
    r.grid = calloc(1, sizeof *r.grid);
    if (!r.grid)
        return fail(&r, ORL_ERR_NOMEM, err, "out of memory for a data file");
    code = read_grid(&r, err);
    if (code < 0)
        orl_grid_free(r.grid);
    else
        *ret_grid = r.grid;
    return code;
}

#include "scene/grid/ies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>
#include <oriel/base/vec.h>

static const double feet_m = 0.3048;
/* Angles closer than this are equal. */
static const double least_step_deg = 1e-3;

/* The first error stays in code and err; later ones are ignored. */
struct reading {
    struct orl_scanner scanner;
    struct orl_cells cells; /* unread part of the current line of numbers */
    bool separated;         /* the previous line ended in a comma */
    struct orl_ies *ies;
    int code;
    struct orl_error *err;
};

static void fail(struct reading *r, int code, const char *what)
{
    if (!r->code)
        r->code = orl_scanner_fail(&r->scanner, code, r->err, "%s", what);
}

/* ---- Header ---------------------------------------------------------------------------------- */

static bool next_line(struct orl_scanner *scanner, struct orl_slice *ret_line)
{
    if (!orl_scanner_line(scanner, ret_line))
        return false;
    while (ret_line->length > 0 && ret_line->text[ret_line->length - 1] == ' ')
        ret_line->length--;
    return true;
}

/* Returns the line without its first bytes and the blanks behind them. */
static struct orl_slice behind(struct orl_slice line, size_t bytes)
{
    line.text += bytes;
    line.length -= bytes;
    for (; line.length > 0 && (*line.text == ' ' || *line.text == '\t'); line.length--)
        line.text++;
    return line;
}

bool orl_ies_detect(const char *text, size_t size)
{
    struct orl_scanner scanner;
    struct orl_slice line;
    if (orl_scanner_init(&scanner, NULL, text, size, ORL_SCANNER_TEXT_HEADER, NULL) < 0)
        return false;
    while (next_line(&scanner, &line))
        if (orl_slice_begins(line, "TILT="))
            return true;
    return false;
}

/* Returns the year of the standard that the first line names; editions with the same format share
 * one. *ret_keywords: the lines that follow begin with words in []. */
static int year_of(struct orl_slice line, bool *ret_keywords)
{
    static const struct {
        const char *head;
        int year;
    } heads[] = {{"IESNA:LM-63-1995", 1995},
                 {"IESNA:LM-63-2002", 2002},
                 {"IES:LM-63-2019", 2002},
                 {"IESNA91", 1986}};
    *ret_keywords = true;
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        if (orl_slice_begins(line, heads[i].head))
            return heads[i].year;
    *ret_keywords = false;
    return 1986;
}

bool orl_ies_next_lamp(const char **at, const char *text, size_t size, const char **ret_words,
                       size_t *ret_length)
{
    static const char *const keys[] = {"[LAMP]", "[LAMPCAT]"};
    struct orl_scanner scanner;
    struct orl_slice line = {"", 0};
    bool keywords;
    if (orl_scanner_init(&scanner, NULL, text, size, ORL_SCANNER_TEXT_HEADER, NULL) < 0)
        return false;
    struct orl_scanner first = scanner;
    next_line(&first, &line);
    year_of(line, &keywords);
    if (*at != text) {
        scanner.at = *at;
        scanner.fresh = false;
    }
    while (next_line(&scanner, &line)) {
        *at = scanner.at;
        if (orl_slice_begins(line, "TILT="))
            return false;
        line = behind(line, 0);
        for (size_t i = 0; i < sizeof keys / sizeof *keys && keywords; i++)
            if (orl_slice_begins(line, keys[i])) {
                *ret_words = line.text + strlen(keys[i]);
                *ret_length = line.length - strlen(keys[i]);
                return true;
            }
        *ret_words = line.text;
        *ret_length = line.length;
        if (!keywords && line.length > 0)
            return true;
    }
    return false;
}

/* Copies a file's name; returns false if it is not one. */
static bool copy_name(struct orl_slice name, char ret_name[ORL_IES_NAME])
{
    if (name.length >= ORL_IES_NAME || memchr(name.text, '\0', name.length))
        return false;
    memcpy(ret_name, name.text, name.length);
    ret_name[name.length] = '\0';
    return true;
}

/* Takes the name behind the keyword of the luminaire's geometry; ignores other keywords. */
static void read_keyword(struct reading *r, struct orl_slice line)
{
    static const char key[] = "[LUMINOUSGEOMETRY]";
    line = behind(line, 0);
    if (orl_slice_begins(line, key) && !copy_name(behind(line, sizeof key - 1), r->ies->geometry))
        fail(r, ORL_ERR_SYNTAX, "a file name is expected after [LUMINOUSGEOMETRY]");
}

/* Reads up to TILT=. Returns true if the lamp's tilt table follows in the file. */
static bool read_head(struct reading *r)
{
    static const char tilt[] = "TILT=";
    bool keywords = false;
    struct orl_slice line;
    while (next_line(&r->scanner, &line) && !r->code) {
        if (r->scanner.line == 1)
            r->ies->year = year_of(line, &keywords);
        if (orl_slice_begins(line, tilt)) {
            line = behind(line, sizeof tilt - 1);
            const bool tilted = orl_slice_is(line, "INCLUDE");
            if (!tilted && !orl_slice_is(line, "NONE") &&
                (line.length == 0 || !copy_name(line, r->ies->tilt_file)))
                fail(r, ORL_ERR_SYNTAX, "NONE, INCLUDE or a file name is expected after TILT=");
            return tilted;
        }
        if (keywords)
            read_keyword(r, line);
    }
    fail(r, ORL_ERR_SYNTAX, "no line begins with TILT=: this is not an IES file");
    return false;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

/* Reads the next cell of this line or a later one; false at the end. A comma at the end of a line
 * and the line's end are one separator. */
static bool next_cell(struct reading *r, struct orl_slice *ret_cell)
{
    struct orl_slice line;
    for (;;) {
        const bool first = r->cells.at && !r->cells.before;
        if (orl_cells_next(&r->cells, ret_cell)) {
            const bool last = r->cells.at == r->cells.end && !r->cells.before;
            const bool double_comma = !last && (!first || r->separated);
            r->separated = ret_cell->length == 0 && last;
            if (ret_cell->length > 0 || double_comma)
                return true;
            continue;
        }
        if (!orl_scanner_line(&r->scanner, &line))
            return false;
        orl_cells_init(&r->cells, line);
    }
}

static double read_number(struct reading *r)
{
    struct orl_slice cell;
    double value = 0;
    if (r->code)
        return 0;
    if (next_cell(r, &cell))
        r->code = orl_scanner_number(&r->scanner, cell, NULL, &value, r->err);
    else
        fail(r, ORL_ERR_SYNTAX, "the file ends before its last number");
    if (!(fabs(value) <= 1e12))
        fail(r, ORL_ERR_SYNTAX, "a number is expected here");
    return value;
}

static size_t bytes_left(const struct reading *r)
{
    return (size_t)(r->scanner.end - (r->cells.at ? r->cells.at : r->scanner.at));
}

/* The count is bounded by the file's size: each number takes two bytes of it. 0 after an error. */
static uint32_t read_count(struct reading *r, double least)
{
    const double value = read_number(r);
    if (!(value >= least && value <= (double)bytes_left(r) / 2 + 1 && value == floor(value)))
        fail(r, ORL_ERR_SYNTAX, "this is not a number of angles, or more than the file holds");
    return r->code ? 0 : (uint32_t)value;
}

/* Lamps, their lumens, the multiplier, counts of angles, type, units, sizes, factors, watts. */
static void read_sizes(struct reading *r)
{
    struct orl_ies *const ies = r->ies;
    read_number(r);
    read_number(r);
    const double multiplier = read_number(r);
    ies->n_vertical = read_count(r, 2);
    ies->n_horizontal = read_count(r, 1);
    const double type = read_number(r), units = read_number(r);
    const double unit_m = units == 1 ? feet_m : 1;
    ies->type_b = type == 2;
    ies->width = unit_m * read_number(r);
    ies->length = unit_m * read_number(r);
    ies->height = unit_m * read_number(r);
    const double ballast = read_number(r), photometric = read_number(r);
    ies->factor = multiplier * ballast * (ies->year == 1986 ? photometric : 1);
    read_number(r);
    if (type != 1 && type != 2)
        fail(r, ORL_ERR_UNSUPPORTED, "its photometry is neither type C nor type B");
    if (units != 1 && units != 2)
        fail(r, ORL_ERR_SYNTAX, "its units are neither 1 (feet) nor 2 (metres)");
    if (!(ies->factor >= 0))
        fail(r, ORL_ERR_RANGE, "the product of its factors is negative");
}

static double *read_numbers(struct reading *r, uint32_t n)
{
    double *const numbers = calloc((size_t)n + 1, sizeof *numbers);
    if (!numbers) {
        fail(r, ORL_ERR_NOMEM, "out of memory for a luminaire");
        return NULL;
    }
    for (uint32_t i = 0; i < n && !r->code; i++)
        numbers[i] = read_number(r);
    return numbers;
}

static double *read_angles(struct reading *r, uint32_t n)
{
    double *const angles = read_numbers(r, n);
    for (uint32_t i = 0; i < n && !r->code; i++)
        if (fabs(angles[i]) > 360 || (i > 0 && !(angles[i] > angles[i - 1])))
            fail(r, ORL_ERR_SYNTAX, "angles must rise and stay within 360 degrees");
    return angles;
}

/* Reads the lamp's geometry, the number of angles, the angles, and a factor for each. */
static void read_tilt(struct reading *r)
{
    struct orl_ies_tilt *const tilt = &r->ies->tilt;
    const double geometry = read_number(r);
    if (geometry != 1 && geometry != 2 && geometry != 3)
        fail(r, ORL_ERR_SYNTAX, "the lamp-to-luminaire geometry must be 1, 2 or 3");
    tilt->n = read_count(r, 1);
    tilt->angles = read_angles(r, tilt->n);
    tilt->factors = read_numbers(r, tilt->n);
    for (uint32_t i = 0; i < tilt->n && !r->code; i++)
        if (!(tilt->factors[i] >= 0))
            fail(r, ORL_ERR_RANGE, "a lamp's factor is negative");
}

int orl_ies_read_tilt(const char *name, const char *text, size_t size, struct orl_ies *ies,
                      struct orl_error *err)
{
    struct reading r = {.ies = ies, .err = err};
    r.code = orl_scanner_init(&r.scanner, name, text, size, 0, err);
    if (!r.code)
        read_tilt(&r);
    return r.code;
}

static void read_candela(struct reading *r)
{
    struct orl_ies *const ies = r->ies;
    const size_t n = (size_t)ies->n_vertical * ies->n_horizontal;
    if (n > bytes_left(r) / 2 + 1) {
        fail(r, ORL_ERR_SYNTAX, "it has fewer numbers than angles");
        return;
    }
    ies->candela = malloc(n * sizeof *ies->candela);
    if (!ies->candela) {
        fail(r, ORL_ERR_NOMEM, "out of memory for a luminaire");
        return;
    }
    for (size_t i = 0; i < n && !r->code; i++) {
        const double value = read_number(r);
        if (value < 0)
            fail(r, ORL_ERR_RANGE, "an intensity is negative");
        ies->candela[i] = (float)value;
    }
}

int orl_ies_read(const char *name, const char *text, size_t size, struct orl_ies *ret_ies,
                 struct orl_error *err)
{
    *ret_ies = (struct orl_ies){.year = 1986};
    struct reading r = {.ies = ret_ies, .err = err};
    r.code = orl_scanner_init(&r.scanner, name, text, size, 0, err);
    if (!r.code && read_head(&r))
        read_tilt(&r);
    read_sizes(&r);
    ret_ies->vertical = read_angles(&r, ret_ies->n_vertical);
    ret_ies->horizontal = read_angles(&r, ret_ies->n_horizontal);
    if (!r.code)
        read_candela(&r);
    if (r.code)
        orl_ies_done(ret_ies);
    return r.code;
}

void orl_ies_done(struct orl_ies *ies)
{
    free(ies->vertical);
    free(ies->horizontal);
    free(ies->candela);
    free(ies->tilt.angles);
    free(ies->tilt.factors);
    *ies = (struct orl_ies){.year = 0};
}

/* ---- Conversion to a grid -------------------------------------------------------------------- */

/* Range of angles that the photometry may cover, degrees: 0 to 180; for type B -90 to 90, or 0 to
 * 90 if it starts at 0 or above. */
struct reach {
    double low, high;
};
static struct reach reach_of(const struct orl_ies *ies, const double *angles)
{
    return ies->type_b ? (struct reach){angles[0] < 0 ? -90 : 0, 90} : (struct reach){0, 180};
}

bool orl_ies_is_complete(const struct orl_ies *ies)
{
    const double first = ies->vertical[0], last = ies->vertical[ies->n_vertical - 1];
    const double ends[] = {0, 90, ies->type_b ? -90 : 180};
    bool known[2] = {false, false};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        known[0] |= fabs(first - ends[i]) < least_step_deg;
        known[1] |= fabs(last - ends[i]) < least_step_deg;
    }
    return known[0] && known[1];
}

/* Returns the angle at which the horizontal planes should end: 90, 180 or 360 degrees; of type B,
 * 90. */
static double end_of_planes(const struct orl_ies *ies)
{
    const double width = ies->horizontal[ies->n_horizontal - 1] - ies->horizontal[0];
    if (ies->type_b)
        return 90;
    return ies->horizontal[0] + (width <= 90 + least_step_deg    ? 90
                                 : width <= 180 + least_step_deg ? 180
                                                                 : 360);
}

bool orl_ies_has_all_planes(const struct orl_ies *ies)
{
    return ies->n_horizontal < 2 ||
           ies->horizontal[ies->n_horizontal - 1] > end_of_planes(ies) - least_step_deg;
}

/* Numbers of rows of zeros before and after the measured angles. */
struct margins {
    uint32_t before, behind;
};
static struct margins margins_of(const double *angles, uint32_t n, struct reach reach)
{
    return (struct margins){angles[0] - reach.low > 2 * least_step_deg ? 2 : 0,
                            reach.high - angles[n - 1] > 2 * least_step_deg ? 2 : 0};
}

static double *widen_angles(const double *angles, uint32_t n, struct reach reach, struct margins m)
{
    const uint32_t all = m.before + n + m.behind;
    double *const wide = malloc(all * sizeof *wide);
    if (!wide)
        return NULL;
    memcpy(wide + m.before, angles, n * sizeof *angles);
    if (m.before > 0) {
        wide[0] = reach.low;
        wide[1] = angles[0] - least_step_deg;
    }
    if (m.behind > 0) {
        wide[all - 2] = angles[n - 1] + least_step_deg;
        wide[all - 1] = reach.high;
    }
    return wide;
}

/* Adds zeros beyond the measured angles: grids extrapolate beyond their ends, but a luminaire emits
 * nothing beyond the angles of its file. */
static int add_zeros(struct orl_ies *ies)
{
    const uint32_t n = ies->n_vertical, planes = ies->n_horizontal;
    const struct reach up = reach_of(ies, ies->vertical), side = reach_of(ies, ies->horizontal);
    const struct margins v = margins_of(ies->vertical, n, up);
    const struct margins h = ies->type_b && planes > 1 ? margins_of(ies->horizontal, planes, side)
                                                       : (struct margins){0, 0};
    const uint32_t rows = h.before + planes + h.behind, all = v.before + n + v.behind;
    double *const vertical = widen_angles(ies->vertical, n, up, v);
    double *const horizontal = widen_angles(ies->horizontal, planes, side, h);
    float *const candela = calloc((size_t)rows * all, sizeof *candela);
    if (!vertical || !horizontal || !candela) {
        free(vertical);
        free(horizontal);
        free(candela);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < planes; i++)
        memcpy(candela + (h.before + i) * all + v.before, ies->candela + i * n,
               n * sizeof *candela);
    free(ies->vertical);
    free(ies->horizontal);
    free(ies->candela);
    ies->vertical = vertical;
    ies->horizontal = horizontal;
    ies->candela = candela;
    ies->n_vertical = all;
    ies->n_horizontal = rows;
    return 0;
}

/* Adds the last plane to a file of type C that lacks it: a copy of the first plane if the angles go
 * all the way round, else a copy of the last. */
static int add_plane(struct orl_ies *ies)
{
    const size_t n = ies->n_horizontal, angles = ies->n_vertical;
    if (ies->type_b || orl_ies_has_all_planes(ies))
        return 0;
    const double end = end_of_planes(ies);
    const size_t from = end - ies->horizontal[0] > 180 + least_step_deg ? 0 : n - 1;
    double *const horizontal = realloc(ies->horizontal, (n + 1) * sizeof *horizontal);
    if (horizontal)
        ies->horizontal = horizontal;
    float *const candela = realloc(ies->candela, (n + 1) * angles * sizeof *candela);
    if (candela)
        ies->candela = candela;
    if (!horizontal || !candela)
        return ORL_ERR_NOMEM;
    horizontal[n] = end;
    memcpy(candela + n * angles, candela + from * angles, angles * sizeof *candela);
    ies->n_horizontal++;
    return 0;
}

static void take_axis(struct orl_grid *grid, double **places, uint32_t n)
{
    double *const p = *places;
    grid->axes[grid->n_axes++] = (struct orl_grid_axis){p[0], p[n - 1] - p[0], n, p};
    *places = NULL;
}

int orl_ies_grid(struct orl_ies *ies, struct orl_grid **ret_grid, struct orl_error *err)
{
    struct orl_grid *const grid = calloc(1, sizeof *grid);
    if (!grid || add_plane(ies) < 0 || add_zeros(ies) < 0) {
        free(grid);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a luminaire");
    }
    grid->channels = 1;
    grid->n_values = (size_t)ies->n_vertical * ies->n_horizontal;
    if (ies->n_horizontal > 1)
        take_axis(grid, &ies->horizontal, ies->n_horizontal);
    take_axis(grid, &ies->vertical, ies->n_vertical);
    for (size_t i = 0; i < grid->n_values; i++)
        ies->candela[i] = (float)((double)ies->candela[i] / ORL_EFFICACY_LM_PER_W);
    grid->values = ies->candela;
    ies->candela = NULL;
    *ret_grid = grid;
    return 0;
}

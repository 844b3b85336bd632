/* Reads measurements: lines and scans, then pab-opto's text and CSV, then the choice between
 * them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"
#include "base/text/words.h"
#include "bsdf/fit/measurements/measurements.h"
#include "bsdf/xml/data_text.h"

/* ---- Lines ----------------------------------------------------------------------------------- */

enum { LINES_A_POLL = 4096 }; /* lines read between two checks of the cancel flag */

/* Angles as filed, in degrees. up_deg: the azimuth that is up. */
struct filed_angles {
    double theta_in, phi_in, theta_out, phi_out, up_deg;
};

/* Header of pab-opto's text, as read so far. */
struct header {
    struct filed_angles angles;
    bool has_theta, has_phi, has_format, is_dsf;
    int values; /* number of values in a row */
};

enum { THETA_IN, PHI_IN, THETA_OUT, PHI_OUT, BSDF, DSF, UP, KINDS, COLUMNS_MAX = 16 };

/* Columns of a CSV. */
struct table {
    char separator;
    size_t n_columns;
    int kinds[COLUMNS_MAX]; /* kind of each column */
    bool has[KINDS];
};

/* One file's text, read line by line into the data. */
struct reader {
    struct orl_scanner scanner;
    uint32_t file;
    const struct orl_fit_read_options *options;
    struct orl_fit_data *data;
    struct orl_error *err;
    struct header header;
    struct table table;
    bool in_rows; /* a row was read */
};

/* Sets the error, formatted as by printf, with the line; its value is the code. */
#define FAIL(r, code, ...) orl_scanner_fail(&(r)->scanner, code, (r)->err, __VA_ARGS__)

/* Returns the next line; *ret_more is false after the last. Returns 0 or ORL_ERR_CANCELLED. */
static int next_line(struct reader *r, struct orl_slice *ret_line, bool *ret_more)
{
    if (r->scanner.line % LINES_A_POLL == 1 && orl_is_cancelled(r->options->cancel))
        return orl_error_set(r->err, ORL_ERR_CANCELLED, "cancelled");
    *ret_more = orl_scanner_line(&r->scanner, ret_line);
    return 0;
}

/* Parses a number; an error names it with `what`. */
static int parse_number(const struct reader *r, struct orl_slice word, const char *what,
                        double *ret_value)
{
    double value;
    const int code = orl_scanner_number(&r->scanner, word, what, &value, r->err);
    if (code < 0)
        return code;
    if (!(fabs(value) <= ORL_BSDF_VALUE_MAX))
        return FAIL(r, ORL_ERR_RANGE, "%s is too large", what);
    *ret_value = value;
    return 0;
}

/* ---- Scans ----------------------------------------------------------------------------------- */

/* Incident directions are the same if they are within half of this, in degrees. */
static const double same_deg = 0.02;

static struct orl_vec3 direction_of(double theta_deg, double phi_deg)
{
    const double theta = theta_deg * ORL_DEG_TO_RAD, phi = phi_deg * ORL_DEG_TO_RAD;
    const double sine = sin(theta);
    return orl_v3(sine * cos(phi), sine * sin(phi), theta_deg > 89.9999999 ? 0 : cos(theta));
}

/* Returns an azimuth in the range 0 to 360. */
static double wrap_azimuth(double phi_deg)
{
    const double phi = fmod(phi_deg, 360);
    return phi < 0 ? phi + 360 : phi;
}

/* Returns true if the row belongs to the scan. Near the normal the azimuth is ignored. */
static bool is_scan_of(const struct orl_fit_scan *scan, bool front, bool transmitted, double theta,
                       double phi)
{
    const double apart = fabs(scan->phi_deg - phi);
    return scan->front == front && scan->transmitted == transmitted &&
           fabs(scan->theta_deg - theta) <= 0.5 * same_deg &&
           (theta <= 0.5 * same_deg ||
            fmin(apart, 360 - apart) * sin(theta * ORL_DEG_TO_RAD) <= 0.5 * same_deg);
}

static int add_scan(const struct reader *r, bool front, bool transmitted, double theta, double phi)
{
    struct orl_fit_data *data = r->data;
    if (data->n_scans >= ORL_LIMIT_MEASURED_SCANS)
        return FAIL(r, ORL_ERR_LIMIT, "more than %u pairs of incident direction and exit side",
                    ORL_LIMIT_MEASURED_SCANS);
    if (!orl_array_reserve(&data->scans, &data->capacity, data->n_scans, sizeof *data->scans))
        return FAIL(r, ORL_ERR_NOMEM, "out of memory for measurements");
    data->last = data->n_scans;
    data->scans[data->n_scans++] = (struct orl_fit_scan){.front = front,
                                                         .transmitted = transmitted,
                                                         .theta_deg = theta,
                                                         .phi_deg = theta > 0 ? phi : 0,
                                                         .in = direction_of(theta, phi)};
    return 0;
}

/* Finds or adds the scan of a row; usually it is that of the previous row. */
static int find_scan(const struct reader *r, bool front, bool transmitted, double theta, double phi)
{
    struct orl_fit_data *data = r->data;
    if (data->n_scans > 0 && is_scan_of(&data->scans[data->last], front, transmitted, theta, phi))
        return 0;
    for (size_t i = 0; i < data->n_scans; i++)
        if (is_scan_of(&data->scans[i], front, transmitted, theta, phi)) {
            data->last = i;
            return 0;
        }
    return add_scan(r, front, transmitted, theta, phi);
}

/* Changes theta to the angle from its own side's normal, 0 to 90. Returns true on the front. */
static bool fold_theta(double *theta_deg)
{
    const bool front = *theta_deg < 90;
    if (!front)
        *theta_deg = 180 - *theta_deg;
    return front;
}

static int check_angles(const struct reader *r, const struct filed_angles *a)
{
    if (!(a->theta_in >= 0 && a->theta_in <= 180 && fabs(a->theta_in - 90) > 1e-6))
        return FAIL(
            r, ORL_ERR_RANGE,
            "theta of the incident direction is %g: it must be from 0 to 180 degrees, but not 90",
            a->theta_in);
    if (!(a->theta_out >= 0 && a->theta_out <= 180))
        return FAIL(r, ORL_ERR_RANGE,
                    "theta of the exit direction is %g: it must be from 0 to 180 degrees",
                    a->theta_out);
    if (!(fabs(a->phi_in) <= 720 && fabs(a->phi_out) <= 720 && fabs(a->up_deg) <= 720))
        return FAIL(r, ORL_ERR_RANGE, "an azimuth must be from -720 to 720 degrees");
    return 0;
}

/* Adds a row to its scan. is_dsf: the value is the BSDF times the cosine of the angle out. */
static int add_row(const struct reader *r, const struct filed_angles *angles, double value,
                   bool is_dsf)
{
    struct orl_fit_data *data = r->data;
    int code = check_angles(r, angles);
    if (code < 0)
        return code;
    double in = angles->theta_in, out = angles->theta_out;
    const double turn = r->options->reversed ? -1 : 1;
    bool in_front = fold_theta(&in), out_front = fold_theta(&out);
    const double phi_in = wrap_azimuth(turn * (angles->phi_in - angles->up_deg) + 90);
    const double phi_out = turn * (angles->phi_out - angles->up_deg) + 90;
    const struct orl_vec3 d = direction_of(out, phi_out);
    in_front ^= r->options->reversed;
    out_front ^= r->options->reversed;
    if (data->n_rows >= ORL_LIMIT_MEASURED_ROWS)
        return FAIL(r, ORL_ERR_LIMIT, "more than %lu rows of measurements",
                    ORL_LIMIT_MEASURED_ROWS);
    data->n_rows++;
    /* Along the surface a DSF is 0 whatever the BSDF. */
    if (90 - out < r->options->grazing_deg || (is_dsf && d.z < 1e-3))
        return 0;
    code = find_scan(r, in_front, in_front != out_front, in, phi_in);
    if (code < 0)
        return code;
    struct orl_fit_scan *scan = &data->scans[data->last];
    if (!orl_array_reserve(&scan->rows, &scan->capacity, scan->n_rows, sizeof *scan->rows))
        return FAIL(r, ORL_ERR_NOMEM, "out of memory for measurements");
    scan->rows[scan->n_rows++] =
        (struct orl_fit_row){(float)d.x, (float)d.y,
                             (float)d.z, (float)(is_dsf ? value / d.z : value),
                             r->file,    (uint32_t)r->scanner.line};
    return 0;
}

void orl_fit_data_done(struct orl_fit_data *data)
{
    for (size_t i = 0; i < data->n_scans; i++)
        free(data->scans[i].rows);
    free(data->scans);
    memset(data, 0, sizeof *data);
}

/* ---- pab-opto's text: header lines that begin with #, then rows ------------------------------ */

static int read_angle(struct reader *r, struct orl_slice *line, const char *what, double *into,
                      bool *has)
{
    const int code = parse_number(r, orl_slice_take_word(line), what, into);
    if (code == 0)
        *has = true;
    return code;
}

static int read_format(struct reader *r, struct orl_slice line)
{
    static const char *const bsdf[] = {"BSDF", "BRDF", "BTDF"};
    const bool angles = orl_slice_is_nocase(orl_slice_take_word(&line), "theta") &&
                        orl_slice_is_nocase(orl_slice_take_word(&line), "phi");
    const struct orl_slice kind = orl_slice_take_word(&line);
    r->header.is_dsf = orl_slice_is_nocase(kind, "DSF");
    bool known = r->header.is_dsf;
    for (size_t i = 0; i < sizeof bsdf / sizeof *bsdf; i++)
        known = known || orl_slice_is_nocase(kind, bsdf[i]);
    r->header.has_format = true;
    return angles && known ? 0
                           : FAIL(r, ORL_ERR_UNSUPPORTED,
                                  "the format is not supported: write \"theta phi DSF\", "
                                  "or BSDF, BRDF, BTDF in place of DSF");
}

static int read_colorimetry(struct reader *r, struct orl_slice word)
{
    if (orl_slice_is_nocase(word, "CIE-XYZ")) {
        r->header.values = 3;
        r->data->color_left_out = true;
    } else if (orl_slice_is_nocase(word, "CIE-Y")) {
        r->header.values = 1;
    } else {
        return FAIL(r, ORL_ERR_UNSUPPORTED, "the colorimetry is neither CIE-Y nor CIE-XYZ");
    }
    return 0;
}

/* Reads the sample's name between quotes. */
static void read_sample_name(struct orl_slice line, struct orl_fit_data *data)
{
    const char *first = memchr(line.text, '"', line.length);
    if (!first)
        return;
    const size_t left = line.length - (size_t)(first + 1 - line.text);
    const char *last = memchr(first + 1, '"', left);
    size_t length = last ? (size_t)(last - first - 1) : left;
    length = length < sizeof data->name ? length : sizeof data->name - 1;
    memcpy(data->name, first + 1, length);
    data->name[length] = '\0';
}

/* Reads one header line. Unknown lines belong to the instrument and are ignored. */
static int read_header(struct reader *r, struct orl_slice line)
{
    bool ignored;
    line.text++;
    line.length--;
    const struct orl_slice key = orl_slice_take_word(&line);
    if (orl_slice_is_nocase(key, "format:"))
        return read_format(r, line);
    if (orl_slice_is_nocase(key, "colorimetry:"))
        return read_colorimetry(r, orl_slice_take_word(&line));
    if (orl_slice_is_nocase(key, "sample_name"))
        read_sample_name(line, r->data);
    if (orl_slice_is_nocase(key, "upphi"))
        return read_angle(r, &line, "upphi", &r->header.angles.up_deg, &ignored);
    if (orl_slice_is_nocase(key, "intheta"))
        return read_angle(r, &line, "intheta", &r->header.angles.theta_in, &r->header.has_theta);
    if (orl_slice_is_nocase(key, "inphi"))
        return read_angle(r, &line, "inphi", &r->header.angles.phi_in, &r->header.has_phi);
    if (!orl_slice_is_nocase(key, "incident_angle"))
        return 0;
    const int code = read_angle(r, &line, "the first incident_angle", &r->header.angles.theta_in,
                                &r->header.has_theta);
    return code < 0 ? code
                    : read_angle(r, &line, "the second incident_angle", &r->header.angles.phi_in,
                                 &r->header.has_phi);
}

static int check_header(struct reader *r)
{
    if (!r->header.has_format)
        return FAIL(
            r, ORL_ERR_SYNTAX,
            "there is no \"#format: theta phi DSF\" (or BSDF, BRDF, BTDF) before the first row");
    if (!r->header.has_theta || !r->header.has_phi)
        return FAIL(r, ORL_ERR_SYNTAX,
                    "there is no \"#incident_angle theta phi\", nor #intheta and #inphi, "
                    "before the first row");
    return 0;
}

static int read_pab_row(struct reader *r, struct orl_slice line)
{
    double values[3] = {0};
    int code = parse_number(r, orl_slice_take_word(&line), "theta", &r->header.angles.theta_out);
    if (code == 0)
        code = parse_number(r, orl_slice_take_word(&line), "phi", &r->header.angles.phi_out);
    for (int i = 0; i < r->header.values && code == 0; i++)
        code = parse_number(r, orl_slice_take_word(&line), "the value", &values[i]);
    if (code == 0 && orl_slice_take_word(&line).length > 0)
        code = FAIL(r, ORL_ERR_SYNTAX, "a row must be theta, phi and %s",
                    r->header.values == 3 ? "three values" : "one value");
    if (code == 0)
        code = add_row(r, &r->header.angles, values[r->header.values / 2], r->header.is_dsf);
    return code;
}

static int read_pab_line(struct reader *r, struct orl_slice line)
{
    if (line.text[0] == '#') /* among rows a comment */
        return r->in_rows ? 0 : read_header(r, line);
    const int code = r->in_rows ? 0 : check_header(r);
    r->in_rows = true;
    return code < 0 ? code : read_pab_row(r, line);
}

/* ---- CSV: a line of column names, then rows -------------------------------------------------- */

static const char *const names[KINDS] = {"theta_in", "phi_in", "theta_out", "phi_out",
                                         "bsdf",     "dsf",    "up"};

static char separator_of(struct orl_slice line)
{
    static const char separators[] = {';', '\t', ','};
    for (size_t i = 0; i < sizeof separators; i++)
        if (memchr(line.text, separators[i], line.length))
            return separators[i];
    return ',';
}

static int read_column_name(struct reader *r, struct orl_slice field)
{
    for (int kind = 0; kind < KINDS; kind++) {
        if (!orl_slice_is_nocase(field, names[kind]))
            continue;
        if (r->table.has[kind])
            return FAIL(r, ORL_ERR_SYNTAX, "the column %s is given twice", names[kind]);
        r->table.has[kind] = true;
        r->table.kinds[r->table.n_columns++] = kind;
        return 0;
    }
    return FAIL(r, ORL_ERR_SYNTAX,
                "\"%.*s\" is not a known column: use theta_in, phi_in, theta_out, phi_out, "
                "bsdf or dsf, and up",
                (int)(field.length < 40 ? field.length : 40), field.text);
}

static int read_column_names(struct reader *r, struct orl_slice line)
{
    struct orl_slice field;
    r->table.separator = separator_of(line);
    while (orl_slice_take_cell(&line, r->table.separator, &field)) {
        const int code = read_column_name(r, field);
        if (code < 0)
            return code;
    }
    for (int kind = 0; kind <= PHI_OUT; kind++)
        if (!r->table.has[kind])
            return FAIL(r, ORL_ERR_SYNTAX, "there is no column %s", names[kind]);
    if (r->table.has[BSDF] == r->table.has[DSF])
        return FAIL(r, ORL_ERR_SYNTAX, "exactly one column of bsdf or dsf is needed");
    return 0;
}

static int read_csv_row(struct reader *r, struct orl_slice line)
{
    double values[KINDS] = {[UP] = 90};
    struct orl_slice field;
    size_t column = 0;
    for (; orl_slice_take_cell(&line, r->table.separator, &field); column++) {
        if (column >= r->table.n_columns)
            continue;
        const int kind = r->table.kinds[column];
        const int code = parse_number(r, field, names[kind], &values[kind]);
        if (code < 0)
            return code;
    }
    if (column != r->table.n_columns)
        return FAIL(r, ORL_ERR_SYNTAX, "each row must have %zu columns", r->table.n_columns);
    const struct filed_angles angles = {values[THETA_IN], values[PHI_IN], values[THETA_OUT],
                                        values[PHI_OUT], values[UP]};
    return add_row(r, &angles, values[r->table.has[DSF] ? DSF : BSDF], r->table.has[DSF]);
}

static int read_csv_line(struct reader *r, struct orl_slice line)
{
    struct orl_slice rest = line;
    if (*orl_slice_take_word(&rest).text == '#')
        return 0;
    if (r->table.n_columns == 0)
        return read_column_names(r, line);
    r->in_rows = true;
    return read_csv_row(r, line);
}

/* ---- Choice of the format -------------------------------------------------------------------- */

/* Returns true if the word begins with a number, including "nan" or "inf". */
static bool begins_number(struct orl_slice word)
{
    double value;
    size_t length = 0;
    while (length < word.length && word.text[length] != ',' && word.text[length] != ';')
        length++;
    return orl_number_read(word.text, length, &value) != ORL_NUMBER_INVALID;
}

/* Returns true for a CSV, which is recognised by a first line of words. */
static bool is_csv(const struct orl_scanner *scanner)
{
    struct orl_scanner ahead = *scanner;
    struct orl_slice word;
    while (orl_scanner_next_line(&ahead)) {
        if (!orl_scanner_word_of_line(&ahead, &word) || *word.text == '#')
            continue;
        const char c = *word.text;
        const bool is_word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"';
        return is_word && !begins_number(word);
    }
    return false;
}

int orl_fit_read(const char *name, uint32_t file, const char *text, size_t size,
                 const struct orl_fit_read_options *options, struct orl_fit_data *data,
                 struct orl_error *err)
{
    struct reader reader = {
        .file = file, .options = options, .data = data, .err = err, .header = {.values = 1}};
    struct orl_slice line;
    bool more = false;
    int code = orl_scanner_init(&reader.scanner, name, text, size, 0, err);
    if (code < 0)
        return code;
    const bool csv = is_csv(&reader.scanner);
    while ((code = next_line(&reader, &line, &more)) == 0 && more) {
        struct orl_slice rest = line;
        if (orl_slice_take_word(&rest).length > 0)
            code = csv ? read_csv_line(&reader, line) : read_pab_line(&reader, line);
        if (code < 0)
            return code;
    }
    if (code == 0 && !reader.in_rows)
        code = FAIL(&reader, ORL_ERR_SYNTAX, "there is no row of measurements");
    return code;
}

int orl_fit_read_file(const struct orl_files *files, const char *name, uint32_t index,
                      const struct orl_fit_read_options *options, struct orl_fit_data *data,
                      struct orl_error *err)
{
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = orl_fit_read(name, index, file.data, file.size, options, data, err);
    files->close(files->ctx, &file);
    return code;
}

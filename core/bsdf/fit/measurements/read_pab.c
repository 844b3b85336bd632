/* Measurements in pab-opto's text format: header lines that begin with #, then rows of theta, phi
 * and values. */
#include "bsdf/fit/measurements/rows.h"

#include <string.h>

/* Header read so far. */
struct header {
    struct orl_fit_angles angles;
    bool has_theta, has_phi, has_format, is_dsf;
    int values; /* number of values in a row */
};

static int read_angle(const struct orl_fit_lines *lines, struct orl_slice *line, const char *what,
                      double *into, bool *has, struct orl_error *err)
{
    const int code = orl_fit_number(lines, orl_slice_take_word(line), what, into, err);
    if (code == 0)
        *has = true;
    return code;
}

static int read_format(const struct orl_fit_lines *lines, struct orl_slice line,
                       struct header *header, struct orl_error *err)
{
    static const char *const bsdf[] = {"BSDF", "BRDF", "BTDF"};
    const bool angles = orl_slice_is_nocase(orl_slice_take_word(&line), "theta") &&
                        orl_slice_is_nocase(orl_slice_take_word(&line), "phi");
    const struct orl_slice kind = orl_slice_take_word(&line);
    header->is_dsf = orl_slice_is_nocase(kind, "DSF");
    bool known = header->is_dsf;
    for (size_t i = 0; i < sizeof bsdf / sizeof *bsdf; i++)
        known = known || orl_slice_is_nocase(kind, bsdf[i]);
    header->has_format = true;
    return angles && known ? 0
                           : orl_fit_fail(lines, ORL_ERR_UNSUPPORTED, err,
                                          "the format is none that is read: \"theta phi DSF\", or "
                                          "BSDF, BRDF, BTDF in place of DSF");
}

static int read_colorimetry(const struct orl_fit_lines *lines, struct orl_slice word,
                            struct header *header, struct orl_fit_data *data, struct orl_error *err)
{
    if (orl_slice_is_nocase(word, "CIE-XYZ")) {
        header->values = 3;
        data->color_left_out = true;
    } else if (orl_slice_is_nocase(word, "CIE-Y")) {
        header->values = 1;
    } else {
        return orl_fit_fail(lines, ORL_ERR_UNSUPPORTED, err,
                            "the colorimetry is neither CIE-Y nor CIE-XYZ");
    }
    return 0;
}

/* Reads the sample's name between quotes. */
static void read_name(struct orl_slice line, struct orl_fit_data *data)
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

/* Unknown lines are ignored; they are the instrument's own. */
static int read_header(const struct orl_fit_lines *lines, struct orl_slice line, struct header *h,
                       struct orl_fit_data *data, struct orl_error *err)
{
    bool ignored;
    line.text++;
    line.length--;
    const struct orl_slice key = orl_slice_take_word(&line);
    if (orl_slice_is_nocase(key, "format:"))
        return read_format(lines, line, h, err);
    if (orl_slice_is_nocase(key, "colorimetry:"))
        return read_colorimetry(lines, orl_slice_take_word(&line), h, data, err);
    if (orl_slice_is_nocase(key, "sample_name"))
        read_name(line, data);
    if (orl_slice_is_nocase(key, "upphi"))
        return read_angle(lines, &line, "upphi", &h->angles.up_deg, &ignored, err);
    if (orl_slice_is_nocase(key, "intheta"))
        return read_angle(lines, &line, "intheta", &h->angles.theta_in, &h->has_theta, err);
    if (orl_slice_is_nocase(key, "inphi"))
        return read_angle(lines, &line, "inphi", &h->angles.phi_in, &h->has_phi, err);
    if (!orl_slice_is_nocase(key, "incident_angle"))
        return 0;
    const int code = read_angle(lines, &line, "the first incident_angle", &h->angles.theta_in,
                                &h->has_theta, err);
    return code < 0 ? code
                    : read_angle(lines, &line, "the second incident_angle", &h->angles.phi_in,
                                 &h->has_phi, err);
}

static int check_header(const struct orl_fit_lines *lines, const struct header *h,
                        struct orl_error *err)
{
    if (!h->has_format)
        return orl_fit_fail(lines, ORL_ERR_SYNTAX, err,
                            "before the first row there is no \"#format: theta phi DSF\" (or BSDF, "
                            "BRDF, BTDF)");
    if (!h->has_theta || !h->has_phi)
        return orl_fit_fail(lines, ORL_ERR_SYNTAX, err,
                            "before the first row there is no \"#incident_angle theta phi\", nor "
                            "#intheta and #inphi");
    return 0;
}

static int read_row(const struct orl_fit_lines *lines, struct orl_slice line, struct header *h,
                    struct orl_fit_data *data, struct orl_error *err)
{
    double values[3] = {0};
    int code =
        orl_fit_number(lines, orl_slice_take_word(&line), "theta", &h->angles.theta_out, err);
    if (code == 0)
        code = orl_fit_number(lines, orl_slice_take_word(&line), "phi", &h->angles.phi_out, err);
    for (int i = 0; i < h->values && code == 0; i++)
        code = orl_fit_number(lines, orl_slice_take_word(&line), "the value", &values[i], err);
    if (code == 0 && orl_slice_take_word(&line).length > 0)
        code = orl_fit_fail(lines, ORL_ERR_SYNTAX, err, "a row is theta, phi and %s",
                            h->values == 3 ? "three values" : "one value");
    if (code == 0)
        code = orl_fit_add_row(lines, data, &h->angles, values[h->values / 2], h->is_dsf, err);
    return code;
}

int orl_fit_read_pab(struct orl_fit_lines *lines, struct orl_fit_data *data, struct orl_error *err)
{
    struct header header = {.values = 1};
    struct orl_slice line;
    bool more, in_rows = false;
    int code;
    while ((code = orl_fit_next_line(lines, &line, &more, err)) == 0 && more) {
        struct orl_slice rest = line;
        const bool is_header = line.length > 0 && line.text[0] == '#';
        if (is_header && in_rows)
            continue; /* comments */
        if (is_header) {
            code = read_header(lines, line, &header, data, err);
        } else if (orl_slice_take_word(&rest).length > 0) {
            code = in_rows ? 0 : check_header(lines, &header, err);
            in_rows = true;
            if (code == 0)
                code = read_row(lines, line, &header, data, err);
        }
        if (code < 0)
            return code;
    }
    if (code == 0 && !in_rows)
        code = orl_fit_fail(lines, ORL_ERR_SYNTAX, err, "there is no row of measurements");
    return code;
}

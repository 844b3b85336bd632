#include "bsdf/fit/measurements/rows.h"

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"
#include "bsdf/xml/scan.h"

/* ---- Lines ----------------------------------------------------------------------------------- */

enum { LINES_A_POLL = 4096 };

int orl_fit_fail(const struct orl_fit_lines *lines, int code, struct orl_error *err,
                 const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    orl_error_vset(err, code, format, arguments);
    va_end(arguments);
    orl_error_at(err, lines->scanner.name, lines->scanner.line, NULL);
    return code;
}

int orl_fit_next_line(struct orl_fit_lines *lines, struct orl_slice *ret_line, bool *ret_more,
                      struct orl_error *err)
{
    if (lines->scanner.line % LINES_A_POLL == 1 && orl_is_cancelled(lines->options->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    *ret_more = orl_scanner_line(&lines->scanner, ret_line);
    return 0;
}

int orl_fit_number(const struct orl_fit_lines *lines, struct orl_slice word, const char *what,
                   double *ret_value, struct orl_error *err)
{
    double value;
    const int code = orl_scanner_number(&lines->scanner, word, what, &value, err);
    if (code < 0)
        return code;
    if (!(fabs(value) <= ORL_BSDF_VALUE_MAX))
        return orl_fit_fail(lines, ORL_ERR_RANGE, err, "%s is beyond all bounds", what);
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

/* Near the normal the azimuth is ignored. */
static bool is_scan_of(const struct orl_fit_scan *scan, bool front, bool transmitted, double theta,
                       double phi)
{
    const double apart = fabs(scan->phi_deg - phi);
    return scan->front == front && scan->transmitted == transmitted &&
           fabs(scan->theta_deg - theta) <= 0.5 * same_deg &&
           (theta <= 0.5 * same_deg ||
            fmin(apart, 360 - apart) * sin(theta * ORL_DEG_TO_RAD) <= 0.5 * same_deg);
}

static int add_scan(const struct orl_fit_lines *lines, struct orl_fit_data *data, bool front,
                    bool transmitted, double theta, double phi, struct orl_error *err)
{
    if (data->n_scans >= ORL_LIMIT_MEASURED_SCANS)
        return orl_fit_fail(lines, ORL_ERR_LIMIT, err,
                            "more than %u incident directions and sides out",
                            ORL_LIMIT_MEASURED_SCANS);
    if (!orl_array_reserve(&data->scans, &data->capacity, data->n_scans, sizeof *data->scans))
        return orl_fit_fail(lines, ORL_ERR_NOMEM, err, "out of memory for measurements");
    data->last = data->n_scans;
    data->scans[data->n_scans++] = (struct orl_fit_scan){.front = front,
                                                         .transmitted = transmitted,
                                                         .theta_deg = theta,
                                                         .phi_deg = theta > 0 ? phi : 0,
                                                         .in = direction_of(theta, phi)};
    return 0;
}

/* Finds or adds the scan of a row; usually it is that of the previous row. */
static int find_scan(const struct orl_fit_lines *lines, struct orl_fit_data *data, bool front,
                     bool transmitted, double theta, double phi, struct orl_error *err)
{
    if (data->n_scans > 0 && is_scan_of(&data->scans[data->last], front, transmitted, theta, phi))
        return 0;
    for (size_t i = 0; i < data->n_scans; i++)
        if (is_scan_of(&data->scans[i], front, transmitted, theta, phi)) {
            data->last = i;
            return 0;
        }
    return add_scan(lines, data, front, transmitted, theta, phi, err);
}

/* Changes theta to the angle from its own side's normal, 0 to 90. Returns true on the front. */
static bool fold_theta(double *theta_deg)
{
    const bool front = *theta_deg < 90;
    if (!front)
        *theta_deg = 180 - *theta_deg;
    return front;
}

static int check_angles(const struct orl_fit_lines *lines, const struct orl_fit_angles *a,
                        struct orl_error *err)
{
    if (!(a->theta_in >= 0 && a->theta_in <= 180 && fabs(a->theta_in - 90) > 1e-6))
        return orl_fit_fail(lines, ORL_ERR_RANGE, err,
                            "theta of the incident direction is %g: from 0 to 180 degrees, and "
                            "not 90",
                            a->theta_in);
    if (!(a->theta_out >= 0 && a->theta_out <= 180))
        return orl_fit_fail(lines, ORL_ERR_RANGE, err,
                            "theta of the direction out is %g: from 0 to 180 degrees are",
                            a->theta_out);
    if (!(fabs(a->phi_in) <= 720 && fabs(a->phi_out) <= 720 && fabs(a->up_deg) <= 720))
        return orl_fit_fail(lines, ORL_ERR_RANGE, err, "an azimuth is from -720 to 720 degrees");
    return 0;
}

int orl_fit_add_row(const struct orl_fit_lines *lines, struct orl_fit_data *data,
                    const struct orl_fit_angles *angles, double value, bool is_dsf,
                    struct orl_error *err)
{
    int code = check_angles(lines, angles, err);
    if (code < 0)
        return code;
    double in = angles->theta_in, out = angles->theta_out;
    const double turn = lines->options->reversed ? -1 : 1;
    bool in_front = fold_theta(&in), out_front = fold_theta(&out);
    const double phi_in = wrap_azimuth(turn * (angles->phi_in - angles->up_deg) + 90);
    const double phi_out = turn * (angles->phi_out - angles->up_deg) + 90;
    const struct orl_vec3 d = direction_of(out, phi_out);
    in_front ^= lines->options->reversed;
    out_front ^= lines->options->reversed;
    if (data->n_rows >= ORL_LIMIT_MEASURED_ROWS)
        return orl_fit_fail(lines, ORL_ERR_LIMIT, err, "more than %lu rows of measurements",
                            ORL_LIMIT_MEASURED_ROWS);
    data->n_rows++;
    /* Along the surface a DSF is 0 for any BSDF. */
    if (90 - out < lines->options->grazing_deg || (is_dsf && d.z < 1e-3))
        return 0;
    code = find_scan(lines, data, in_front, in_front != out_front, in, phi_in, err);
    if (code < 0)
        return code;
    struct orl_fit_scan *scan = &data->scans[data->last];
    if (!orl_array_reserve(&scan->rows, &scan->capacity, scan->n_rows, sizeof *scan->rows))
        return orl_fit_fail(lines, ORL_ERR_NOMEM, err, "out of memory for measurements");
    scan->rows[scan->n_rows++] =
        (struct orl_fit_row){(float)d.x,  (float)d.y,
                             (float)d.z,  (float)(is_dsf ? value / d.z : value),
                             lines->file, (uint32_t)lines->scanner.line};
    return 0;
}

void orl_fit_data_done(struct orl_fit_data *data)
{
    if (!data)
        return;
    for (size_t i = 0; i < data->n_scans; i++)
        free(data->scans[i].rows);
    free(data->scans);
    memset(data, 0, sizeof *data);
}

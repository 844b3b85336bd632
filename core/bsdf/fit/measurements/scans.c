/* Order of scans, symmetry of the sample, and mirror images of rows. */
#include "bsdf/fit/measurements/measurements.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "bsdf/fit/fit.h"

/* Degrees from the normal within which azimuths are ignored. Degrees from an axis within which a
 * direction is on neither side of it. */
static const double near_normal_deg = 1, near_axis_deg = 1;

/* ---- Symmetry from azimuths ----------------------------------------------------------------- */

static double azimuth_between(double phi, double other)
{
    const double apart = fabs(phi - other);
    return fmin(apart, 360 - apart);
}

/* Returns true if all directions of each component have one azimuth or, with opposite_too, two that
 * are half a turn apart. */
static bool have_one_azimuth(const struct orl_fit_data *data, bool opposite_too)
{
    const struct orl_fit_scan *first[2][2] = {{NULL}};
    for (size_t i = 0; i < data->n_scans; i++) {
        const struct orl_fit_scan *s = &data->scans[i], **of = &first[s->front][s->transmitted];
        if (s->theta_deg < near_normal_deg)
            continue;
        if (!*of)
            *of = s;
        const double apart = azimuth_between(s->phi_deg, (*of)->phi_deg);
        if (apart > near_axis_deg && !(opposite_too && apart > 180 - near_axis_deg))
            return false;
    }
    return true;
}

/* Returns the quarters that contain directions, as bits; directions on an axis are in none. */
static unsigned quarters_of(const struct orl_fit_data *data, unsigned *ret_axes)
{
    unsigned quarters = 0;
    *ret_axes = 0;
    for (size_t i = 0; i < data->n_scans; i++) {
        const double phi = data->scans[i].phi_deg, off = fmod(phi, 90);
        if (data->scans[i].theta_deg < near_normal_deg)
            continue;
        if (off > near_axis_deg && off < 90 - near_axis_deg)
            quarters |= 1U << (unsigned)(phi / 90);
        else
            *ret_axes |= 1U << ((unsigned)((phi + 45) / 90) & 3);
    }
    return quarters;
}

/* Returns the quarters between axes; used if no direction is inside a quarter. */
static unsigned quarters_between(unsigned axes)
{
    unsigned quarters = 0;
    for (unsigned q = 0; q < 4; q++)
        if ((axes >> q & 1) && (axes >> (q + 1) % 4 & 1))
            quarters |= 1U << q;
    return quarters;
}

static enum orl_bsdf_fit_symmetry symmetry_of(unsigned quarters)
{
    switch (quarters) {
    case 1:
    case 2:
    case 4:
    case 8:
        return ORL_BSDF_FIT_QUADRILATERAL;
    case 1 | 2:
    case 4 | 8:
        return ORL_BSDF_FIT_UP_DOWN;
    case 2 | 4:
    case 8 | 1:
        return ORL_BSDF_FIT_LEFT_RIGHT;
    case 15:
        return ORL_BSDF_FIT_ASYMMETRIC;
    default:
        return ORL_BSDF_FIT_AUTO;
    }
}

static int find_symmetry(const struct orl_fit_data *data, enum orl_bsdf_fit_symmetry requested,
                         enum orl_bsdf_fit_symmetry *ret_symmetry, struct orl_error *err)
{
    unsigned axes;
    *ret_symmetry = requested;
    if (requested == ORL_BSDF_FIT_ISOTROPIC)
        return have_one_azimuth(data, true)
                   ? 0
                   : orl_error_set(err, ORL_ERR_INVALID,
                                   "an isotropic sample needs one incident azimuth, but the "
                                   "incident directions have several");
    if (requested != ORL_BSDF_FIT_AUTO)
        return 0;
    if (have_one_azimuth(data, false)) {
        *ret_symmetry = ORL_BSDF_FIT_ISOTROPIC;
        return 0;
    }
    unsigned quarters = quarters_of(data, &axes);
    if (quarters == 0)
        quarters = quarters_between(axes);
    *ret_symmetry = symmetry_of(quarters);
    if (*ret_symmetry != ORL_BSDF_FIT_AUTO)
        return 0;
    orl_error_set(
        err, ORL_ERR_INVALID,
        "the sample's symmetry does not follow from the azimuths of the incident directions");
    orl_error_hint(
        err, "give its symmetry: isotropic, quadrilateral, left_right, up_down, half_turn or none");
    return ORL_ERR_INVALID;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Adds the mirror images of the first n rows. */
static bool add_images(struct orl_fit_scan *scan, size_t n, unsigned mirror)
{
    const float sx = mirror & 1 ? -1 : 1, sy = mirror & 2 ? -1 : 1;
    struct orl_fit_row *rows = realloc(scan->rows, (scan->n_rows + n) * sizeof *rows);
    if (!rows)
        return false;
    scan->rows = rows;
    for (size_t i = 0; i < n; i++) {
        struct orl_fit_row row = rows[i];
        row.x *= sx;
        row.y *= sy;
        rows[scan->n_rows++] = row;
    }
    scan->capacity = scan->n_rows;
    return true;
}

/* Applies all mirrors that leave the direction in place within 0.3 degrees. */
static bool add_all_images(struct orl_fit_scan *scan, enum orl_bsdf_fit_symmetry symmetry)
{
    const double near = 2 * sin(0.3 * ORL_DEG_TO_RAD);
    const size_t n = scan->n_rows;
    unsigned mirrors[3];
    size_t n_mirrors = orl_fit_mirrors(symmetry, mirrors);
    if (symmetry == ORL_BSDF_FIT_ISOTROPIC)
        n_mirrors = orl_fit_mirrors(ORL_BSDF_FIT_QUADRILATERAL, mirrors);
    bool fine = true;
    for (size_t k = 0; k < n_mirrors && fine; k++) {
        const double off_x = mirrors[k] & 1 ? 2 * scan->in.x : 0;
        const double off_y = mirrors[k] & 2 ? 2 * scan->in.y : 0;
        if (hypot(off_x, off_y) < near)
            fine = add_images(scan, n, mirrors[k]);
    }
    return fine;
}

/* Turns a scan so that light comes from -x. */
static void turn_scan(struct orl_fit_scan *scan)
{
    const double angle = (180 - scan->phi_deg) * ORL_DEG_TO_RAD;
    const float cosine = (float)cos(angle), sine = (float)sin(angle);
    scan->in = orl_v3(-hypot(scan->in.x, scan->in.y), 0, scan->in.z);
    for (size_t i = 0; i < scan->n_rows; i++) {
        struct orl_fit_row *row = &scan->rows[i];
        const float x = row->x, y = row->y;
        row->x = cosine * x - sine * y;
        row->y = sine * x + cosine * y;
    }
}

/* ---- Scans ----------------------------------------------------------------------------------- */

static int compare_scans(const void *a, const void *b)
{
    const struct orl_fit_scan *x = a, *y = b;
    if (x->front != y->front)
        return x->front ? 1 : -1;
    if (x->transmitted != y->transmitted)
        return x->transmitted ? 1 : -1;
    if (x->theta_deg != y->theta_deg)
        return x->theta_deg < y->theta_deg ? -1 : 1;
    return (x->phi_deg > y->phi_deg) - (x->phi_deg < y->phi_deg);
}

static bool are_one(const struct orl_fit_scan *a, const struct orl_fit_scan *b)
{
    return a->front == b->front && a->transmitted == b->transmitted &&
           fabs(a->theta_deg - b->theta_deg) < 0.02;
}

/* Merges scans of equal theta of an isotropic sample; they must be sorted. */
static bool merge_scans(struct orl_fit_data *data)
{
    size_t kept = 0;
    for (size_t i = 0; i < data->n_scans; i++) {
        struct orl_fit_scan *s = &data->scans[i], *last = &data->scans[kept ? kept - 1 : 0];
        turn_scan(s);
        if (kept == 0 || !are_one(last, s)) {
            data->scans[kept++] = *s;
            continue;
        }
        if (!orl_array_reserve_more(&last->rows, &last->capacity, last->n_rows, s->n_rows + 1,
                                    sizeof *s->rows)) {
            memmove(data->scans + kept, data->scans + i, (data->n_scans - i) * sizeof *data->scans);
            data->n_scans -= i - kept;
            return false;
        }
        memcpy(last->rows + last->n_rows, s->rows, s->n_rows * sizeof *s->rows);
        last->n_rows += s->n_rows;
        free(s->rows);
    }
    data->n_scans = kept;
    return true;
}

int orl_fit_sort_scans(struct orl_fit_data *data, enum orl_bsdf_fit_symmetry requested,
                       enum orl_bsdf_fit_symmetry *ret_symmetry, struct orl_error *err)
{
    enum orl_bsdf_fit_symmetry symmetry;
    if (data->n_scans == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "all rows are grazing");
    int code = find_symmetry(data, requested, &symmetry, err);
    if (code < 0)
        return code;
    qsort(data->scans, data->n_scans, sizeof *data->scans, compare_scans);
    bool fine = symmetry != ORL_BSDF_FIT_ISOTROPIC || merge_scans(data);
    for (size_t i = 0; i < data->n_scans && fine; i++) {
        data->scans[i].n_measured = data->scans[i].n_rows;
        data->scans[i].file = data->scans[i].rows[0].file;
        fine = add_all_images(&data->scans[i], symmetry);
    }
    if (!fine)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    *ret_symmetry = symmetry;
    return 0;
}

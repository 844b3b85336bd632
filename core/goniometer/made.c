#include "goniometer/made.h"

#include <stdlib.h>

static const double counted_from = 0.01; /* share of the peak above which errors count */

void orl_gonio_peaks(const struct orl_gonio_sheet *sheet, bool front, double ret_peaks[2])
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    for (int t = 0; t < 2; t++) {
        ret_peaks[t] = 0;
        for (size_t in = 0; in < cells; in++)
            for (int out = 0; out < sheet->basis.n_cells; out++)
                ret_peaks[t] =
                    fmax(ret_peaks[t],
                         orl_luma(orl_gonio_sheet_value(sheet, front * cells + in, t, out).f));
    }
}

double orl_gonio_worst(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2])
{
    double worst = 0;
    for (int t = 0; t < 2; t++)
        for (int out = 0; out < sheet->basis.n_cells && peaks[t] > 0; out++) {
            const struct orl_gonio_value v = orl_gonio_sheet_value(sheet, item, t, out);
            const double f = orl_luma(v.f);
            if (f >= counted_from * peaks[t])
                worst = fmax(worst, v.error / f);
        }
    return worst;
}

double orl_gonio_foreseen(const struct orl_gonio_sheet *sheet, size_t item, const double peaks[2])
{
    double worst = 0;
    for (int t = 0; t < 2; t++)
        for (int out = 0; out < sheet->basis.n_cells && peaks[t] > 0; out++) {
            const struct orl_gonio_value v = orl_gonio_sheet_value(sheet, item, t, out);
            const double f = orl_luma(v.f), from = counted_from * peaks[t],
                         error = v.error / sqrt(2);
            if (f + 2 * error >= from)
                worst = fmax(worst, error / fmax(f, from));
        }
    return worst;
}

static struct orl_bsdf_made_direction direction_of(const struct orl_gonio_sheet *sheet, int in)
{
    const struct orl_basis *basis = &sheet->basis;
    const struct orl_theta_ring *ring = orl_basis_ring(basis, in);
    const double inner = acos(sqrt(ring->cos2_low)), outer = acos(sqrt(ring->cos2_high));
    const double turn = (double)(in - ring->first) / ring->cells;
    /* Cells hold the direction of travel; the result has the direction that light comes from. */
    const double phi = turn < 0.5 ? turn + 0.5 : turn - 0.5;
    struct orl_bsdf_made_direction d = {
        .theta_deg = ring->cells == 1 ? 0 : 0.5 * (inner + outer) / ORL_DEG_TO_RAD,
        .phi_deg = ring->cells == 1 ? 0 : 360 * phi};
    for (int front = 0; front < 2; front++)
        for (int t = 0; t < 2; t++)
            d.shares[front][t] = orl_gonio_sheet_share(
                sheet, (size_t)front * (size_t)basis->n_cells + (size_t)in, t);
    return d;
}

static int set_errors(const struct orl_gonio_sheet *sheet, struct orl_bsdf_made *made)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    for (size_t part = 0; part < 4; part++) {
        const size_t front = part / 2;
        const bool transmitted = part % 2;
        float *errors = malloc(cells * cells * sizeof *errors);
        made->errors[front][transmitted] = errors;
        if (!errors)
            return ORL_ERR_NOMEM;
        for (size_t i = 0; i < cells * cells; i++)
            errors[i] = (float)orl_gonio_sheet_value(sheet, front * cells + i / cells, transmitted,
                                                     (int)(i % cells))
                            .error;
    }
    return 0;
}

static void set_totals(const struct orl_gonio_sheet *sheet, struct orl_bsdf_made *made)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    double lost = 0;
    for (int front = 0; front < 2; front++) {
        double peaks[2];
        orl_gonio_peaks(sheet, front, peaks);
        for (int t = 0; t < 2; t++)
            made->diffuse[front][t] = orl_gonio_sheet_diffuse(sheet, front, t);
        for (size_t in = 0; in < cells; in++)
            made->worst =
                fmax(made->worst, orl_gonio_worst(sheet, (size_t)front * cells + in, peaks));
    }
    for (size_t item = 0; item < sheet->items; item++) {
        made->paths += (uint64_t)ORL_GONIO_BATCHES *
                       ((uint64_t)sheet->paths[item] + sheet->paths_before[item]);
        lost += sheet->lost[item];
    }
    made->lost = lost / (double)made->paths;
}

int orl_gonio_tell(const struct orl_gonio_sheet *sheet, struct orl_bsdf_made *made,
                   struct orl_error *err)
{
    made->n_directions = (size_t)sheet->basis.n_cells;
    made->directions = calloc(made->n_directions, sizeof *made->directions);
    if (!made->directions || set_errors(sheet, made) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
    for (int in = 0; in < sheet->basis.n_cells; in++)
        made->directions[in] = direction_of(sheet, in);
    set_totals(sheet, made);
    return 0;
}

#include "bsdf/make/klems/klems_summary.h"

#include <stdlib.h>

static const double counted_from = 0.01; /* share of the peak above which errors count */

void orl_gonio_peaks(const struct orl_gonio_histogram *histogram, bool front, double ret_peaks[2])
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    for (int t = 0; t < 2; t++) {
        ret_peaks[t] = 0;
        for (size_t in = 0; in < cells; in++)
            for (int out = 0; out < histogram->basis.n_cells; out++)
                ret_peaks[t] = fmax(
                    ret_peaks[t],
                    orl_luma(orl_gonio_histogram_value(histogram, front * cells + in, t, out).f));
    }
}

double orl_gonio_max_error(const struct orl_gonio_histogram *histogram, size_t item,
                           const double peaks[2])
{
    double worst = 0;
    for (int t = 0; t < 2; t++)
        for (int out = 0; out < histogram->basis.n_cells && peaks[t] > 0; out++) {
            const struct orl_gonio_value v = orl_gonio_histogram_value(histogram, item, t, out);
            const double f = orl_luma(v.f);
            if (f >= counted_from * peaks[t])
                worst = fmax(worst, v.error / f);
        }
    return worst;
}

double orl_gonio_item_predicted_error(const struct orl_gonio_histogram *histogram, size_t item,
                                      const double peaks[2])
{
    double worst = 0;
    for (int t = 0; t < 2; t++)
        for (int out = 0; out < histogram->basis.n_cells && peaks[t] > 0; out++) {
            const struct orl_gonio_value v = orl_gonio_histogram_value(histogram, item, t, out);
            const double f = orl_luma(v.f), from = counted_from * peaks[t],
                         error = v.error / sqrt(2);
            if (f + 2 * error >= from)
                worst = fmax(worst, error / fmax(f, from));
        }
    return worst;
}

static struct orl_bsdf_make_direction direction_of(const struct orl_gonio_histogram *histogram,
                                                   int in)
{
    const struct orl_basis *basis = &histogram->basis;
    const struct orl_theta_ring *ring = orl_basis_ring(basis, in);
    const double inner = acos(sqrt(ring->cos2_low)), outer = acos(sqrt(ring->cos2_high));
    const double turn = (double)(in - ring->first) / ring->cells;
    /* Cells hold the direction of travel; the result has the direction that light comes from. */
    const double phi = turn < 0.5 ? turn + 0.5 : turn - 0.5;
    struct orl_bsdf_make_direction d = {
        .theta_deg = ring->cells == 1 ? 0 : 0.5 * (inner + outer) / ORL_DEG_TO_RAD,
        .phi_deg = ring->cells == 1 ? 0 : 360 * phi};
    for (int front = 0; front < 2; front++)
        for (int t = 0; t < 2; t++)
            d.shares[front][t] = orl_gonio_histogram_share(
                histogram, (size_t)front * (size_t)basis->n_cells + (size_t)in, t);
    return d;
}

static int set_errors(const struct orl_gonio_histogram *histogram,
                      struct orl_bsdf_make_result *result)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    for (size_t part = 0; part < 4; part++) {
        const size_t front = part / 2;
        const bool transmitted = part % 2;
        float *errors = malloc(cells * cells * sizeof *errors);
        result->errors[front][transmitted] = errors;
        if (!errors)
            return ORL_ERR_NOMEM;
        for (size_t i = 0; i < cells * cells; i++)
            errors[i] = (float)orl_gonio_histogram_value(histogram, front * cells + i / cells,
                                                         transmitted, (int)(i % cells))
                            .error;
    }
    return 0;
}

static void set_totals(const struct orl_gonio_histogram *histogram,
                       struct orl_bsdf_make_result *result)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    double lost = 0;
    for (int front = 0; front < 2; front++) {
        double peaks[2];
        orl_gonio_peaks(histogram, front, peaks);
        for (int t = 0; t < 2; t++)
            result->diffuse[front][t] = orl_gonio_histogram_diffuse(histogram, front, t);
        for (size_t in = 0; in < cells; in++)
            result->worst = fmax(result->worst,
                                 orl_gonio_max_error(histogram, (size_t)front * cells + in, peaks));
    }
    for (size_t item = 0; item < histogram->items; item++) {
        result->paths += (uint64_t)ORL_GONIO_BATCHES *
                         ((uint64_t)histogram->paths[item] + histogram->pilot_paths[item]);
        lost += histogram->lost[item];
    }
    result->lost = lost / (double)result->paths;
}

int orl_gonio_summarize(const struct orl_gonio_histogram *histogram,
                        struct orl_bsdf_make_result *result, struct orl_error *err)
{
    result->n_directions = (size_t)histogram->basis.n_cells;
    result->directions = calloc(result->n_directions, sizeof *result->directions);
    if (!result->directions || set_errors(histogram, result) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
    for (int in = 0; in < histogram->basis.n_cells; in++)
        result->directions[in] = direction_of(histogram, in);
    set_totals(histogram, result);
    return 0;
}

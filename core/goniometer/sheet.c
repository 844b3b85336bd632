#include "goniometer/sheet.h"

#include <stdlib.h>
#include <string.h>

int orl_gonio_sheet_init(struct orl_gonio_sheet *sheet, const char *basis, bool color,
                         enum orl_bsdf_symmetry symmetry, struct orl_error *err)
{
    memset(sheet, 0, sizeof *sheet);
    if (orl_basis_standard(basis, &sheet->basis) < 0)
        return orl_error_set(err, ORL_ERR_INTERNAL, "there is no basis %s", basis);
    const size_t cells = (size_t)sheet->basis.n_cells;
    sheet->symmetry = symmetry;
    sheet->items = 2 * cells;
    sheet->channels = color ? 3 : 1;
    sheet->sums =
        calloc(sheet->items * ORL_GONIO_BATCHES * 2 * cells * sheet->channels, sizeof *sheet->sums);
    sheet->lost = calloc(sheet->items, sizeof *sheet->lost);
    sheet->paths = calloc(sheet->items, sizeof *sheet->paths);
    if (sheet->sums && sheet->lost && sheet->paths)
        return 0;
    orl_gonio_sheet_done(sheet);
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
}

void orl_gonio_sheet_done(struct orl_gonio_sheet *sheet)
{
    free(sheet->sums);
    free(sheet->lost);
    free(sheet->paths);
    memset(sheet, 0, sizeof *sheet);
}

double *orl_gonio_sheet_sums(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                             bool transmitted)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    return sheet->sums +
           ((item * ORL_GONIO_BATCHES + batch) * 2 + transmitted) * cells * sheet->channels;
}

/* ---- Counting -------------------------------------------------------------------------------- */

struct beam {
    struct orl_gonio_sheet *sheet;
    const struct orl_gonio_lamp *lamp;
    size_t item, batch;
    bool front; /* it comes from there */
    int in;
};

static void count(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct beam *b = ctx;
    struct orl_gonio_sheet *sheet = b->sheet;
    const int cell = orl_basis_cell(&sheet->basis, orl_polar_of(exit->direction), 0);
    if (exit->end == ORL_GONIO_GIVEN_UP || cell < 0 || !orl_rgb_is_finite(exit->weight)) {
        sheet->lost[b->item] += orl_rgb_is_finite(exit->weight) ? orl_luma(exit->weight) : 1;
        return;
    }
    double *sum = orl_gonio_sheet_sums(sheet, b->item, b->batch, exit->front != b->front) +
                  (size_t)cell * sheet->channels;
    if (sheet->channels == 1) {
        sum[0] += orl_luma(exit->weight);
        return;
    }
    sum[0] += exit->weight.r;
    sum[1] += exit->weight.g;
    sum[2] += exit->weight.b;
}

/* Over the directions of the cell and the places of the panel, evenly. */
static void send(struct beam *b, uint32_t index)
{
    const struct orl_gonio_lamp *lamp = b->lamp;
    const uint64_t stream = b->item * ORL_GONIO_BATCHES + b->batch;
    struct orl_gonio_numbers numbers = {
        .sobol = lamp->sobol,
        .index = index,
        .seed = (uint32_t)orl_mix64(lamp->seed ^ orl_mix64(stream + 1)),
        .random =
            orl_random_stream(lamp->seed, ORL_PURPOSE_GONIOMETER, stream << 32 | (uint64_t)index)};
    double u[4];
    orl_sobol_point(lamp->sobol, index, numbers.seed, 4, u);
    struct orl_vec3 towards = orl_basis_direction(&b->sheet->basis, b->in, u[0], u[1]);
    if (b->front)
        towards.z = -towards.z;
    const struct orl_path path =
        orl_path_from(orl_gonio_cell_place(&lamp->sample->cell, b->front, u + 2), towards);
    orl_gonio_follow(lamp->sample, path, &numbers, count, b);
}

void orl_gonio_sheet_measure(struct orl_gonio_sheet *sheet, const struct orl_gonio_lamp *lamp,
                             size_t item, uint32_t paths)
{
    enum { AT_ONCE = 1024 };
    const size_t cells = (size_t)sheet->basis.n_cells;
    struct beam beam = {sheet, lamp, item, 0, item >= cells, (int)(item % cells)};
    for (; beam.batch < ORL_GONIO_BATCHES; beam.batch++)
        for (uint32_t i = sheet->paths[item]; i < paths; i++) {
            if (i % AT_ONCE == 0 && orl_is_cancelled(lamp->cancel))
                return;
            send(&beam, i);
        }
    sheet->paths[item] = paths;
}

/* ---- Telling --------------------------------------------------------------------------------- */

int orl_gonio_mirrored(const struct orl_basis *basis, int cell, enum orl_bsdf_symmetry mirrors)
{
    const struct orl_theta_ring *ring = orl_basis_ring(basis, cell);
    int at = cell - ring->first;
    if (ring->cells == 1)
        return cell;
    if (mirrors & ORL_BSDF_LEFT_RIGHT) /* azimuth becomes half a turn less itself */
        at = (ring->cells / 2 - at + ring->cells) % ring->cells;
    if (mirrors & ORL_BSDF_UP_DOWN)
        at = (ring->cells - at) % ring->cells;
    return ring->first + at;
}

/* Of one batch: the share of the light that goes from in to out, in its mean over all mirrors. */
static void batch_share(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                        bool transmitted, int out, double ret_share[3])
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    unsigned count = 0;
    memset(ret_share, 0, 3 * sizeof *ret_share);
    for (unsigned mirrors = 0; mirrors <= ORL_BSDF_QUADRILATERAL; mirrors++) {
        if ((mirrors & sheet->symmetry) != mirrors)
            continue;
        const enum orl_bsdf_symmetry m = (enum orl_bsdf_symmetry)mirrors;
        const int in = orl_gonio_mirrored(&sheet->basis, (int)(item % cells), m);
        const size_t other = item - item % cells + (size_t)in;
        const double *sum = orl_gonio_sheet_sums(sheet, other, batch, transmitted) +
                            (size_t)orl_gonio_mirrored(&sheet->basis, out, m) * sheet->channels;
        for (size_t c = 0; c < sheet->channels; c++)
            ret_share[c] += sum[c] / sheet->paths[other];
        count++;
    }
    for (size_t c = 0; c < sheet->channels; c++)
        ret_share[c] /= count;
    if (sheet->channels == 1)
        ret_share[1] = ret_share[2] = ret_share[0];
}

struct orl_gonio_value orl_gonio_sheet_value(const struct orl_gonio_sheet *sheet, size_t item,
                                             bool transmitted, int out)
{
    const double omega = orl_basis_ring(&sheet->basis, out)->omega_sr;
    double lumas[ORL_GONIO_BATCHES];
    struct orl_rgb sum = orl_gray(0);
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        double s[3];
        batch_share(sheet, item, k, transmitted, out, s);
        const struct orl_rgb share = {s[0], s[1], s[2]};
        lumas[k] = orl_luma(share);
        sum = orl_rgb_add(sum, share);
    }
    return (struct orl_gonio_value){orl_rgb_scale(sum, 1 / (ORL_GONIO_BATCHES * omega)),
                                    orl_gonio_share_of(lumas).error / omega};
}

static double batch_total(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                          bool transmitted)
{
    double sum = 0;
    for (int out = 0; out < sheet->basis.n_cells; out++) {
        double s[3];
        batch_share(sheet, item, batch, transmitted, out, s);
        sum += orl_luma((struct orl_rgb){s[0], s[1], s[2]});
    }
    return sum;
}

struct orl_bsdf_share orl_gonio_sheet_share(const struct orl_gonio_sheet *sheet, size_t item,
                                            bool transmitted)
{
    double totals[ORL_GONIO_BATCHES];
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        totals[k] = batch_total(sheet, item, k, transmitted);
    return orl_gonio_share_of(totals);
}

struct orl_bsdf_share orl_gonio_sheet_diffuse(const struct orl_gonio_sheet *sheet, bool front,
                                              bool transmitted)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    double totals[ORL_GONIO_BATCHES] = {0};
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        for (size_t in = 0; in < cells; in++)
            totals[k] += batch_total(sheet, front * cells + in, k, transmitted) *
                         orl_basis_ring(&sheet->basis, (int)in)->omega_sr / ORL_PI;
    return orl_gonio_share_of(totals);
}

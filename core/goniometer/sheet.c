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
    sheet->before = calloc(sheet->items * 2 * cells * sheet->channels, sizeof *sheet->before);
    sheet->totals_before =
        calloc(sheet->items * ORL_GONIO_BATCHES * 2, sizeof *sheet->totals_before);
    sheet->heaviest = calloc(sheet->items * 2 * cells, sizeof *sheet->heaviest);
    sheet->lost = calloc(sheet->items, sizeof *sheet->lost);
    sheet->paths = calloc(sheet->items, sizeof *sheet->paths);
    sheet->paths_before = calloc(sheet->items, sizeof *sheet->paths_before);
    if (sheet->sums && sheet->before && sheet->totals_before && sheet->heaviest && sheet->lost &&
        sheet->paths && sheet->paths_before)
        return 0;
    orl_gonio_sheet_done(sheet);
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
}

void orl_gonio_sheet_done(struct orl_gonio_sheet *sheet)
{
    free(sheet->sums);
    free(sheet->before);
    free(sheet->totals_before);
    free(sheet->heaviest);
    free(sheet->lost);
    free(sheet->paths);
    free(sheet->paths_before);
    memset(sheet, 0, sizeof *sheet);
}

double *orl_gonio_sheet_sums(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                             bool transmitted)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    return sheet->sums +
           ((item * ORL_GONIO_BATCHES + batch) * 2 + transmitted) * cells * sheet->channels;
}

static double *before_of(const struct orl_gonio_sheet *sheet, size_t item, bool transmitted)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    return sheet->before + (item * 2 + transmitted) * cells * sheet->channels;
}

static float *heaviest_of(const struct orl_gonio_sheet *sheet, size_t item, bool transmitted)
{
    return sheet->heaviest + (item * 2 + transmitted) * (size_t)sheet->basis.n_cells;
}

/* Returns the luma of one batch of an item, summed over all cells of a side. */
static double sum_all(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                      bool transmitted)
{
    const double *sums = orl_gonio_sheet_sums(sheet, item, batch, transmitted);
    double sum = 0;
    for (size_t i = 0; i < (size_t)sheet->basis.n_cells; i++, sums += sheet->channels)
        sum +=
            sheet->channels == 1 ? sums[0] : orl_luma((struct orl_rgb){sums[0], sums[1], sums[2]});
    return sum;
}

void orl_gonio_sheet_put_aside(struct orl_gonio_sheet *sheet, size_t item)
{
    const size_t values = (size_t)sheet->basis.n_cells * sheet->channels;
    for (size_t part = 0; part < 2; part++) {
        double *before = before_of(sheet, item, part);
        for (size_t batch = 0; batch < ORL_GONIO_BATCHES; batch++) {
            double *sums = orl_gonio_sheet_sums(sheet, item, batch, part);
            sheet->totals_before[(item * ORL_GONIO_BATCHES + batch) * 2 + part] +=
                sum_all(sheet, item, batch, part);
            for (size_t i = 0; i < values; i++)
                before[i] += sums[i];
            memset(sums, 0, values * sizeof *sums);
        }
    }
    sheet->paths_before[item] += sheet->paths[item];
    sheet->paths[item] = 0;
}

/* ---- Counting -------------------------------------------------------------------------------- */

struct beam {
    struct orl_gonio_sheet *sheet;
    const struct orl_gonio_lamp *lamp;
    size_t item, batch;
    bool front; /* true if light comes from the front */
    int in;
};

static void count_exit(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct beam *b = ctx;
    struct orl_gonio_sheet *sheet = b->sheet;
    const int cell = orl_basis_cell(&sheet->basis, orl_polar_of(exit->direction), 0);
    if (exit->end == ORL_GONIO_GIVEN_UP || cell < 0 || !orl_rgb_is_finite(exit->weight)) {
        sheet->lost[b->item] += orl_rgb_is_finite(exit->weight) ? orl_luma(exit->weight) : 1;
        return;
    }
    const bool transmitted = exit->front != b->front;
    double *sum = orl_gonio_sheet_sums(sheet, b->item, b->batch, transmitted) +
                  (size_t)cell * sheet->channels;
    float *heaviest = heaviest_of(sheet, b->item, transmitted) + cell;
    *heaviest = fmaxf(*heaviest, (float)orl_luma(exit->weight));
    if (sheet->channels == 1) {
        sum[0] += orl_luma(exit->weight);
        return;
    }
    sum[0] += exit->weight.r;
    sum[1] += exit->weight.g;
    sum[2] += exit->weight.b;
}

/* Sends one path; directions in the cell and places on the panel are evenly distributed. */
static void send_path(struct beam *b, uint32_t index)
{
    const struct orl_gonio_lamp *lamp = b->lamp;
    const uint64_t set = b->sheet->paths_before[b->item] > 0 ? b->sheet->items : 0;
    const uint64_t stream = (set + b->item) * ORL_GONIO_BATCHES + b->batch;
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
    orl_gonio_follow(lamp->sample, path, &numbers, count_exit, b);
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
            send_path(&beam, i);
        }
    sheet->paths[item] = paths;
}

/* ---- Results -------------------------------------------------------------------------------- */

int orl_gonio_mirrored(const struct orl_basis *basis, int cell, enum orl_bsdf_symmetry mirrors)
{
    const struct orl_theta_ring *ring = orl_basis_ring(basis, cell);
    int at = cell - ring->first;
    if (ring->cells == 1)
        return cell;
    if (mirrors & ORL_BSDF_LEFT_RIGHT) /* the azimuth becomes half a turn minus itself */
        at = (ring->cells / 2 - at + ring->cells) % ring->cells;
    if (mirrors & ORL_BSDF_UP_DOWN)
        at = (ring->cells - at) % ring->cells;
    return ring->first + at;
}

/* Mirror images of an item's cell out: their number, and where they are counted. */
struct images {
    unsigned count;
    size_t item[ORL_BSDF_QUADRILATERAL + 1], out[ORL_BSDF_QUADRILATERAL + 1];
};

static struct images images_of(const struct orl_gonio_sheet *sheet, size_t item, int out)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    struct images images = {.count = 0};
    for (unsigned mirrors = 0; mirrors <= ORL_BSDF_QUADRILATERAL; mirrors++) {
        if ((mirrors & sheet->symmetry) != mirrors)
            continue;
        const enum orl_bsdf_symmetry m = (enum orl_bsdf_symmetry)mirrors;
        const int in = orl_gonio_mirrored(&sheet->basis, (int)(item % cells), m);
        images.item[images.count] = item - item % cells + (size_t)in;
        images.out[images.count++] = (size_t)orl_gonio_mirrored(&sheet->basis, out, m);
    }
    return images;
}

/* Returns the share of light that goes from in to out, averaged over all mirrors: in one batch, or
 * with batch = ORL_GONIO_BATCHES in all that were put aside. */
static struct orl_rgb share_of(const struct orl_gonio_sheet *sheet, const struct images *images,
                               size_t batch, bool transmitted)
{
    double share[3] = {0};
    for (unsigned m = 0; m < images->count; m++) {
        const size_t item = images->item[m];
        const bool aside = batch == ORL_GONIO_BATCHES;
        const double paths =
            aside ? (double)ORL_GONIO_BATCHES * sheet->paths_before[item] : sheet->paths[item];
        const double *sum = (aside ? before_of(sheet, item, transmitted)
                                   : orl_gonio_sheet_sums(sheet, item, batch, transmitted)) +
                            images->out[m] * sheet->channels;
        for (size_t c = 0; c < sheet->channels && paths > 0; c++)
            share[c] += sum[c] / paths / images->count;
    }
    return sheet->channels == 1 ? orl_gray(share[0])
                                : (struct orl_rgb){share[0], share[1], share[2]};
}

/* Returns the share of an item's paths in the present batches, which give its error. */
static double told_part(const struct orl_gonio_sheet *sheet, size_t item)
{
    return sheet->paths[item] / ((double)sheet->paths[item] + sheet->paths_before[item]);
}

/* Returns the weight of one path as a share of the light of all paths. */
static double path_share(const struct orl_gonio_sheet *sheet, const struct images *images,
                         bool transmitted)
{
    const double paths =
        (double)sheet->paths[images->item[0]] + sheet->paths_before[images->item[0]];
    double heaviest = 0;
    for (unsigned m = 0; m < images->count; m++)
        heaviest = fmax(heaviest,
                        (double)heaviest_of(sheet, images->item[m], transmitted)[images->out[m]]);
    return sheet->exact
               ? 0
               : (heaviest > 0 ? heaviest : 1) / (ORL_GONIO_BATCHES * paths * images->count);
}

struct orl_gonio_value orl_gonio_sheet_value(const struct orl_gonio_sheet *sheet, size_t item,
                                             bool transmitted, int out)
{
    const double omega = orl_basis_ring(&sheet->basis, out)->omega_sr;
    const double told = told_part(sheet, item);
    const struct images images = images_of(sheet, item, out);
    double lumas[ORL_GONIO_BATCHES];
    struct orl_rgb sum = orl_gray(0);
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        const struct orl_rgb share = share_of(sheet, &images, k, transmitted);
        lumas[k] = orl_luma(share);
        sum = orl_rgb_add(sum, share);
    }
    const struct orl_rgb before = share_of(sheet, &images, ORL_GONIO_BATCHES, transmitted);
    const struct orl_rgb share =
        orl_rgb_add(orl_rgb_scale(sum, told / ORL_GONIO_BATCHES), orl_rgb_scale(before, 1 - told));
    const double error = sqrt(told) * orl_gonio_share_of(lumas).error;
    return (struct orl_gonio_value){orl_rgb_scale(share, 1 / omega),
                                    hypot(error, path_share(sheet, &images, transmitted)) / omega};
}

/* Returns the share of one batch, including counts put aside, averaged over all mirrors. */
static double batch_total(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                          bool transmitted)
{
    const struct images images = images_of(sheet, item, 0);
    double sum = 0;
    for (unsigned m = 0; m < images.count; m++) {
        const size_t i = images.item[m];
        sum += (sum_all(sheet, i, batch, transmitted) +
                sheet->totals_before[(i * ORL_GONIO_BATCHES + batch) * 2 + transmitted]) /
               ((double)sheet->paths[i] + sheet->paths_before[i]);
    }
    return sum / images.count;
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

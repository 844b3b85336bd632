/* Light that left the panel, counted by cells of an angle basis. */
#include "bsdf/make/klems/exit_histogram.h"

#include <stdlib.h>
#include <string.h>

int orl_gonio_histogram_init(struct orl_gonio_histogram *histogram, const char *basis, bool color,
                             enum orl_bsdf_symmetry symmetry, struct orl_error *err)
{
    memset(histogram, 0, sizeof *histogram);
    if (orl_basis_standard(basis, &histogram->basis) < 0)
        return orl_error_set(err, ORL_ERR_INTERNAL, "the basis %s is unknown", basis);
    const size_t cells = (size_t)histogram->basis.n_cells;
    histogram->symmetry = symmetry;
    histogram->items = 2 * cells;
    histogram->channels = color ? 3 : 1;
    histogram->sums = calloc(histogram->items * ORL_GONIO_BATCHES * 2 * cells * histogram->channels,
                             sizeof *histogram->sums);
    histogram->pilot =
        calloc(histogram->items * 2 * cells * histogram->channels, sizeof *histogram->pilot);
    histogram->pilot_totals =
        calloc(histogram->items * ORL_GONIO_BATCHES * 2, sizeof *histogram->pilot_totals);
    histogram->max_weight = calloc(histogram->items * 2 * cells, sizeof *histogram->max_weight);
    histogram->lost = calloc(histogram->items, sizeof *histogram->lost);
    histogram->paths = calloc(histogram->items, sizeof *histogram->paths);
    histogram->pilot_paths = calloc(histogram->items, sizeof *histogram->pilot_paths);
    if (histogram->sums && histogram->pilot && histogram->pilot_totals && histogram->max_weight &&
        histogram->lost && histogram->paths && histogram->pilot_paths)
        return 0;
    orl_gonio_histogram_done(histogram);
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
}

void orl_gonio_histogram_done(struct orl_gonio_histogram *histogram)
{
    free(histogram->sums);
    free(histogram->pilot);
    free(histogram->pilot_totals);
    free(histogram->max_weight);
    free(histogram->lost);
    free(histogram->paths);
    free(histogram->pilot_paths);
    memset(histogram, 0, sizeof *histogram);
}

double *orl_gonio_histogram_sums(const struct orl_gonio_histogram *histogram, size_t item,
                                 size_t batch, bool transmitted)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    return histogram->sums +
           ((item * ORL_GONIO_BATCHES + batch) * 2 + transmitted) * cells * histogram->channels;
}

static double *pilot_of(const struct orl_gonio_histogram *histogram, size_t item, bool transmitted)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    return histogram->pilot + (item * 2 + transmitted) * cells * histogram->channels;
}

static float *max_weight_of(const struct orl_gonio_histogram *histogram, size_t item,
                            bool transmitted)
{
    return histogram->max_weight + (item * 2 + transmitted) * (size_t)histogram->basis.n_cells;
}

/* Returns the luma of one batch of an item, summed over all cells of a side. */
static double sum_all(const struct orl_gonio_histogram *histogram, size_t item, size_t batch,
                      bool transmitted)
{
    const double *sums = orl_gonio_histogram_sums(histogram, item, batch, transmitted);
    double sum = 0;
    for (size_t i = 0; i < (size_t)histogram->basis.n_cells; i++, sums += histogram->channels)
        sum += histogram->channels == 1 ? sums[0]
                                        : orl_luma((struct orl_rgb){sums[0], sums[1], sums[2]});
    return sum;
}

void orl_gonio_histogram_end_pilot(struct orl_gonio_histogram *histogram, size_t item)
{
    const size_t values = (size_t)histogram->basis.n_cells * histogram->channels;
    for (size_t part = 0; part < 2; part++) {
        double *pilot = pilot_of(histogram, item, part);
        for (size_t batch = 0; batch < ORL_GONIO_BATCHES; batch++) {
            double *sums = orl_gonio_histogram_sums(histogram, item, batch, part);
            histogram->pilot_totals[(item * ORL_GONIO_BATCHES + batch) * 2 + part] +=
                sum_all(histogram, item, batch, part);
            for (size_t i = 0; i < values; i++)
                pilot[i] += sums[i];
            memset(sums, 0, values * sizeof *sums);
        }
    }
    histogram->pilot_paths[item] += histogram->paths[item];
    histogram->paths[item] = 0;
}

/* ---- Counting -------------------------------------------------------------------------------- */

struct item_path {
    struct orl_gonio_histogram *histogram;
    const struct orl_gonio_measurement *measurement;
    size_t item, batch;
    bool front; /* true if light comes from the front */
    int in;
};

static void count_exit(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct item_path *b = ctx;
    struct orl_gonio_histogram *histogram = b->histogram;
    const int cell = orl_basis_cell(&histogram->basis, orl_polar_of(exit->direction), 0);
    if (exit->end == ORL_GONIO_PATH_CUT || cell < 0 || !orl_rgb_is_finite(exit->weight)) {
        histogram->lost[b->item] += orl_rgb_is_finite(exit->weight) ? orl_luma(exit->weight) : 1;
        return;
    }
    const bool transmitted = exit->front != b->front;
    double *sum = orl_gonio_histogram_sums(histogram, b->item, b->batch, transmitted) +
                  (size_t)cell * histogram->channels;
    float *max_weight = max_weight_of(histogram, b->item, transmitted) + cell;
    *max_weight = fmaxf(*max_weight, (float)orl_luma(exit->weight));
    if (histogram->channels == 1) {
        sum[0] += orl_luma(exit->weight);
        return;
    }
    sum[0] += exit->weight.r;
    sum[1] += exit->weight.g;
    sum[2] += exit->weight.b;
}

/* Sends one path; directions in the cell and places on the panel are evenly distributed. */
static void send_path(struct item_path *b, uint32_t index)
{
    const uint64_t set = b->histogram->pilot_paths[b->item] > 0 ? b->histogram->items : 0;
    const uint64_t stream = (set + b->item) * ORL_GONIO_BATCHES + b->batch;
    double u[4];
    struct orl_gonio_sampler sampler = orl_gonio_sampler_at(b->measurement, stream, index, u);
    orl_gonio_trace(b->measurement->sample, b->front,
                    orl_basis_direction(&b->histogram->basis, b->in, u[0], u[1]), u + 2, &sampler,
                    count_exit, b);
}

void orl_gonio_histogram_measure(struct orl_gonio_histogram *histogram,
                                 const struct orl_gonio_measurement *measurement, size_t item,
                                 uint32_t paths)
{
    enum { CHUNK = 1024 };
    const size_t cells = (size_t)histogram->basis.n_cells;
    struct item_path item_path = {histogram, measurement,   item,
                                  0,         item >= cells, (int)(item % cells)};
    for (; item_path.batch < ORL_GONIO_BATCHES; item_path.batch++)
        for (uint32_t i = histogram->paths[item]; i < paths; i++) {
            if (i % CHUNK == 0 && orl_is_cancelled(measurement->env->cancel))
                return;
            send_path(&item_path, i);
        }
    histogram->paths[item] = paths;
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

static struct images images_of(const struct orl_gonio_histogram *histogram, size_t item, int out)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    struct images images = {.count = 0};
    for (unsigned mirrors = 0; mirrors <= ORL_BSDF_QUADRILATERAL; mirrors++) {
        if ((mirrors & histogram->symmetry) != mirrors)
            continue;
        const enum orl_bsdf_symmetry m = (enum orl_bsdf_symmetry)mirrors;
        const int in = orl_gonio_mirrored(&histogram->basis, (int)(item % cells), m);
        images.item[images.count] = item - item % cells + (size_t)in;
        images.out[images.count++] = (size_t)orl_gonio_mirrored(&histogram->basis, out, m);
    }
    return images;
}

/* Returns the share of light that goes from in to out, averaged over all mirrors: in one batch, or
 * with batch = ORL_GONIO_BATCHES in the pilot. */
static struct orl_rgb share_of(const struct orl_gonio_histogram *histogram,
                               const struct images *images, size_t batch, bool transmitted)
{
    double share[3] = {0};
    for (unsigned m = 0; m < images->count; m++) {
        const size_t item = images->item[m];
        const bool aside = batch == ORL_GONIO_BATCHES;
        const double paths = aside ? (double)ORL_GONIO_BATCHES * histogram->pilot_paths[item]
                                   : histogram->paths[item];
        const double *sum =
            (aside ? pilot_of(histogram, item, transmitted)
                   : orl_gonio_histogram_sums(histogram, item, batch, transmitted)) +
            images->out[m] * histogram->channels;
        for (size_t c = 0; c < histogram->channels && paths > 0; c++)
            share[c] += sum[c] / paths / images->count;
    }
    return histogram->channels == 1 ? orl_gray(share[0])
                                    : (struct orl_rgb){share[0], share[1], share[2]};
}

/* Returns the share of an item's paths in the present batches, which give its error. */
static double final_share_of(const struct orl_gonio_histogram *histogram, size_t item)
{
    return histogram->paths[item] / ((double)histogram->paths[item] + histogram->pilot_paths[item]);
}

/* Returns the weight of one path as a share of the light of all paths. */
static double path_share(const struct orl_gonio_histogram *histogram, const struct images *images,
                         bool transmitted)
{
    const double paths =
        (double)histogram->paths[images->item[0]] + histogram->pilot_paths[images->item[0]];
    double max_weight = 0;
    for (unsigned m = 0; m < images->count; m++)
        max_weight = fmax(max_weight, (double)max_weight_of(histogram, images->item[m],
                                                            transmitted)[images->out[m]]);
    return histogram->exact
               ? 0
               : (max_weight > 0 ? max_weight : 1) / (ORL_GONIO_BATCHES * paths * images->count);
}

struct orl_gonio_value orl_gonio_histogram_value(const struct orl_gonio_histogram *histogram,
                                                 size_t item, bool transmitted, int out)
{
    const double omega = orl_basis_ring(&histogram->basis, out)->omega_sr;
    const double final_share = final_share_of(histogram, item);
    const struct images images = images_of(histogram, item, out);
    double lumas[ORL_GONIO_BATCHES];
    struct orl_rgb sum = orl_gray(0);
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        const struct orl_rgb share = share_of(histogram, &images, k, transmitted);
        lumas[k] = orl_luma(share);
        sum = orl_rgb_add(sum, share);
    }
    const struct orl_rgb pilot = share_of(histogram, &images, ORL_GONIO_BATCHES, transmitted);
    const struct orl_rgb share = orl_rgb_add(orl_rgb_scale(sum, final_share / ORL_GONIO_BATCHES),
                                             orl_rgb_scale(pilot, 1 - final_share));
    const double error = sqrt(final_share) * orl_gonio_batch_mean(lumas).error;
    return (struct orl_gonio_value){orl_rgb_scale(share, 1 / omega),
                                    hypot(error, path_share(histogram, &images, transmitted)) /
                                        omega};
}

/* Returns the share of one batch, including the pilot's counts, averaged over all mirrors. */
static double batch_total(const struct orl_gonio_histogram *histogram, size_t item, size_t batch,
                          bool transmitted)
{
    const struct images images = images_of(histogram, item, 0);
    double sum = 0;
    for (unsigned m = 0; m < images.count; m++) {
        const size_t i = images.item[m];
        sum += (sum_all(histogram, i, batch, transmitted) +
                histogram->pilot_totals[(i * ORL_GONIO_BATCHES + batch) * 2 + transmitted]) /
               ((double)histogram->paths[i] + histogram->pilot_paths[i]);
    }
    return sum / images.count;
}

struct orl_bsdf_share orl_gonio_histogram_share(const struct orl_gonio_histogram *histogram,
                                                size_t item, bool transmitted)
{
    double totals[ORL_GONIO_BATCHES];
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        totals[k] = batch_total(histogram, item, k, transmitted);
    return orl_gonio_batch_mean(totals);
}

struct orl_bsdf_share orl_gonio_histogram_diffuse(const struct orl_gonio_histogram *histogram,
                                                  bool front, bool transmitted)
{
    const size_t cells = (size_t)histogram->basis.n_cells;
    double totals[ORL_GONIO_BATCHES] = {0};
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        for (size_t in = 0; in < cells; in++)
            totals[k] += batch_total(histogram, front * cells + in, k, transmitted) *
                         orl_basis_ring(&histogram->basis, (int)in)->omega_sr / ORL_PI;
    return orl_gonio_batch_mean(totals);
}

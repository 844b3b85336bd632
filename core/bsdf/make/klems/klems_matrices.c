/* Measures matrices in a Klems basis: rounds of paths until the accuracy is reached, and the
 * figures of the result. */
#include "bsdf/make/make_bsdf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/make/klems/exit_histogram.h"

static const double counted_from = 0.01; /* share of the peak above which errors count */

/* ---- Figures of the result ------------------------------------------------------------------- */

/* Returns the largest values of light from that side, 1/sr: reflected, transmitted. */
static void find_peaks(const struct orl_gonio_histogram *histogram, bool front, double ret_peaks[2])
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

/* Returns the largest relative error of an item, over values of at least a hundredth of the peaks.
 * peaks: reflected, transmitted. predicted: the error is that of twice as many paths, and values
 * count that may be large enough within two of their errors. */
static double max_error_of(const struct orl_gonio_histogram *histogram, size_t item,
                           const double peaks[2], bool predicted)
{
    double worst = 0;
    for (int t = 0; t < 2; t++)
        for (int out = 0; out < histogram->basis.n_cells && peaks[t] > 0; out++) {
            const struct orl_gonio_value v = orl_gonio_histogram_value(histogram, item, t, out);
            const double f = orl_luma(v.f), from = counted_from * peaks[t];
            const double error = predicted ? v.error / sqrt(2) : v.error;
            if (f + (predicted ? 2 * error : 0) >= from)
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
        find_peaks(histogram, front, peaks);
        for (int t = 0; t < 2; t++)
            result->diffuse[front][t] = orl_gonio_histogram_diffuse(histogram, front, t);
        for (size_t in = 0; in < cells; in++)
            result->worst = fmax(result->worst,
                                 max_error_of(histogram, (size_t)front * cells + in, peaks, false));
    }
    for (size_t item = 0; item < histogram->items; item++) {
        result->paths += (uint64_t)ORL_GONIO_BATCHES *
                         ((uint64_t)histogram->paths[item] + histogram->pilot_paths[item]);
        lost += histogram->lost[item];
    }
    result->lost = lost / (double)result->paths;
}

/* Fills *result except the XML and the cell's extents. Returns 0 or ORL_ERR_NOMEM. */
static int summarize_histogram(const struct orl_gonio_histogram *histogram,
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

/* ---- Rounds of paths ------------------------------------------------------------------------- */

enum { CHUNK = 16 }; /* items between two progress reports */

struct round {
    const struct orl_gonio_measurement *measurement;
    const struct orl_bsdf_make_request *request; /* of the measurement, like env and sample */
    const struct orl_bsdf_make_env *env;
    const struct orl_gonio_sample *sample;
    struct orl_gonio_histogram *histogram;
    uint32_t *wanted; /* paths in each batch, by item; 0: no more are needed */
    uint32_t number;
    size_t first;
    bool not_converged;   /* true if a predicted error is above the accuracy at the most paths */
    size_t *todo, n_todo; /* distributed rounds: items that need more paths */
    atomic_bool out_of_memory; /* true if memory was out while a file was read */
};

static void measure_item(void *arg, size_t index, uint32_t member)
{
    struct round *r = arg;
    const size_t item = r->first + index;
    (void)member;
    if (r->sample->file) {
        if (orl_gonio_resample_item(r->histogram, r->sample->file, item) < 0)
            atomic_store(&r->out_of_memory, true);
    } else if (r->wanted[item] > r->histogram->paths[item])
        orl_gonio_histogram_measure(r->histogram, r->measurement, item, r->wanted[item]);
}

static int measure_round(struct round *r, struct orl_error *err)
{
    const size_t items = r->histogram->items;
    if (r->env->progress)
        r->env->progress(r->env->ctx, r->number, 0);
    for (r->first = 0; r->first < items; r->first += CHUNK) {
        const size_t count = items - r->first < CHUNK ? items - r->first : CHUNK;
        const int code = orl_parallel_try(r->env->pool, count, measure_item, r);
        if (code < 0 || orl_is_cancelled(r->env->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
        if (atomic_load(&r->out_of_memory))
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        if (r->env->progress)
            r->env->progress(r->env->ctx, r->number, (double)(r->first + count) / (double)items);
    }
    return 0;
}

/* ---- Distributed rounds ---------------------------------------------------------------------- */

/* Header of a serialised item. Its sums of all batches and its largest weights follow. */
struct packed_item {
    double lost;
    uint64_t paths;
};

static size_t sums_bytes(const struct round *r)
{
    return (size_t)ORL_GONIO_BATCHES * 2 * (size_t)r->histogram->basis.n_cells *
           r->histogram->channels * sizeof *r->histogram->sums;
}

static size_t max_weight_bytes(const struct round *r)
{
    return 2 * (size_t)r->histogram->basis.n_cells * sizeof *r->histogram->max_weight;
}

static float *max_weight_of(const struct round *r, size_t item)
{
    return r->histogram->max_weight + item * 2 * (size_t)r->histogram->basis.n_cells;
}

static size_t item_bytes(const struct round *r)
{
    return sizeof(struct packed_item) + sums_bytes(r) + max_weight_bytes(r);
}

static double task_core_s(void *ctx, size_t task)
{
    const struct round *r = ctx;
    double s = 0;
    for (size_t i = 0; i < orl_gonio_task_size(r->n_todo, task); i++) {
        const size_t item = r->todo[task * ORL_GONIO_TASK_ITEMS + i];
        s += ORL_GONIO_PATH_S * ORL_GONIO_BATCHES * (r->wanted[item] - r->histogram->paths[item]);
    }
    return s;
}

static void measure_todo(void *arg, size_t index, uint32_t member)
{
    struct round *r = arg;
    const size_t item = r->todo[r->first + index];
    (void)member;
    orl_gonio_histogram_measure(r->histogram, r->measurement, item, r->wanted[item]);
}

static int compute_task(void *ctx, size_t task, void **ret_data, size_t *ret_size,
                        struct orl_error *err)
{
    struct round *r = ctx;
    const size_t n = orl_gonio_task_size(r->n_todo, task), bytes = item_bytes(r);
    char *to = malloc(n * bytes);
    *ret_data = to;
    *ret_size = n * bytes;
    r->first = task * ORL_GONIO_TASK_ITEMS;
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (orl_parallel_try(r->env->pool, n, measure_todo, r) < 0 || orl_is_cancelled(r->env->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    for (size_t i = 0; i < n; i++, to += bytes) {
        const size_t item = r->todo[r->first + i];
        const struct packed_item packed = {r->histogram->lost[item], r->histogram->paths[item]};
        memcpy(to, &packed, sizeof packed);
        memcpy(to + sizeof packed, orl_gonio_histogram_sums(r->histogram, item, 0, false),
               sums_bytes(r));
        memcpy(to + sizeof packed + sums_bytes(r), max_weight_of(r, item), max_weight_bytes(r));
    }
    return 0;
}

static int read_task(void *ctx, size_t task, const void *data, size_t size, bool *ret_valid,
                     struct orl_error *err)
{
    const struct round *r = ctx;
    const size_t n = orl_gonio_task_size(r->n_todo, task), bytes = item_bytes(r);
    const char *from = data;
    (void)err;
    *ret_valid = size == n * bytes;
    for (size_t i = 0; i < n && *ret_valid; i++, from += bytes) {
        const size_t item = r->todo[task * ORL_GONIO_TASK_ITEMS + i];
        struct packed_item packed;
        memcpy(&packed, from, sizeof packed);
        r->histogram->lost[item] = packed.lost;
        r->histogram->paths[item] = (uint32_t)packed.paths;
        memcpy(orl_gonio_histogram_sums(r->histogram, item, 0, false), from + sizeof packed,
               sums_bytes(r));
        memcpy(max_weight_of(r, item), from + sizeof packed + sums_bytes(r), max_weight_bytes(r));
    }
    return 0;
}

static void report_share(void *ctx, double share)
{
    const struct round *r = ctx;
    if (r->env->progress)
        r->env->progress(r->env->ctx, r->number, share);
}

static int share_round(struct round *r, struct orl_error *err)
{
    char name[32];
    snprintf(name, sizeof name, "round %u", r->number);
    r->n_todo = 0;
    for (size_t item = 0; item < r->histogram->items; item++)
        if (r->wanted[item] > r->histogram->paths[item])
            r->todo[r->n_todo++] = item;
    const struct orl_bsdf_tasks tasks = {.name = name,
                                         .n = (r->n_todo + ORL_GONIO_TASK_ITEMS - 1) /
                                              ORL_GONIO_TASK_ITEMS,
                                         .ctx = r,
                                         .core_s = task_core_s,
                                         .make = compute_task,
                                         .take = read_task,
                                         .told = report_share};
    return r->env->shared->run(r->env->shared->ctx, &tasks, err);
}

/* ---- All rounds ----------------------------------------------------------------------------- */

/* Requests the same number of paths for all mirror images of an item. */
static void request_mirrored(struct round *r, size_t item, uint32_t paths)
{
    const size_t cells = (size_t)r->histogram->basis.n_cells;
    for (unsigned m = 0; m <= ORL_BSDF_QUADRILATERAL; m++)
        if ((m & r->request->symmetry) == m)
            r->wanted[item - item % cells +
                      (size_t)orl_gonio_mirrored(&r->histogram->basis, (int)(item % cells),
                                                 (enum orl_bsdf_symmetry)m)] = paths;
}

/* Returns true if an item needs more than twice its paths, and the limit allows more. */
static bool needs_more(const struct round *r, size_t item, const double peaks[2])
{
    const uint64_t most = r->request->paths_most / ORL_GONIO_BATCHES;
    return max_error_of(r->histogram, item, peaks, true) > r->request->accuracy &&
           4ULL * r->histogram->paths[item] <= most;
}

/* Doubles the paths of items that need more. Other items end their pilot and are measured again
 * with as many paths, for their errors. Returns true if any paths are needed. */
static bool request_more_paths(struct round *r)
{
    const size_t cells = (size_t)r->histogram->basis.n_cells;
    bool any = false;
    for (size_t item = 0; item < r->histogram->items; item++)
        r->wanted[item] = 0;
    for (size_t front = 0; front < 2; front++) {
        double peaks[2];
        find_peaks(r->histogram, front, peaks);
        for (size_t item = front * cells; item < (front + 1) * cells; item++)
            if (r->histogram->pilot_paths[item] == 0 && needs_more(r, item, peaks))
                request_mirrored(r, item, 2 * r->histogram->paths[item]);
        for (size_t item = front * cells; item < (front + 1) * cells; item++) {
            if (r->histogram->pilot_paths[item] == 0 && r->wanted[item] == 0) {
                r->not_converged = r->not_converged || max_error_of(r->histogram, item, peaks,
                                                                    true) > r->request->accuracy;
                r->wanted[item] = r->histogram->paths[item];
                orl_gonio_histogram_end_pilot(r->histogram, item);
            }
            any = any || r->wanted[item] > 0;
        }
    }
    return any;
}

static int measure_all(struct round *r, struct orl_error *err)
{
    const bool accurate = r->request->accuracy > 0;
    const uint32_t paths = orl_bsdf_make_paths(r->request);
    const uint32_t sets = accurate ? 2 * ORL_GONIO_BATCHES : ORL_GONIO_BATCHES;
    const uint32_t first = (paths + sets - 1) / sets;
    int code;
    for (size_t item = 0; item < r->histogram->items; item++)
        r->wanted[item] = first;
    r->histogram->exact = r->sample->file != NULL;
    do {
        code = r->env->shared && !r->sample->file ? share_round(r, err) : measure_round(r, err);
        r->number++;
    } while (code == 0 && accurate && request_more_paths(r));
    return code;
}

/* ---- The file -------------------------------------------------------------------------------- */

static int fill_part(const struct orl_gonio_histogram *histogram, bool front, bool transmitted,
                     bool errors, struct orl_component *part, struct orl_error *err)
{
    const struct orl_basis *basis = &histogram->basis;
    const size_t cells = (size_t)basis->n_cells;
    const bool color = histogram->channels > 1 && !errors;
    int code = orl_matrix_init(&part->matrix, basis, basis, err);
    for (int k = 0; k < ORL_CHROMA_CHANNELS && color && code == 0; k++)
        code = orl_matrix_init(&part->chroma.matrix[k], basis, basis, err);
    if (code < 0)
        return code;
    for (size_t i = 0; i < cells * cells; i++) {
        const struct orl_gonio_value v = orl_gonio_histogram_value(
            histogram, front * cells + i / cells, transmitted, (int)(i % cells));
        const struct orl_rgb f = v.f;
        double x, z;
        part->matrix.values[i] = (float)(errors ? v.error : orl_luma(f));
        if (!color)
            continue;
        orl_color_xz(f, &x, &z);
        part->chroma.matrix[0].values[i] = (float)x;
        part->chroma.matrix[1].values[i] = (float)z;
    }
    part->present = true;
    part->chroma.given[0] = part->chroma.given[1] = color;
    return 0;
}

/* Writes the BSDF, or its errors. */
static int write_out(const struct round *r, bool errors, struct orl_bsdf_make_result *result,
                     struct orl_error *err)
{
    struct orl_document document = {.structure = ORL_STRUCTURE_MATRIX};
    int code = 0;
    for (int part = 0; part < 4 && code == 0; part++)
        code = fill_part(r->histogram, part / 2, part % 2, errors,
                         &document.parts[orl_gonio_component_of[part / 2][part % 2]], err);
    if (code == 0 && orl_gonio_write(&document, NULL, NULL, r->measurement, errors, result) < 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF's text");
    orl_document_done(&document);
    return code;
}

int orl_gonio_make_klems(const struct orl_gonio_measurement *measurement,
                         struct orl_bsdf_make_result *result, struct orl_error *err)
{
    const struct orl_bsdf_make_request *request = measurement->request;
    struct orl_gonio_histogram histogram;
    int code = orl_gonio_histogram_init(&histogram, orl_gonio_klems_name(request->basis),
                                        request->color, request->symmetry, err);
    if (code < 0)
        return code;
    uint32_t *wanted = malloc(histogram.items * sizeof *wanted);
    size_t *todo = malloc(histogram.items * sizeof *todo);
    struct round round = {.measurement = measurement,
                          .request = request,
                          .env = measurement->env,
                          .sample = measurement->sample,
                          .histogram = &histogram,
                          .wanted = wanted,
                          .todo = todo,
                          .number = 1};
    code = wanted && todo ? measure_all(&round, err)
                          : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (code == 0)
        code = summarize_histogram(&histogram, result, err);
    if (code == 0) {
        result->reached = !round.not_converged;
        code = write_out(&round, false, result, err);
        if (code == 0 && request->want_errors)
            code = write_out(&round, true, result, err);
    }
    free(wanted);
    free(todo);
    orl_gonio_histogram_done(&histogram);
    return code;
}

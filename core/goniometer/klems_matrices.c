#include "goniometer/klems_matrices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "goniometer/made.h"
#include "goniometer/panel_request.h"
#include "goniometer/panel_xml.h"
#include "goniometer/reading.h"

enum { AT_ONCE = 16 }; /* items between two progress reports */

struct round {
    const struct orl_bsdf_make_request *request;
    const struct orl_bsdf_make_env *env;
    const struct orl_gonio_sample *sample;
    struct orl_gonio_sheet *sheet;
    struct orl_gonio_lamp lamp;
    uint32_t *wanted; /* paths in each batch, by item; 0: no more are needed */
    uint32_t number;
    size_t first;
    bool short_of;        /* true if a predicted error is above the accuracy at the most paths */
    size_t *todo, n_todo; /* shared rounds: items that need more paths */
    atomic_bool starved;  /* true if memory was out while a file was read */
};

static void measure_item(void *arg, size_t index, uint32_t member)
{
    struct round *r = arg;
    const size_t item = r->first + index;
    (void)member;
    if (r->lamp.sample->file) {
        if (orl_gonio_read_item(r->sheet, r->lamp.sample->file, item) < 0)
            atomic_store(&r->starved, true);
    } else if (r->wanted[item] > r->sheet->paths[item])
        orl_gonio_sheet_measure(r->sheet, &r->lamp, item, r->wanted[item]);
}

static int measure_round(struct round *r, struct orl_error *err)
{
    const size_t items = r->sheet->items;
    if (r->env->progress)
        r->env->progress(r->env->ctx, r->number, 0);
    for (r->first = 0; r->first < items; r->first += AT_ONCE) {
        const size_t count = items - r->first < AT_ONCE ? items - r->first : AT_ONCE;
        const int code = orl_crew_try(r->env->crew, count, measure_item, r);
        if (code < 0 || orl_is_cancelled(r->env->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
        if (atomic_load(&r->starved))
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        if (r->env->progress)
            r->env->progress(r->env->ctx, r->number, (double)(r->first + count) / (double)items);
    }
    return 0;
}

/* ---- Shared rounds -------------------------------------------------------------------------- */

/* Items per lot (oriel/bsdf_shared.h). */
enum { LOT = 4 };

static size_t lot_size(const struct round *r, size_t lot)
{
    const size_t left = r->n_todo - lot * LOT;
    return left < LOT ? left : LOT;
}

/* Header of a serialised item. Its sums of all batches and its heaviest paths follow. */
struct kept_item {
    double lost;
    uint64_t paths;
};

static size_t sums_bytes(const struct round *r)
{
    return (size_t)ORL_GONIO_BATCHES * 2 * (size_t)r->sheet->basis.n_cells * r->sheet->channels *
           sizeof *r->sheet->sums;
}

static size_t heaviest_bytes(const struct round *r)
{
    return 2 * (size_t)r->sheet->basis.n_cells * sizeof *r->sheet->heaviest;
}

static float *heaviest_of(const struct round *r, size_t item)
{
    return r->sheet->heaviest + item * 2 * (size_t)r->sheet->basis.n_cells;
}

static size_t item_bytes(const struct round *r)
{
    return sizeof(struct kept_item) + sums_bytes(r) + heaviest_bytes(r);
}

static double lot_core_s(void *ctx, size_t lot)
{
    const struct round *r = ctx;
    double s = 0;
    for (size_t i = 0; i < lot_size(r, lot); i++) {
        const size_t item = r->todo[lot * LOT + i];
        s += ORL_GONIO_PATH_S * ORL_GONIO_BATCHES * (r->wanted[item] - r->sheet->paths[item]);
    }
    return s;
}

static void measure_todo(void *arg, size_t index, uint32_t member)
{
    struct round *r = arg;
    const size_t item = r->todo[r->first + index];
    (void)member;
    orl_gonio_sheet_measure(r->sheet, &r->lamp, item, r->wanted[item]);
}

static int make_lot(void *ctx, size_t lot, void **ret_data, size_t *ret_size, struct orl_error *err)
{
    struct round *r = ctx;
    const size_t n = lot_size(r, lot), bytes = item_bytes(r);
    char *to = malloc(n * bytes);
    *ret_data = to;
    *ret_size = n * bytes;
    r->first = lot * LOT;
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (orl_crew_try(r->env->crew, n, measure_todo, r) < 0 || orl_is_cancelled(r->env->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    for (size_t i = 0; i < n; i++, to += bytes) {
        const size_t item = r->todo[r->first + i];
        const struct kept_item kept = {r->sheet->lost[item], r->sheet->paths[item]};
        memcpy(to, &kept, sizeof kept);
        memcpy(to + sizeof kept, orl_gonio_sheet_sums(r->sheet, item, 0, false), sums_bytes(r));
        memcpy(to + sizeof kept + sums_bytes(r), heaviest_of(r, item), heaviest_bytes(r));
    }
    return 0;
}

static int take_lot(void *ctx, size_t lot, const void *data, size_t size, bool *ret_taken,
                    struct orl_error *err)
{
    const struct round *r = ctx;
    const size_t n = lot_size(r, lot), bytes = item_bytes(r);
    const char *from = data;
    (void)err;
    *ret_taken = size == n * bytes;
    for (size_t i = 0; i < n && *ret_taken; i++, from += bytes) {
        const size_t item = r->todo[lot * LOT + i];
        struct kept_item kept;
        memcpy(&kept, from, sizeof kept);
        r->sheet->lost[item] = kept.lost;
        r->sheet->paths[item] = (uint32_t)kept.paths;
        memcpy(orl_gonio_sheet_sums(r->sheet, item, 0, false), from + sizeof kept, sums_bytes(r));
        memcpy(heaviest_of(r, item), from + sizeof kept + sums_bytes(r), heaviest_bytes(r));
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
    for (size_t item = 0; item < r->sheet->items; item++)
        if (r->wanted[item] > r->sheet->paths[item])
            r->todo[r->n_todo++] = item;
    const struct orl_bsdf_lots lots = {.name = name,
                                       .n = (r->n_todo + LOT - 1) / LOT,
                                       .ctx = r,
                                       .core_s = lot_core_s,
                                       .make = make_lot,
                                       .take = take_lot,
                                       .told = report_share};
    return r->env->shared->run(r->env->shared->ctx, &lots, err);
}

/* ---- All rounds ----------------------------------------------------------------------------- */

/* Requests the same number of paths for all mirror images of an item. */
static void want_mirrored(struct round *r, size_t item, uint32_t paths)
{
    const size_t cells = (size_t)r->sheet->basis.n_cells;
    for (unsigned m = 0; m <= ORL_BSDF_QUADRILATERAL; m++)
        if ((m & r->request->symmetry) == m)
            r->wanted[item - item % cells +
                      (size_t)orl_gonio_mirrored(&r->sheet->basis, (int)(item % cells),
                                                 (enum orl_bsdf_symmetry)m)] = paths;
}

/* Returns true if an item needs more than twice its paths, and the limit allows more. */
static bool needs_more(const struct round *r, size_t item, const double peaks[2])
{
    const uint64_t most = r->request->paths_most / ORL_GONIO_BATCHES;
    return orl_gonio_foreseen(r->sheet, item, peaks) > r->request->accuracy &&
           4ULL * r->sheet->paths[item] <= most;
}

/* Doubles the paths of items that need more. The others are measured once more with as many paths
 * for their errors. Returns true if any paths are needed. */
static bool want_more(struct round *r)
{
    const size_t cells = (size_t)r->sheet->basis.n_cells;
    bool any = false;
    for (size_t item = 0; item < r->sheet->items; item++)
        r->wanted[item] = 0;
    for (size_t front = 0; front < 2; front++) {
        double peaks[2];
        orl_gonio_peaks(r->sheet, front, peaks);
        for (size_t item = front * cells; item < (front + 1) * cells; item++)
            if (r->sheet->paths_before[item] == 0 && needs_more(r, item, peaks))
                want_mirrored(r, item, 2 * r->sheet->paths[item]);
        for (size_t item = front * cells; item < (front + 1) * cells; item++) {
            if (r->sheet->paths_before[item] == 0 && r->wanted[item] == 0) {
                r->short_of =
                    r->short_of || orl_gonio_foreseen(r->sheet, item, peaks) > r->request->accuracy;
                r->wanted[item] = r->sheet->paths[item];
                orl_gonio_sheet_put_aside(r->sheet, item);
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
    for (size_t item = 0; item < r->sheet->items; item++)
        r->wanted[item] = first;
    r->sheet->exact = r->sample->file != NULL;
    do {
        code = r->env->shared && !r->sample->file ? share_round(r, err) : measure_round(r, err);
        r->number++;
    } while (code == 0 && accurate && want_more(r));
    return code;
}

/* ---- The file -------------------------------------------------------------------------------- */

static int fill_part(const struct orl_gonio_sheet *sheet, bool front, bool transmitted, bool errors,
                     struct orl_component *part, struct orl_error *err)
{
    const struct orl_basis *basis = &sheet->basis;
    const size_t cells = (size_t)basis->n_cells;
    const bool color = sheet->channels > 1 && !errors;
    int code = orl_matrix_init(&part->matrix, basis, basis, err);
    for (int k = 0; k < ORL_CHROMA_CHANNELS && color && code == 0; k++)
        code = orl_matrix_init(&part->chroma.matrix[k], basis, basis, err);
    if (code < 0)
        return code;
    for (size_t i = 0; i < cells * cells; i++) {
        const struct orl_gonio_value v =
            orl_gonio_sheet_value(sheet, front * cells + i / cells, transmitted, (int)(i % cells));
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
static int write_out(const struct round *r, bool errors, struct orl_bsdf_made *made,
                     struct orl_error *err)
{
    struct orl_document document = {.structure = ORL_STRUCTURE_MATRIX};
    int code = 0;
    for (int part = 0; part < 4 && code == 0; part++)
        code = fill_part(r->sheet, part / 2, part % 2, errors,
                         &document.parts[orl_gonio_part_of[part / 2][part % 2]], err);
    if (code == 0 && (errors ? orl_gonio_write_errors : orl_gonio_write)(
                         &document, NULL, NULL, r->sample, r->request, made) < 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF's text");
    orl_document_done(&document);
    return code;
}

static const char *name_of(enum orl_bsdf_basis basis)
{
    return basis == ORL_BSDF_KLEMS_FULL   ? "LBNL/Klems Full"
           : basis == ORL_BSDF_KLEMS_HALF ? "LBNL/Klems Half"
                                          : "LBNL/Klems Quarter";
}

int orl_gonio_make_klems(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err)
{
    struct orl_gonio_sheet sheet;
    int code = orl_gonio_sheet_init(&sheet, name_of(request->basis), request->color,
                                    request->symmetry, err);
    if (code < 0)
        return code;
    uint32_t *wanted = malloc(sheet.items * sizeof *wanted);
    size_t *todo = malloc(sheet.items * sizeof *todo);
    struct round round = {.request = request,
                          .env = env,
                          .sample = sample,
                          .sheet = &sheet,
                          .lamp = {sample, sobol, request->seed, env->cancel},
                          .wanted = wanted,
                          .todo = todo,
                          .number = 1};
    code = wanted && todo ? measure_all(&round, err)
                          : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (code == 0)
        code = orl_gonio_tell(&sheet, made, err);
    if (code == 0) {
        made->reached = !round.short_of;
        code = write_out(&round, false, made, err);
        if (code == 0 && request->tell_errors)
            code = write_out(&round, true, made, err);
    }
    free(wanted);
    free(todo);
    orl_gonio_sheet_done(&sheet);
    return code;
}

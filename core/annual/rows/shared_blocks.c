#include "annual/rows/shared_blocks.h"

#include <stdlib.h>
#include <string.h>

size_t orl_year_shared_block(size_t n_sensors, size_t most)
{
    enum { BLOCKS = 2000, LEAST = 8 };
    const size_t size = n_sensors / BLOCKS;
    return size < LEAST ? LEAST : size < most ? size : most;
}

static void choose_block(struct orl_year *y, size_t index)
{
    const size_t n = y->request->n_sensors;
    y->first = index * y->block;
    y->count = n - y->first < y->block ? n - y->first : y->block;
}

/* Time of a path with its sunlight, in a room of a dozen surfaces. */
static const double path_s = 1e-5;

/* Estimated time of the current block, in seconds of one core. */
static double block_s(const struct orl_year *y)
{
    return path_s * (double)y->count * (double)y->batch_samples * ORL_ANNUAL_BATCHES;
}

/* Memory of the sums of all batches of the current block. */
static uint64_t block_bytes(const struct orl_year *y)
{
    const struct orl_block_sums *sums = &y->sums;
    const uint64_t of_light = sums->n_nodes * sizeof *sums->nodes + ORL_BINS * sizeof *sums->bins;
    const uint64_t of_batch =
        y->n_parts * of_light +
        sums->n_beams * (sizeof *sums->beams + ORL_SUN_MAP_LOTS * sizeof *sums->lots);
    return of_batch * y->count * ORL_ANNUAL_BATCHES;
}

/* Returns true if the store has all of the current block. The piece's key is that of its rows or
 * paths. */
static bool is_made(struct orl_year *y, struct orl_piece *ret_piece)
{
    struct orl_keeping paths = {.what = y->shares_rows ? ORL_YEARS_ROWS : ORL_YEARS_PATHS,
                                .first = y->first,
                                .count = y->count,
                                .samples = y->result->samples},
                       sun = {.what = ORL_YEARS_SUN, .first = y->first, .count = y->count};
    const bool has_paths = orl_keep_has(&y->keep, &paths);
    const bool has_sun = y->shares_rows || orl_keep_has(&y->keep, &sun);
    *ret_piece = (struct orl_piece){
        .kind = "rows", .work = (double)y->count, .core_s = block_s(y), .bytes = block_bytes(y)};
    memcpy(ret_piece->key, paths.key, sizeof ret_piece->key);
    return has_paths && has_sun;
}

/* Lists the missing blocks with their indices, and returns their number. */
static size_t list_wanting(struct orl_year *y, size_t n, struct orl_piece *pieces, size_t *places)
{
    size_t wanting = 0;
    for (size_t i = 0; i < n; i++) {
        choose_block(y, i);
        places[wanting] = i;
        wanting += !is_made(y, &pieces[wanting]);
    }
    return wanting;
}

struct wanting {
    struct orl_piece *pieces;
    size_t *places;
    bool *here;
};

static void report_share(void *ctx, double share)
{
    struct orl_year *y = ctx;
    orl_year_tell(y, ORL_STAGE_RENDER, share * (double)y->request->n_sensors);
}

/* Divides blocks among processes until the store has all, or no more can be stored. */
static int share_wanting(struct orl_year *y, size_t n, const struct wanting *w,
                         orl_year_make_block *make, struct orl_error *err)
{
    const struct orl_pieces *shared = y->env->run->pieces;
    const struct orl_pieces_watch watch = {report_share, y};
    size_t wanting = list_wanting(y, n, w->pieces, w->places), before = n + 1;
    int code = 0;
    while (code == 0 && wanting > 0 && wanting < before) {
        before = wanting;
        memset(w->here, 0, n * sizeof *w->here);
        code = shared->divide(shared->ctx, w->pieces, wanting, w->here, &watch, err);
        for (size_t i = 0; i < wanting && code == 0; i++) {
            choose_block(y, w->places[i]);
            code = w->here[i] ? make(y, err) : 0;
        }
        if (code == 0 && orl_pieces_are_over(shared))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "all that is wanted of the run is made");
        if (code == 0)
            wanting = list_wanting(y, n, w->pieces, w->places);
    }
    return code;
}

int orl_year_share_blocks(struct orl_year *y, orl_year_make_block *make, struct orl_error *err)
{
    const size_t n = (y->request->n_sensors + y->block - 1) / y->block;
    const struct wanting w = {.pieces = calloc(n + 1, sizeof *w.pieces),
                              .places = calloc(n + 1, sizeof *w.places),
                              .here = calloc(n + 1, sizeof *w.here)};
    const int code = w.pieces && w.places && w.here ? share_wanting(y, n, &w, make, err)
                                                    : orl_year_no_memory(err);
    free(w.pieces);
    free(w.places);
    free(w.here);
    return code;
}

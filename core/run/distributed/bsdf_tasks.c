#include <oriel/bsdf_shared.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/distributed/pieces.h"

/* Version of a lot's content and file layout; change it with either. */
static const char recipe[] = "oriel bsdf lots 2";

static void name_lot(const char *job, const struct orl_bsdf_lots *lots, size_t index,
                     struct orl_piece *ret_piece)
{
    struct orl_sha256 hash;
    const uint64_t number = index;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, job, strlen(job) + 1);
    orl_sha256_add(&hash, lots->name, strlen(lots->name) + 1);
    orl_sha256_add(&hash, &number, sizeof number);
    *ret_piece = (struct orl_piece){.kind = "lot", .core_s = lots->core_s(lots->ctx, index)};
    ret_piece->work = ret_piece->core_s;
    orl_piece_key_end(&hash, ret_piece->key);
}

static int run_lots(void *ctx, const struct orl_bsdf_lots *lots, struct orl_error *err)
{
    const struct orl_bsdf_pieces *state = ctx;
    const struct orl_run_env run = {.store = state->store, .pieces = state->pieces};
    struct orl_piece_work work = {
        .n = lots->n, .ctx = lots->ctx, .make = lots->make, .take = lots->take, .told = lots->told};
    work.pieces = calloc(lots->n + 1, sizeof *work.pieces);
    if (!work.pieces)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < lots->n; i++)
        name_lot(state->pieces->job, lots, i, &work.pieces[i]);
    const int code = orl_run_pieces(&run, &work, err);
    free(work.pieces);
    return code;
}

struct orl_bsdf_sharing orl_bsdf_share(struct orl_bsdf_pieces *state)
{
    return (struct orl_bsdf_sharing){state, run_lots};
}

#include "run/distributed/pieces.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/cache/word_file.h"

/* Version of the pieces' content and file layout; raised when either changes. */
static const char recipe[] = "oriel pieces 4";

bool orl_run_is_shared(const struct orl_run_state *state)
{
    return state->env->pieces && state->env->store && !state->pilot;
}

/* ---- Keys ------------------------------------------------------------------------------------ */

void orl_piece_key_begin(const struct orl_run_state *state, struct orl_sha256 *hash)
{
    const struct orl_run_env *env = state->env;
    const struct orl_job *job = state->job;
    const char *sky = env->file_prefix ? env->file_prefix : "";
    const uint64_t numbers[] = {
        job->seed, job->gather_samples, (uint64_t)state->result->plan.technique,
        state->result->plan.photons_global, state->result->plan.photons_caustic};
    orl_sha256_init(hash);
    orl_sha256_add(hash, recipe, sizeof recipe);
    orl_sha256_add(hash, env->pieces->job, strlen(env->pieces->job) + 1);
    orl_sha256_add(hash, sky, strlen(sky) + 1);
    orl_sha256_add(hash, numbers, sizeof numbers);
    orl_sha256_add(hash, state->scene->description.digest, ORL_SHA256_BYTES);
    orl_scene_digest_recipe(state->scene, hash);
    orl_sha256_add(hash, state->shift, sizeof state->shift);
    if (state->bandwidths)
        orl_sha256_add(hash, state->bandwidths, ORL_MAP_KINDS * sizeof *state->bandwidths);
}

void orl_piece_key_end(struct orl_sha256 *hash, char ret_key[ORL_PIECE_KEY])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_key, ORL_PIECE_KEY, digest, sizeof digest);
}

void orl_pieces_foresee(const struct orl_run_state *state, struct orl_piece_work *work,
                        double share)
{
    const double crew = orl_crew_size(state->env->crew);
    const double core_s = crew * share * state->cost_s[ORL_STAGE_RENDER];
    double all = 0;
    for (size_t i = 0; i < work->n; i++)
        all += work->pieces[i].work;
    for (size_t i = 0; i < work->n && all > 0; i++)
        work->pieces[i].core_s = core_s * work->pieces[i].work / all;
}

/* ---- Pieces ---------------------------------------------------------------------------------- */

/* Takes a piece from the store if it is there and intact. */
static int find_piece(const struct orl_run_env *env, const struct orl_piece_work *work,
                      size_t index, bool *ret_found, struct orl_error *err)
{
    const struct orl_map_store *store = env->store;
    const struct orl_piece *piece = &work->pieces[index];
    struct orl_map_info info;
    struct orl_kept_about about;
    char path[4096];
    void *data = NULL;
    size_t size = 0;
    bool hit = false;
    int code =
        store->acquire(store->ctx, piece->kind, piece->key, env->cancel, path, &hit, &info, err);
    if (code < 0)
        return code;
    if (hit && orl_kept_read(path, piece->key, &about, &data, &size, NULL) == 0)
        code = work->take(work->ctx, index, data, size, ret_found, err);
    free(data);
    if (*ret_found)
        store->release(store->ctx, piece->kind, piece->key);
    else
        store->abandon(store->ctx, piece->kind, piece->key);
    return code;
}

static int keep_piece(const struct orl_run_env *env, const struct orl_piece *piece,
                      const void *data, size_t size, struct orl_error *err)
{
    const struct orl_map_store *store = env->store;
    struct orl_map_info info;
    struct orl_kept_about about = {.target = 0};
    char path[4096];
    bool hit = false;
    int code =
        store->acquire(store->ctx, piece->kind, piece->key, env->cancel, path, &hit, &info, err);
    if (code < 0 || hit) { /* another process has stored it first */
        if (code == 0)
            store->release(store->ctx, piece->kind, piece->key);
        return code;
    }
    memcpy(about.key, piece->key, sizeof about.key);
    code = orl_kept_write(path, &about, data, size, err);
    info = (struct orl_map_info){.stored = size / sizeof(float), .bytes = about.bytes};
    memcpy(info.kind, piece->kind, sizeof info.kind);
    memcpy(info.key, piece->key, sizeof info.key);
    if (code == 0)
        code = store->commit(store->ctx, &info, err);
    if (code == 0)
        store->release(store->ctx, piece->kind, piece->key);
    else
        store->abandon(store->ctx, piece->kind, piece->key);
    return code;
}

static int make_piece(const struct orl_run_env *env, const struct orl_piece_work *work,
                      size_t index, struct orl_error *err)
{
    void *data = NULL;
    size_t size = 0;
    int code = work->make(work->ctx, index, &data, &size, err);
    if (code == 0)
        code = keep_piece(env, &work->pieces[index], data, size, err);
    free(data);
    return code;
}

/* Missing pieces, and which of them are made here. */
struct wanting {
    struct orl_piece *pieces;
    size_t *places; /* their indices in the work */
    bool *here, *settled;
    size_t n;
};

static void wanting_done(struct wanting *w)
{
    free(w->pieces);
    free(w->places);
    free(w->here);
    free(w->settled);
}

static int find_missing(const struct orl_run_env *env, const struct orl_piece_work *work,
                        struct wanting *w, struct orl_error *err)
{
    int code = 0;
    w->n = 0;
    for (size_t i = 0; i < work->n && code == 0; i++) {
        if (!w->settled[i])
            code = find_piece(env, work, i, &w->settled[i], err);
        if (w->settled[i])
            continue;
        w->here[w->n] = false;
        w->places[w->n] = i;
        w->pieces[w->n++] = work->pieces[i];
    }
    return code;
}

/* Divides the missing pieces among processes and makes this run's own. */
static int divide_missing(const struct orl_run_env *env, const struct orl_piece_work *work,
                          struct wanting *w, struct orl_error *err)
{
    const struct orl_pieces_watch watch = {work->told, work->ctx};
    int code = env->pieces->divide(env->pieces->ctx, w->pieces, w->n, w->here,
                                   work->told ? &watch : NULL, err);
    for (size_t i = 0; i < w->n && code == 0; i++)
        if (w->here[i]) {
            code = make_piece(env, work, w->places[i], err);
            w->settled[w->places[i]] = true;
        }
    return code == 0 && orl_pieces_are_over(env->pieces)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "all that is wanted of the run is made")
               : code;
}

int orl_run_pieces(const struct orl_run_env *env, const struct orl_piece_work *work,
                   struct orl_error *err)
{
    struct wanting w = {.pieces = calloc(work->n + 1, sizeof *w.pieces),
                        .places = calloc(work->n + 1, sizeof *w.places),
                        .here = calloc(work->n + 1, sizeof *w.here),
                        .settled = calloc(work->n + 1, sizeof *w.settled)};
    size_t before = SIZE_MAX;
    int code = w.pieces && w.places && w.here && w.settled
                   ? find_missing(env, work, &w, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    while (code == 0 && w.n > 0) {
        if (w.n >= before)
            code =
                orl_error_set(err, ORL_ERR_INTERNAL,
                              "%zu pieces of the job were made by others, and are not there", w.n);
        before = w.n;
        if (code == 0)
            code = divide_missing(env, work, &w, err);
        if (code == 0)
            code = find_missing(env, work, &w, err);
    }
    wanting_done(&w);
    return code;
}

/* ---- Counts and warnings --------------------------------------------------------------------- */

static struct orl_piece note_of(const char *kind, const char *key)
{
    struct orl_piece piece = {.work = 1};
    snprintf(piece.kind, sizeof piece.kind, "%s", kind);
    snprintf(piece.key, sizeof piece.key, "%s", key);
    return piece;
}

void orl_run_keep_counts(const struct orl_run_state *state, const char *key,
                         const struct orl_health *health)
{
    const struct orl_piece piece = note_of("counts", key);
    keep_piece(state->env, &piece, health, sizeof *health, NULL);
}

static int take_counts(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                       struct orl_error *err)
{
    struct orl_run_state *state = ctx;
    struct orl_health health;
    (void)index, (void)err;
    *ret_taken = size == sizeof health;
    if (*ret_taken) {
        memcpy(&health, data, sizeof health);
        orl_health_add(&state->result->health, &health);
    }
    return 0;
}

bool orl_run_add_counts(struct orl_run_state *state, const char *key)
{
    struct orl_piece piece = note_of("counts", key);
    const struct orl_piece_work work = {
        .pieces = &piece, .n = 1, .ctx = state, .take = take_counts};
    bool found = false;
    find_piece(state->env, &work, 0, &found, NULL);
    return found;
}

/* Packs NUL-terminated warnings, padded with zeros to whole words. */
void orl_run_keep_warnings(const struct orl_run_state *state, const char *key, size_t first)
{
    const struct orl_piece piece = note_of("warned", key);
    const struct orl_result *result = state->result;
    size_t size = 0;
    for (size_t i = first; i < result->n_warnings; i++)
        size += strlen(result->warnings[i]) + 1;
    size = (size + 3) / 4 * 4;
    char *text = calloc(1, size + 1), *to = text;
    for (size_t i = first; text && i < result->n_warnings; i++)
        to = stpcpy(to, result->warnings[i]) + 1;
    if (text && size > 0)
        keep_piece(state->env, &piece, text, size, NULL);
    free(text);
}

static int take_warnings(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                         struct orl_error *err)
{
    struct orl_run_state *state = ctx;
    const char *at = data, *end = at + size;
    (void)index, (void)err;
    *ret_taken = size > 0 && end[-1] == '\0';
    for (; *ret_taken && at < end; at += strlen(at) + 1)
        if (*at)
            orl_run_warn_once(state, "%s", at);
    return 0;
}

void orl_run_add_warnings(struct orl_run_state *state, const char *key)
{
    struct orl_piece piece = note_of("warned", key);
    const struct orl_piece_work work = {
        .pieces = &piece, .n = 1, .ctx = state, .take = take_warnings};
    bool found = false;
    find_piece(state->env, &work, 0, &found, NULL);
}

void orl_run_take_health(const struct orl_run_state *state, struct orl_health *ret_health)
{
    *ret_health = (struct orl_health){.rays = 0};
    for (uint32_t i = 0; i < orl_crew_size(state->env->crew); i++) {
        orl_health_add(ret_health, &state->searches[i].health);
        state->searches[i].health = (struct orl_health){.rays = 0};
    }
}

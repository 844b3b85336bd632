/* Distributes views as pieces of a job. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/stages/rendering.h"

/* Context of the piece callbacks. */
struct shared {
    struct orl_rendering *rendering;
    const size_t *views;
};

/* Layout of a picture's file: this header, pixels, and their errors. */
struct head {
    struct orl_health health;
    double seconds;
};

static size_t pixels_of(const struct orl_film *film)
{
    return (size_t)film->width * film->height;
}

static size_t bytes_of(const struct orl_film *film)
{
    return sizeof(struct head) + pixels_of(film) * (sizeof *film->pixels + sizeof *film->errors);
}

static int pack_view(const struct orl_film *film, const struct head *head, void **ret_data,
                     size_t *ret_size, struct orl_error *err)
{
    const size_t pixels = pixels_of(film) * sizeof *film->pixels;
    char *to = malloc(bytes_of(film));
    *ret_data = to;
    *ret_size = bytes_of(film);
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    memcpy(to, head, sizeof *head);
    memcpy(to + sizeof *head, film->pixels, pixels);
    memcpy(to + sizeof *head + pixels, film->errors, pixels_of(film) * sizeof *film->errors);
    return 0;
}

static int make_view(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                     struct orl_error *err)
{
    const struct shared *shared = ctx;
    const struct orl_run_state *state = shared->rendering->state;
    const struct orl_run_env *env = state->env;
    const size_t view = shared->views[index];
    const double started = env->now_s(env->ctx);
    struct orl_health before;
    struct head head;
    struct orl_film film = {0};
    memset(&head, 0, sizeof head);
    orl_run_take_health(state, &before);
    int code = orl_paint_view(shared->rendering, view, &film, err);
    orl_run_take_health(state, &head.health);
    orl_health_add(&before, &head.health);
    state->searches[0].health = before;
    head.seconds = env->now_s(env->ctx) - started;
    if (code == 0)
        code = pack_view(&film, &head, ret_data, ret_size, err);
    if (code == 0)
        code = orl_finish_view(shared->rendering, view, &film, started, err);
    orl_film_done(&film);
    return code;
}

static int show_view(const struct shared *shared, size_t view, const char *data, size_t size,
                     bool *ret_fits, struct orl_error *err)
{
    struct orl_run_state *state = shared->rendering->state;
    struct orl_view ignored;
    struct orl_film film = {0};
    struct head head;
    int code = orl_open_view(state, view, &ignored, &film, err);
    *ret_fits = code == 0 && size == bytes_of(&film);
    if (*ret_fits) {
        const size_t pixels = pixels_of(&film) * sizeof *film.pixels;
        memcpy(&head, data, sizeof head);
        memcpy(film.pixels, data + sizeof head, pixels);
        memcpy(film.errors, data + sizeof head + pixels, pixels_of(&film) * sizeof *film.errors);
        orl_health_add(&state->result->health, &head.health);
        code = orl_finish_view(shared->rendering, view, &film,
                               state->env->now_s(state->env->ctx) - head.seconds, err);
    }
    orl_film_done(&film);
    return code;
}

static int take_view(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                     struct orl_error *err)
{
    const struct shared *shared = ctx;
    return show_view(shared, shared->views[index], data, size, ret_taken, err);
}

static void name_view(const struct orl_run_state *state, size_t index, struct orl_piece *piece)
{
    const struct orl_view_request *view = &state->job->views[index];
    const uint64_t numbers[] = {index, state->job->pixel_samples, view->width, view->height};
    struct orl_sha256 hash;
    orl_piece_key_begin(state, &hash);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    orl_sha256_add(&hash, view->view, strlen(view->view));
    orl_piece_key_end(&hash, piece->key);
    snprintf(piece->kind, sizeof piece->kind, "view");
    piece->work = (double)view->width * view->height;
    piece->bytes = ORL_PIXEL_BYTES * (uint64_t)view->width * view->height;
}

static void report_share(void *ctx, double share)
{
    const struct orl_rendering *rendering = ((const struct shared *)ctx)->rendering;
    orl_run_progress(rendering->state, rendering->share + share * (1 - rendering->share));
}

int orl_share_views(struct orl_rendering *rendering, const size_t *views, size_t n,
                    struct orl_error *err)
{
    struct shared shared = {rendering, views};
    struct orl_piece_work work = {
        .n = n, .ctx = &shared, .make = make_view, .take = take_view, .told = report_share};
    work.pieces = calloc(n + 1, sizeof *work.pieces);
    if (!work.pieces)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < n; i++)
        name_view(rendering->state, views[i], &work.pieces[i]);
    orl_pieces_foresee(rendering->state, &work, 1 - rendering->share);
    const int code = orl_run_pieces(rendering->state->env, &work, err);
    free(work.pieces);
    return code;
}

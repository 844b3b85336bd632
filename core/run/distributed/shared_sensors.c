/* Distributes stretches of sensors as pieces of a job. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/stages/rendering.h"

/* Layout of a stretch's file: this header, the results of the sensors and, in rounds by backward,
 * their groups. */
struct stretch_head {
    struct orl_health health;
};

static size_t groups_of(const struct orl_rendering *rendering)
{
    return rendering->state->sensor_round ? ORL_MAP_BATCHES : 0;
}

static size_t stretch_bytes(const struct orl_rendering *rendering, size_t count)
{
    return sizeof(struct stretch_head) +
           count * (sizeof(struct orl_sensor_found) + groups_of(rendering) * sizeof(double));
}

static int make_stretch(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                        struct orl_error *err)
{
    struct orl_rendering *rendering = ctx;
    const struct orl_run_state *state = rendering->state;
    const size_t first = index * rendering->stretch, count = orl_stretch_size(rendering, first);
    struct stretch_head head;
    struct orl_health before;
    char *to = malloc(stretch_bytes(rendering, count));
    *ret_data = to;
    *ret_size = stretch_bytes(rendering, count);
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", count);
    orl_run_take_health(state, &before);
    const int code = orl_compute_stretch(rendering, first, err);
    orl_run_take_health(state, &head.health);
    orl_health_add(&before, &head.health);
    state->searches[0].health = before;
    memcpy(to, &head, sizeof head);
    to += sizeof head;
    memcpy(to, rendering->found, count * sizeof *rendering->found);
    to += count * sizeof *rendering->found;
    for (size_t i = 0; i < count && groups_of(rendering) > 0; i++) {
        const size_t bytes = ORL_MAP_BATCHES * sizeof(double);
        memcpy(to,
               state->sensor_round->groups + orl_sensor_at(rendering, first + i) * ORL_MAP_BATCHES,
               bytes);
        to += bytes;
    }
    return code;
}

static int take_stretch(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                        struct orl_error *err)
{
    struct orl_rendering *rendering = ctx;
    const struct orl_run_state *state = rendering->state;
    const size_t first = index * rendering->stretch, count = orl_stretch_size(rendering, first);
    const char *from = data;
    struct stretch_head head;
    (void)err;
    *ret_taken = size == stretch_bytes(rendering, count);
    if (!*ret_taken)
        return 0;
    memcpy(&head, from, sizeof head);
    from += sizeof head;
    memcpy(rendering->found, from, count * sizeof *rendering->found);
    from += count * sizeof *rendering->found;
    for (size_t i = 0; i < count; i++) {
        const size_t sensor = orl_sensor_at(rendering, first + i), bytes = groups_of(rendering) * 8;
        rendering->renderer->sensor_found(rendering->renderer->ctx, sensor, &rendering->found[i]);
        if (bytes > 0)
            memcpy(state->sensor_round->groups + sensor * ORL_MAP_BATCHES, from, bytes);
        from += bytes;
        atomic_fetch_add(&rendering->taken, orl_run_sensor_samples(state, sensor));
    }
    orl_health_add(&state->result->health, &head.health);
    orl_tell_sensors(rendering);
    return 0;
}

static void name_stretch(const struct orl_rendering *rendering, size_t first,
                         struct orl_piece *piece)
{
    const struct orl_run_state *state = rendering->state;
    const uint64_t numbers[] = {first, state->n_sensors};
    struct orl_sha256 hash;
    orl_piece_key_begin(state, &hash);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = 0; i < orl_stretch_size(rendering, first); i++) {
        const size_t sensor = orl_sensor_at(rendering, first + i);
        const uint64_t samples = orl_run_sensor_samples(state, sensor);
        const uint64_t before =
            state->sensor_round ? state->sensor_round->before[sensor] : UINT64_MAX;
        orl_sha256_add(&hash, &samples, sizeof samples);
        orl_sha256_add(&hash, &before, sizeof before);
        piece->work += (double)samples;
    }
    orl_piece_key_end(&hash, piece->key);
    snprintf(piece->kind, sizeof piece->kind, "sensors");
}

static void report_share(void *ctx, double share)
{
    struct orl_rendering *rendering = ctx;
    const double taken = (double)atomic_load(&rendering->taken);
    rendering->elsewhere = taken + share * ((double)rendering->samples - taken);
    orl_tell_sensors(rendering);
}

int orl_share_sensors(struct orl_rendering *rendering, struct orl_error *err)
{
    const struct orl_run_state *state = rendering->state;
    rendering->stretch = orl_shared_stretch(state->n_sensors);
    struct orl_piece_work work = {.n = (state->n_sensors + rendering->stretch - 1) /
                                       rendering->stretch,
                                  .ctx = rendering,
                                  .make = make_stretch,
                                  .take = take_stretch,
                                  .told = report_share};
    work.pieces = calloc(work.n, sizeof *work.pieces);
    if (!work.pieces)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < work.n; i++)
        name_stretch(rendering, i * rendering->stretch, &work.pieces[i]);
    orl_pieces_foresee(state, &work, rendering->share);
    const int code = orl_run_pieces(state->env, &work, err);
    free(work.pieces);
    return code;
}

#include "render/image/adaptive_tile_pixels.h"

/* Returns the largest number of additional gloss rays among a pixel and its neighbours. */
static uint32_t wanted_about(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    uint32_t most = 0;
    for (int i = 0; i < 9; i++) {
        const int u = x + i % 3 - 1, v = y + i / 3 - 1;
        if (orl_tile_contains(tile_state, u, v) && orl_tile_pixel_at(tile_state, u, v)->more > most)
            most = orl_tile_pixel_at(tile_state, u, v)->more;
    }
    return most;
}

/* Sets up one of several looks through a pixel, which share the points of one sequence. */
static void share_lobes(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const struct orl_lobe_share *share, struct orl_shader *shader)
{
    const uint64_t name =
        orl_mix64(tile_state->painter->seed * 7 + orl_tile_pixel_index(tile_state, x, y));
    shader->pane_samples = (shader->pane_samples + share->of - 1) / share->of;
    shader->gloss_samples = (shader->gloss_samples + share->of - 1) / share->of +
                            wanted_about(tile_state, x, y) / ORL_PIXEL_RAYS;
    shader->sequence = (uint32_t)(name >> 32) | 1;
    shader->first_gloss = share->look * shader->gloss_samples;
}

bool orl_tile_trace_ray(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const double place[2], struct orl_lobe_share share,
                        struct orl_random *random, struct orl_shaded_ray *ret_shaded)
{
    const struct orl_tile_painter *painter = tile_state->painter;
    struct orl_shader shader = painter->shader;
    struct orl_vec3 origin, direction;
    if (!orl_paint_ray(painter->painting, (double)tile_state->tile->x0 + x + place[0],
                       (double)tile_state->tile->y0 + y + place[1], &origin, &direction))
        return false;
    if (share.of > 1)
        share_lobes(tile_state, x, y, &share, &shader);
    orl_shade_ray(&shader, origin, direction, painter->outside, share.of > 0, random,
                  tile_state->search, ret_shaded);
    ret_shaded->rest = orl_health_filter(&tile_state->search->health, ret_shaded->rest);
    ret_shaded->lobes = orl_health_filter(&tile_state->search->health, ret_shaded->lobes);
    return true;
}

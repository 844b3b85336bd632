#include "render/image/mosaic_cells.h"

bool orl_cell_look(const struct orl_tile_cells *mosaic, int x, int y, const double place[2],
                   uint32_t lobe_share, struct orl_random *random, struct orl_shaded *ret_shaded)
{
    const struct orl_mosaic *m = mosaic->m;
    struct orl_shader shader = m->shader;
    struct orl_vec3 origin, direction;
    if (!orl_paint_ray(m->painting, (double)mosaic->tile->x0 + x + place[0],
                       (double)mosaic->tile->y0 + y + place[1], &origin, &direction))
        return false;
    if (lobe_share > 1) {
        shader.pane_samples = (shader.pane_samples + lobe_share - 1) / lobe_share;
        shader.gloss_samples = (shader.gloss_samples + lobe_share - 1) / lobe_share;
    }
    orl_shade_ray(&shader, origin, direction, m->outside, lobe_share > 0, random, mosaic->search,
                  ret_shaded);
    ret_shaded->rest = orl_health_keep(&mosaic->search->health, ret_shaded->rest);
    ret_shaded->lobes = orl_health_keep(&mosaic->search->health, ret_shaded->lobes);
    return true;
}

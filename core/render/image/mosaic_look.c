#include "render/image/mosaic_cells.h"

bool orl_cell_look(const struct orl_tile_cells *mosaic, int x, int y, const double place[2],
                   uint32_t lobe_share, struct orl_random *random, struct orl_sight *ret_sight)
{
    const struct orl_mosaic *m = mosaic->m;
    struct orl_onlooker onlooker = m->onlooker;
    struct orl_vec3 origin, direction;
    if (!orl_paint_ray(m->painting, (double)mosaic->tile->x0 + x + place[0],
                       (double)mosaic->tile->y0 + y + place[1], &origin, &direction))
        return false;
    if (lobe_share > 1) {
        onlooker.pane_samples = (onlooker.pane_samples + lobe_share - 1) / lobe_share;
        onlooker.gloss_samples = (onlooker.gloss_samples + lobe_share - 1) / lobe_share;
    }
    orl_shade_look(&onlooker, origin, direction, m->outside, lobe_share > 0, random, mosaic->search,
                   ret_sight);
    ret_sight->rest = orl_health_keep(&mosaic->search->health, ret_sight->rest);
    ret_sight->lobes = orl_health_keep(&mosaic->search->health, ret_sight->lobes);
    return true;
}

#include "photon/map/zorder.h"

#include <stdlib.h>
#include <string.h>

static uint64_t first_code(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    uint32_t cell[3];
    orl_position_unpack(words[0], words[ORL_MAP_LEAF], cell);
    return orl_zorder_code(cell, map->normals[leaf * ORL_MAP_LEAF]);
}

/* Allocates codes for whole groups of eight. Entries past the end are greater than any code. */
static uint64_t *new_codes(uint64_t count)
{
    const uint64_t padded = (count + ORL_ZORDER_FANOUT - 1) / ORL_ZORDER_FANOUT * ORL_ZORDER_FANOUT;
    uint64_t *codes = malloc(padded * sizeof *codes);
    if (codes)
        memset(codes + count, 0xff, (padded - count) * sizeof *codes);
    return codes;
}

int orl_zorder_init(struct orl_zorder *order, const struct orl_photon_map *map)
{
    uint64_t count = (map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    *order = (struct orl_zorder){.levels = 0};
    while (count > 0) {
        const uint32_t level = order->levels;
        uint64_t *codes = new_codes(count);
        if (!codes) {
            orl_zorder_done(order);
            return ORL_ERR_NOMEM;
        }
        for (uint64_t i = 0; i < count; i++)
            codes[i] =
                level == 0 ? first_code(map, i) : order->codes[level - 1][i * ORL_ZORDER_FANOUT];
        order->codes[level] = codes;
        order->counts[level] = count;
        order->levels++;
        if (count <= ORL_ZORDER_FANOUT)
            break;
        count = (count + ORL_ZORDER_FANOUT - 1) / ORL_ZORDER_FANOUT;
    }
    return 0;
}

void orl_zorder_done(struct orl_zorder *order)
{
    for (uint32_t level = 0; level < order->levels; level++)
        free(order->codes[level]);
    *order = (struct orl_zorder){.levels = 0};
}

uint64_t orl_zorder_find(const struct orl_zorder *order, uint64_t code)
{
    uint64_t at = 0;
    for (uint32_t level = order->levels; level-- > 0;) {
        const uint64_t *group = order->codes[level] + at * ORL_ZORDER_FANOUT;
        uint64_t begun = 0;
        for (int i = 0; i < ORL_ZORDER_FANOUT; i++)
            begun += group[i] <= code;
        at = at * ORL_ZORDER_FANOUT + (begun > 0 ? begun - 1 : 0);
    }
    return at;
}

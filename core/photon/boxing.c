#include "photon/boxing.h"

#include "photon/facing.h"

static void clear_group(struct orl_map_group *group)
{
    for (int c = 0; c < ORL_MAP_FANOUT; c++) {
        group->facing[c] = 0;
        for (int k = 0; k < 3; k++) {
            group->low[k][c] = INFINITY;
            group->high[k][c] = -INFINITY;
        }
    }
}

static inline void include_box(struct orl_map_group *group, uint64_t child, const float low[3],
                               const float high[3], uint32_t facing)
{
    group->facing[child] |= facing;
    for (int k = 0; k < 3; k++) {
        if (low[k] < group->low[k][child])
            group->low[k][child] = low[k];
        if (high[k] > group->high[k][child])
            group->high[k][child] = high[k];
    }
}

void orl_box_leaves(const struct orl_map_layout *layout, char *file, uint64_t first, uint64_t end)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    const uint32_t *places = (const void *)(file + layout->places);
    const uint16_t *normals = (const void *)(file + layout->normals);
    for (uint64_t i = first; i < end; i++) {
        const uint64_t leaf = i / ORL_MAP_LEAF;
        const uint32_t *words = places + leaf * ORL_LEAF_WORDS + i % ORL_MAP_LEAF;
        uint32_t cell[3];
        if (i % ORL_BOXED_AT_ONCE == 0)
            clear_group(&groups[leaf / ORL_MAP_FANOUT]);
        orl_place_unpack(words[0], words[ORL_MAP_LEAF], cell);
        const float at[3] = {(float)cell[0], (float)cell[1], (float)cell[2]};
        include_box(&groups[leaf / ORL_MAP_FANOUT], leaf % ORL_MAP_FANOUT, at, at,
                    1U << orl_facing_bin(normals[i]));
    }
}

void orl_box_nodes(const struct orl_map_layout *layout, char *file)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    for (uint32_t level = 1; level < layout->levels; level++) {
        const struct orl_map_group *below = groups;
        groups += layout->groups[level - 1];
        for (uint64_t g = 0; g < layout->groups[level]; g++)
            clear_group(&groups[g]);
        for (uint64_t node = 0; node < layout->groups[level - 1]; node++) {
            for (int c = 0; c < ORL_MAP_FANOUT; c++) {
                const float low[3] = {below[node].low[0][c], below[node].low[1][c],
                                      below[node].low[2][c]};
                const float high[3] = {below[node].high[0][c], below[node].high[1][c],
                                       below[node].high[2][c]};
                include_box(&groups[node / ORL_MAP_FANOUT], node % ORL_MAP_FANOUT, low, high,
                            below[node].facing[c]);
            }
        }
    }
}

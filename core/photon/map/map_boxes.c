#include "photon/map/map_boxes.h"

#include "base/multiversion.h"
#include "photon/map/normal_code.h"

static void clear_group(struct orl_map_group *group)
{
    for (int c = 0; c < ORL_MAP_FANOUT; c++) {
        group->normal_bins[c] = 0;
        for (int k = 0; k < 3; k++) {
            group->low[k][c] = INFINITY;
            group->high[k][c] = -INFINITY;
        }
    }
}

static inline void include_box(struct orl_map_group *group, uint64_t child, const float low[3],
                               const float high[3], uint32_t normal_bins)
{
    group->normal_bins[child] |= normal_bins;
    for (int k = 0; k < 3; k++) {
        if (low[k] < group->low[k][child])
            group->low[k][child] = low[k];
        if (high[k] > group->high[k][child])
            group->high[k][child] = high[k];
    }
}

/* Computes a leaf's box, which is that of its photons' cells, in integers for sixteen photons at
 * once. */
static inline void box_leaf(const uint32_t *words, const uint16_t *normals, uint32_t n,
                            struct orl_map_group *group, uint64_t child)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};
    uint32_t normal_bins = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t a = words[i], b = words[i + ORL_MAP_LEAF];
        const int32_t x = (int32_t)(a & 0xfffffU), y = (int32_t)(b & 0xfffffU);
        const int32_t z = (int32_t)((a >> 24) << 12 | b >> 20);
        low[0] = x < low[0] ? x : low[0];
        low[1] = y < low[1] ? y : low[1];
        low[2] = z < low[2] ? z : low[2];
        high[0] = x > high[0] ? x : high[0];
        high[1] = y > high[1] ? y : high[1];
        high[2] = z > high[2] ? z : high[2];
    }
    for (uint32_t i = 0; i < n; i++)
        normal_bins |= 1U << orl_normal_bin(normals[i]);
    for (int k = 0; k < 3; k++) {
        group->low[k][child] = (float)low[k];
        group->high[k][child] = (float)high[k];
    }
    group->normal_bins[child] = normal_bins;
}

ORL_FOR_WIDE_VECTORS void orl_box_leaves(const struct orl_map_layout *layout, char *file,
                                         uint64_t first, uint64_t end)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    const uint32_t *places = (const void *)(file + layout->places);
    const uint16_t *normals = (const void *)(file + layout->normals);
    for (uint64_t i = first; i < end; i += ORL_MAP_LEAF) {
        const uint64_t leaf = i / ORL_MAP_LEAF, child = leaf % ORL_MAP_FANOUT;
        struct orl_map_group *group = &groups[leaf / ORL_MAP_FANOUT];
        const uint32_t *words = places + leaf * ORL_LEAF_WORDS;
        if (child == 0)
            clear_group(group);
        if (end - i >= ORL_MAP_LEAF)
            box_leaf(words, normals + i, ORL_MAP_LEAF, group, child);
        else
            box_leaf(words, normals + i, (uint32_t)(end - i), group, child);
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
                            below[node].normal_bins[c]);
            }
        }
    }
}

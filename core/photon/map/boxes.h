/* Traversal of a photon map's bounding-box hierarchy, shared by the searches. */
#ifndef ORL_PHOTON_MAP_BOXES_H
#define ORL_PHOTON_MAP_BOXES_H

#include "photon/map/map_layout.h"

/* A node to visit; level 0 is a leaf. */
struct orl_box_visit {
    float distance2;
    uint32_t level, node;
};

enum { ORL_BOX_STACK = ORL_MAP_LEVELS * ORL_MAP_FANOUT };

/* Computes the squared distance, in cells, from a point to each child's box; infinite for absent
 * children. */
static inline void orl_box_distances(const struct orl_map_group *restrict group, const float at[3],
                                     float ret_distance2[restrict ORL_MAP_FANOUT])
{
    const float x = at[0], y = at[1], z = at[2];
    /* The loop handles all axes of eight children at once, so that it can be vectorised. */
    for (int c = 0; c < ORL_MAP_FANOUT; c++) {
        const float left = group->low[0][c] - x, right = x - group->high[0][c];
        const float front = group->low[1][c] - y, back = y - group->high[1][c];
        const float below = group->low[2][c] - z, above = z - group->high[2][c];
        float u = left > right ? left : right, v = front > back ? front : back,
              w = below > above ? below : above;
        u = u > 0 ? u : 0;
        v = v > 0 ? v : 0;
        w = w > 0 ? w : 0;
        ret_distance2[c] = u * u + v * v + w * w;
    }
}

/*
 * Pushes the children of a node that are nearer than radius2 and hold a normal of the mask
 * `normal_bins`, the nearest on top.
 */
static inline uint32_t orl_box_push(const struct orl_photon_map *map, struct orl_box_visit visit,
                                    const float at[3], uint32_t normal_bins, float radius2,
                                    struct orl_box_visit *stack, uint32_t depth)
{
    const struct orl_map_group *group = &map->levels[visit.level - 1][visit.node];
    const uint32_t bottom = depth;
    float distance2[ORL_MAP_FANOUT];
    orl_box_distances(group, at, distance2);
    for (uint32_t c = 0; c < ORL_MAP_FANOUT; c++) {
        if (!(distance2[c] < radius2) || !(group->normal_bins[c] & normal_bins))
            continue;
        const struct orl_box_visit child = {distance2[c], visit.level - 1,
                                            visit.node * ORL_MAP_FANOUT + c};
        uint32_t place = depth++;
        while (place > bottom && stack[place - 1].distance2 < child.distance2) {
            stack[place] = stack[place - 1];
            place--;
        }
        stack[place] = child;
    }
    return depth;
}

/* Converts a point to cells, shifted by half a cell: a photon's cell corner then represents the
 * cell's centre. */
static inline void orl_box_locate(const struct orl_photon_map *map, struct orl_vec3 point,
                                  float ret_at[3])
{
    const struct orl_map_header *h = map->header;
    ret_at[0] = (float)((point.x - h->low[0]) / h->cell - 0.5);
    ret_at[1] = (float)((point.y - h->low[1]) / h->cell - 0.5);
    ret_at[2] = (float)((point.z - h->low[2]) / h->cell - 0.5);
}

#endif

#include "scene/geometry/corners.h"

#include <stdlib.h>
#include <string.h>

#include "base/grow.h"

enum { LATEST_BITS = 16 };

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry)
{
    *corners = (struct orl_corners){
        .geometry = geometry,
        .latest = calloc((size_t)1 << LATEST_BITS, sizeof *corners->latest),
    };
    return corners->latest &&
           orl_grow(&geometry->corners, &corners->room, 0, sizeof *geometry->corners);
}

void orl_corners_done(struct orl_corners *corners)
{
    free(corners->latest);
}

static size_t slot_of(struct orl_vec3 place)
{
    static const uint64_t odd = 0x9e3779b97f4a7c15U;
    uint64_t bits[3], mixed = 0;
    memcpy(bits, &place, sizeof bits);
    for (int k = 0; k < 3; k++) {
        mixed = (mixed ^ bits[k]) * odd;
        mixed ^= mixed >> 32;
    }
    return (mixed * odd) >> (64 - LATEST_BITS);
}

bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index)
{
    struct orl_geometry *const g = corners->geometry;
    uint32_t *const latest = &corners->latest[slot_of(place)];
    if (*latest == 0 || memcmp(&g->corners[*latest - 1], &place, sizeof place) != 0) {
        if (!orl_grow(&g->corners, &corners->room, g->n_corners, sizeof *g->corners))
            return false;
        g->corners[g->n_corners++] = place;
        *latest = (uint32_t)g->n_corners;
    }
    *ret_index = *latest - 1;
    return true;
}

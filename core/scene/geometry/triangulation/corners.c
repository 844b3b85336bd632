#include "scene/geometry/triangulation/corners.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"

enum { LATEST_BITS = 16 };

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry)
{
    *corners = (struct orl_corners){
        .geometry = geometry,
        .latest = calloc((size_t)1 << LATEST_BITS, sizeof *corners->latest),
    };
    return corners->latest &&
           orl_array_reserve(&geometry->corners, &corners->room, 0, sizeof *geometry->corners);
}

void orl_corners_done(struct orl_corners *corners)
{
    free(corners->latest);
}

/* A place by its bits: 0 and -0 differ. */
struct bits {
    uint64_t at[3];
};

static struct bits bits_of(struct orl_vec3 place)
{
    struct bits bits;
    memcpy(&bits.at[0], &place.x, sizeof place.x);
    memcpy(&bits.at[1], &place.y, sizeof place.y);
    memcpy(&bits.at[2], &place.z, sizeof place.z);
    return bits;
}

static bool are_same(struct orl_vec3 a, struct orl_vec3 b)
{
    const struct bits x = bits_of(a), y = bits_of(b);
    return x.at[0] == y.at[0] && x.at[1] == y.at[1] && x.at[2] == y.at[2];
}

static size_t slot_of(struct orl_vec3 place)
{
    static const uint64_t odd = 0x9e3779b97f4a7c15U;
    const struct bits bits = bits_of(place);
    uint64_t mixed = 0;
    for (int k = 0; k < 3; k++) {
        mixed = (mixed ^ bits.at[k]) * odd;
        mixed ^= mixed >> 32;
    }
    return (mixed * odd) >> (64 - LATEST_BITS);
}

bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index)
{
    struct orl_geometry *const g = corners->geometry;
    uint32_t *const latest = &corners->latest[slot_of(place)];
    if (*latest == 0 || !are_same(g->corners[*latest - 1], place)) {
        if (!orl_array_reserve(&g->corners, &corners->room, g->n_corners, sizeof *g->corners))
            return false;
        g->corners[g->n_corners++] = place;
        *latest = (uint32_t)g->n_corners;
    }
    *ret_index = *latest - 1;
    return true;
}

/* Layout of a photon map's words, shared by the writer and the search. */
#ifndef ORL_PHOTON_MAP_MAP_LAYOUT_H
#define ORL_PHOTON_MAP_MAP_LAYOUT_H

#include "photon/map/map.h"
#include "photon/map/normal_code.h"

enum { ORL_POSITION_BITS = 20, ORL_POSITION_CELLS = 1 << ORL_POSITION_BITS, ORL_LEAF_WORDS = 32 };

/* Bounds of the children of one node, in cells. An absent child has inverted bounds and an empty
 * mask. */
struct orl_map_group {
    float low[3][ORL_MAP_FANOUT], high[3][ORL_MAP_FANOUT];
    uint32_t normal_bins[ORL_MAP_FANOUT];
};

/* A mapped file, with pointers to its blocks. */
struct orl_photon_map {
    void *file;
    size_t size;
    const struct orl_map_header *header;
    const uint32_t *places, *fluxes;
    const uint16_t *normals, *tags;
    const unsigned char *notes;                         /* NULL: none */
    const struct orl_map_group *levels[ORL_MAP_LEVELS]; /* [0]: groups of leaves */
    struct orl_normal_bins normal_bins;
};

/* Makes a map of a file that was filled in anonymously mapped memory. Takes over the memory, and
 * unmaps it on failure. Returns 0 or ORL_ERR_NOMEM. */
int orl_photon_map_adopt(void *file, size_t size, struct orl_photon_map **ret_map,
                         struct orl_error *err);

/* Offsets and sizes of the file's blocks for a number of photons. */
struct orl_map_layout {
    uint64_t leaves, places, fluxes, normals, tags, boxes, size;
    /* number of groups per level, from the leaves up; the last level has one */
    uint64_t groups[ORL_MAP_LEVELS];
    uint32_t levels;
};
struct orl_map_layout orl_map_layout_of(uint64_t count);

/* Return the offset of the notes, which come last, and the size of a file with notes. */
uint64_t orl_map_notes_at(const struct orl_map_layout *layout);
uint64_t orl_map_size(const struct orl_map_layout *layout, uint64_t count, uint32_t note_bytes);

/* Returns the number of photons in a leaf: 16, except for the last one. */
static inline uint32_t orl_leaf_photons(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint64_t left = map->header->count - leaf * ORL_MAP_LEAF;
    return left < ORL_MAP_LEAF ? (uint32_t)left : ORL_MAP_LEAF;
}

static inline void orl_position_unpack(uint32_t a, uint32_t b, uint32_t ret_cell[3])
{
    ret_cell[0] = a & 0xfffffU;
    ret_cell[1] = b & 0xfffffU;
    ret_cell[2] = (a >> 24) << 12 | b >> 20;
}

#endif

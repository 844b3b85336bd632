/*
 * A photon map in memory: its words, the order of its photons (Z-order), the traversal of its
 * bounding-box hierarchy, and sums by batch of emission. The writer and the searches share it.
 */
#ifndef ORL_PHOTON_MAP_MAP_LAYOUT_H
#define ORL_PHOTON_MAP_MAP_LAYOUT_H

#include "photon/map/map.h"
#include "photon/map/quantization.h"

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

/*
 * The order of a map's photons: by the bin of their normal (quantization.h), then along the Morton
 * curve. The code of a point finds the leaf whose photons are around it, without a search of boxes.
 *
 * Threads: an index is immutable once made.
 */

enum { ORL_ZORDER_FANOUT = 8, ORL_ZORDER_LEVELS = 10, ORL_ZORDER_POSITION_BITS = 57 };

/* Spreads 20 bits to every third bit. */
static inline uint64_t orl_zorder_spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

/* Returns the code of a cell and a normal. It uses 19 of the 20 bits of each axis, to leave room
 * for the bin above them. */
static inline uint64_t orl_zorder_code(const uint32_t cell[3], uint16_t normal)
{
    return (uint64_t)orl_normal_bin(normal) << ORL_ZORDER_POSITION_BITS |
           orl_zorder_spread(cell[0] >> 1) | orl_zorder_spread(cell[1] >> 1) << 1 |
           orl_zorder_spread(cell[2] >> 1) << 2;
}

/* The first code of each leaf; above them, level by level, that of every eighth entry. */
struct orl_zorder {
    uint64_t *codes[ORL_ZORDER_LEVELS];
    uint64_t counts[ORL_ZORDER_LEVELS];
    uint32_t levels;
};

/* Returns 0 or ORL_ERR_NOMEM. */
int orl_zorder_init(struct orl_zorder *order, const struct orl_photon_map *map);
void orl_zorder_done(struct orl_zorder *order); /* a struct that is all zero is allowed */

/* Returns the last leaf whose first code is not greater than `code`, or the first leaf if there
 * is none. The map must have photons. */
uint64_t orl_zorder_find(const struct orl_zorder *order, uint64_t code);

/* Traversal of a photon map's bounding-box hierarchy, shared by the searches. */

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

/*
 * Sums of photons by the batch in which they were emitted. Every batch has its own random sequence
 * (emit.h). So quantities that are linear in the photons are sums of 16 independent samples. The
 * spread of the samples gives the variance without a further search.
 *
 * If an estimate's radius depends on its photons, the parts are samples given that radius: a fixed
 * number of photons is distributed over the batches, and the spread is that of this number of
 * photons.
 */

struct orl_batches {
    double luma[ORL_MAP_BATCHES]; /* the parts; their sum is the luma of the whole */
};

/* Returns the variance of the sum of the parts. */
static inline double orl_batches_variance(const struct orl_batches *batches)
{
    static const double n = ORL_MAP_BATCHES;
    double mean = 0, square = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        mean += batches->luma[i] / n;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        square += (batches->luma[i] - mean) * (batches->luma[i] - mean);
    return square * n / (n - 1);
}

/* Returns the third cumulant of the sum of the parts. */
double orl_batches_third_cumulant(const struct orl_batches *batches);

static inline void orl_batches_add(struct orl_batches *sum, const struct orl_batches *more,
                                   double factor)
{
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum->luma[i] += more->luma[i] * factor;
}

/*
 * Returns the part of a difference of two estimates from the same photons that exceeds its scatter;
 * 0 if the difference is within its scatter (positive-part James-Stein shrinkage).
 */
double orl_batches_shrink(const struct orl_batches *difference);

/* Convert the parts to and from 8 bits: 255ths of the largest part. Unpacking scales them to the
 * sum luma. */
void orl_batches_pack(const struct orl_batches *batches, uint8_t ret_shares[ORL_MAP_BATCHES]);
struct orl_batches orl_batches_unpack(const uint8_t shares[ORL_MAP_BATCHES], double luma);

/* Returns the batch of a photon of a map. */
static inline uint32_t orl_photon_batch(const struct orl_photon_map *map, uint32_t index)
{
    const uint32_t *leaf = map->places + (size_t)(index / ORL_MAP_LEAF) * ORL_LEAF_WORDS;
    return leaf[index % ORL_MAP_LEAF] >> 20 & (ORL_MAP_BATCHES - 1);
}

#endif

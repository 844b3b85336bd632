/*
 * Photon maps: built once, written to a file, mapped from it and searched in place.
 *
 * File, little-endian, one block after another at 64-byte boundaries:
 *   header   see struct orl_map_header
 *   places   per leaf of 16 photons: 16 words a, then 16 words b (128 bytes)
 *            a = x | batch << 20 | (z >> 12) << 24, b = y | (z & 0xfff) << 20
 *            x, y, z: 20 bits each, cells of header.cell from header.low
 *   fluxes   per photon: shared-exponent RGB (9-9-9-5) in units of header.flux_unit
 *   normals  per photon: octahedral, 8 + 8 bits, the side that was lit
 *   tags     per photon: its class; for precomputed records (precomputed_irradiance.h) the
 *            clear radius
 *   boxes    per group of 8 siblings, from the leaves up: 6 x 8 floats, lows then highs, and
 *            8 masks of the bins (quantization.h) of the normals inside
 *   notes    header.note_bytes per photon: notes of precomputed records; else none
 *
 * A photon takes 16 bytes, and about 2 for the boxes. Photons are sorted by the bin of their
 * normal, then in Morton order, so that a leaf is a patch of one sheet of surface. Ties are sorted
 * by a hash of their words. So the file is a function of the set of photons, not of their order: a
 * map that is extended (write_map.h) equals one made at once. The batch (emission index mod 16) is
 * for error estimates. The cell size is the scene's radius times a power of two, as small as the
 * map's bounds allow: 0.1 to 0.2 mm for 100 m.
 *
 * Threads: a map is immutable and may be searched from any thread.
 */
#ifndef ORL_PHOTON_MAP_MAP_H
#define ORL_PHOTON_MAP_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>

enum {
    ORL_MAP_VERSION = 7,
    ORL_MAP_LEAF = 16,    /* photons in a leaf */
    ORL_MAP_FANOUT = 8,   /* children of a node */
    ORL_MAP_LEVELS = 12,  /* maximum number of levels: 16 * 8^11 photons */
    ORL_MAP_BATCHES = 16, /* number of values of the batch index */
    ORL_MAP_CHECKSUM = 16,
    ORL_MAP_MOST_NOTE_BYTES = 64, /* maximum bytes of notes per photon */
    ORL_MAP_FAMILY = 72,          /* enough for a digest in hexadecimal */
};

/*
 * The path class of a global photon, by which other technique finds its light. Maps that are viewed
 * directly hold the first class only (omit.counted_light of light/lit_scene.h).
 */
enum orl_photon_class {
    /* indirect: all but the two below; from skies and glow, or after a diffuse reflection */
    ORL_PHOTON_INDIRECT,
    ORL_PHOTON_DIRECT, /* direct: undeflected from a sun or lamp, which shadow rays find */
    /* caustic: from a sun or lamp, deflected, at its first diffuse surface */
    ORL_PHOTON_CAUSTIC,
    ORL_PHOTON_CLASSES
};

/* A photon as it is traced, before it is packed. */
struct orl_photon {
    float position[3]; /* moved coordinates */
    float flux[3];     /* W, before the division by the number emitted */
    uint16_t normal;   /* orl_normal_encode of the lit side (quantization.h) */
    uint8_t batch;
    uint8_t tag;    /* an orl_photon_class; for records see precomputed_irradiance.h */
    uint32_t facet; /* the facet that it landed on; not stored in maps */
};

/* Returns the luma of a photon's flux. */
static inline double orl_photon_luma(const struct orl_photon *p)
{
    return orl_luma((struct orl_rgb){p->flux[0], p->flux[1], p->flux[2]});
}

struct orl_map_header {
    char magic[8]; /* "ORIELPM" and NUL */
    uint32_t version;
    uint32_t byte_order; /* 0x01020304 in the writer's byte order */
    uint64_t count;      /* photons */
    uint64_t emitted;    /* number of emissions; fluxes are divided by it */
    uint64_t target;     /* requested number of photons; 0: not a matter of counts */
    double low[3], cell; /* corner of cell (0,0,0); edge of a cell */
    double flux_unit;    /* W, after the division by emitted */
    /* W, after the division by emitted: mean of the photons' brightest channels */
    double flux_mean;
    uint64_t places, fluxes, normals, tags, boxes, size; /* byte offsets; size of the file */
    uint32_t levels;
    uint32_t note_bytes;
    int32_t flux_exponent; /* exponent of the unit before the division (quantization.h) */
    uint32_t reserved;     /* 0 */
    char kind[16];
    /* digest shared by maps that differ in the target only (run.h); "": none */
    char family[ORL_MAP_FAMILY];
    /* base/io/checked_file.h: checksum of all bytes after the header */
    unsigned char body_checksum[ORL_MAP_CHECKSUM];
    unsigned char header_checksum[ORL_MAP_CHECKSUM]; /* checksum of all bytes before this field */
};

struct orl_photon_map;

/* Parameters of a build, apart from the photons. */
struct orl_map_build {
    const char *kind;
    const char *family; /* NULL: none */
    uint64_t target;
    /* number of emissions for all photons, with those of the earlier map */
    uint64_t emitted;
    uint64_t seed; /* seed of the dither that keeps mean fluxes exact */
    double extent; /* the scene's radius; 0: as if 1 */
    /* map of the same family with the photons emitted first, which are all included; NULL: none */
    const struct orl_photon_map *earlier;
    const void *notes; /* note_bytes per photon, in the photons' order; NULL: none */
    uint32_t note_bytes;
    /* frees the photons' memory (from malloc) page by page while they are packed; the caller
     * must not read it any more, only free it */
    bool free_photons;
};

/*
 * Packs and sorts the photons, together with those of the earlier map, and writes the file without
 * syncing it. The photons must be in the order of emission, because the dither of fluxes depends on
 * it. Takes at most 50 bytes a photon, with the file, in addition to the photons' 32 bytes; with
 * free_photons the 50 include those.
 */
int orl_photon_map_write(const char *path, const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_thread_pool *pool,
                         struct orl_error *err);

/* Builds the map that orl_photon_map_write writes, in memory that belongs to the map. */
int orl_photon_map_build(const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_thread_pool *pool,
                         struct orl_photon_map **ret_map, struct orl_error *err);

/*
 * Map a file. Header and sizes are always checked, so that a damaged file can at worst give wrong
 * numbers. Verification checks the whole body: it reads it once (6 ms for two million photons in
 * memory) and keeps little of a large file in memory.
 * orl_photon_map_read verifies, and polls cancel meanwhile; orl_photon_map_open verifies if asked.
 * Return 0 or ORL_ERR_IO, _CORRUPT, _VERSION, _NOMEM, and orl_photon_map_read also _CANCELLED.
 */
int orl_photon_map_read(const char *path, const atomic_bool *cancel,
                        struct orl_photon_map **ret_map, struct orl_error *err);
int orl_photon_map_open(const char *path, bool verify, struct orl_photon_map **ret_map,
                        struct orl_error *err);
void orl_photon_map_free(struct orl_photon_map *map); /* NULL is allowed */

const struct orl_map_header *orl_photon_map_header(const struct orl_photon_map *map);

/* Returns a photon's note, of header.note_bytes; NULL in a map without notes. */
const void *orl_photon_map_note(const struct orl_photon_map *map, size_t index);

/* Returns a photon, unpacked, for tests and tools: index < count. */
struct orl_photon orl_photon_map_get(const struct orl_photon_map *map, size_t index);

#endif

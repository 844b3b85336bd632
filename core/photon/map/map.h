/*
 * Photon maps: built once, written to a file, mapped from it and searched in place.
 *
 * File, little-endian, one block after another at 64-byte boundaries:
 *   header    see struct orl_map_header
 *   places    per leaf of 16 photons: 16 words a, then 16 words b (128 bytes)
 *               a = x | batch << 20 | (z >> 12) << 24,  b = y | (z & 0xfff) << 20
 *             x, y, z: 20 bits each, cells of header.cell from header.low
 *   fluxes    per photon: shared-exponent RGB (9-9-9-5) in units of header.flux_unit
 *   normals   per photon: octahedral, 8 + 8 bits, the side that was lit
 *   tags      per photon: its class; of a precomputed record its clear radius (records.h)
 *   boxes     per group of 8 siblings, from the leaves up: 6 x 8 floats, lows then highs, and
 *               8 masks of the bins (facing.h) that the normals inside fall into
 *   notes     header.note_bytes per photon: what precomputed records add (records.h); else none
 *
 * 16 bytes a photon, and about 2 for the boxes. Photons are ordered by the bin of their normal,
 * then in Morton order, so that a leaf is a patch of one sheet of surface; among ties a hash of
 * their words decides, so that the file depends on which photons there are, not on how they came
 * together: a map that is topped up (map_encode.h) is the same file as one made at once. The batch
 * (emission index mod 16) is for error estimates. Cells are the scene's radius times a power of
 * two, as small as the map's own bounds allow: over 100 m between 0.1 and 0.2 mm.
 *
 * Threads: a map is immutable and may be searched from any thread.
 */
#ifndef ORL_PHOTON_MAP_MAP_H
#define ORL_PHOTON_MAP_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/crew.h>
#include <oriel/error.h>
#include <oriel/vec.h>

enum {
    ORL_MAP_VERSION = 7,
    ORL_MAP_LEAF = 16,    /* photons a leaf */
    ORL_MAP_FANOUT = 8,   /* children a node */
    ORL_MAP_LEVELS = 12,  /* most levels: 16 * 8^11 photons */
    ORL_MAP_BATCHES = 16, /* values of the batch index */
    ORL_MAP_CHECKSUM = 16,
    ORL_MAP_MOST_NOTED = 64, /* bytes a photon */
    ORL_MAP_FAMILY = 72,     /* room for a digest in hexadecimal */
};

/*
 * By what else a photon's light may be found: each global photon is of one class. Maps that are
 * seen directly hold the first alone (omit.counted_light of light/world.h).
 */
enum orl_photon_class {
    ORL_PHOTON_REST,  /* all but the two below: of skies and glow, or after a diffuse reflection */
    ORL_PHOTON_LIGHT, /* undeflected from a sun or lamp: what shadow rays see */
    ORL_PHOTON_CAUSTIC, /* at its first diffuse surface, deflected, from a sun or lamp */
    ORL_PHOTON_CLASSES
};

/* A photon as it is traced, before it is packed. */
struct orl_photon {
    float position[3]; /* moved coordinates */
    float flux[3];     /* W, before the division by the number emitted */
    uint16_t normal;   /* orl_normal_encode of the lit side (facing.h) */
    uint8_t batch;
    uint8_t tag;    /* an orl_photon_class, or of a record see records.h */
    uint32_t facet; /* it landed on; not kept in maps */
};

struct orl_map_header {
    char magic[8]; /* "ORIELPM" and NUL */
    uint32_t version;
    uint32_t byte_order; /* 0x01020304 as written */
    uint64_t count;      /* photons */
    uint64_t emitted;    /* paths started; fluxes are divided by it */
    uint64_t target;     /* photons asked for; 0: not a matter of counts */
    double low[3], cell; /* place of cell (0,0,0)'s corner; edge of a cell */
    double flux_unit;    /* W, the division by emitted included */
    double flux_mean;    /* W, likewise: of the photons' brightest channels */
    uint64_t places, fluxes, normals, tags, boxes, size; /* byte offsets; size of the file */
    uint32_t levels;
    uint32_t note_bytes;
    int32_t flux_exponent; /* of the unit, before the division (flux.h) */
    uint32_t reserved;     /* 0 */
    char kind[16];
    char family[ORL_MAP_FAMILY]; /* whose maps differ in the target alone (run.h); "": none */
    unsigned char body_checksum[ORL_MAP_CHECKSUM];   /* base/checksum.h: of all after the header */
    unsigned char header_checksum[ORL_MAP_CHECKSUM]; /* of all before this field */
};

struct orl_photon_map;

/* What a build needs to know beside the photons. */
struct orl_map_build {
    const char *kind;
    const char *family; /* NULL: none */
    uint64_t target;
    uint64_t emitted;                     /* by all photons, the earlier map's among them */
    uint64_t seed;                        /* of the dither that keeps mean fluxes exact */
    double extent;                        /* of the scene: its radius. 0: as if 1 */
    const struct orl_photon_map *earlier; /* of the same family, with the photons emitted first; all
                                             of them are taken over. NULL: none */
    const void *notes; /* note_bytes per photon, in the photons' order; NULL: none */
    uint32_t note_bytes;
    bool spend; /* the photons' memory, from malloc, is let go while they are packed: they are not
                   to be read again, only freed */
};

/*
 * Packs and sorts the photons, with those of the earlier map, and writes the file, not synced. They
 * must be in the order of emission, as the dither of fluxes goes by it. Takes 50 bytes a photon
 * at most, the file included, beside the photons' 32; with spend they are among the 50.
 */
int orl_photon_map_write(const char *path, const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_crew *crew,
                         struct orl_error *err);

/* The same, in memory: it goes with the map. */
int orl_photon_map_make(const struct orl_photon *photons, size_t count,
                        const struct orl_map_build *build, struct orl_crew *crew,
                        struct orl_photon_map **ret_map, struct orl_error *err);

/*
 * Maps a file. Header and sizes are always checked, so that a damaged file can give wrong numbers
 * at worst; with verify the whole body is, too, which takes the time of reading it once (6 ms for
 * two million photons that are in memory) and keeps little of a large one there.
 * ORL_ERR_IO, _CORRUPT, _VERSION, _NOMEM.
 */
/* Opens and verifies; cancel is polled meanwhile: ORL_ERR_CANCELLED. */
int orl_photon_map_read(const char *path, const atomic_bool *cancel,
                        struct orl_photon_map **ret_map, struct orl_error *err);
int orl_photon_map_open(const char *path, bool verify, struct orl_photon_map **ret_map,
                        struct orl_error *err);
void orl_photon_map_free(struct orl_photon_map *map); /* NULL is allowed */

const struct orl_map_header *orl_photon_map_header(const struct orl_photon_map *map);

/* A photon's note, of header.note_bytes; NULL in a map without notes. */
const void *orl_photon_map_note(const struct orl_photon_map *map, size_t index);

/* The first photon's place, flux and so on, for tests and tools: index < count. */
struct orl_photon orl_photon_map_get(const struct orl_photon_map *map, size_t index);

#endif

/*
 * The steps of writing a map: encoding of photons as words, and sorting of the words. Photons of an
 * earlier, smaller map come first, if there is one.
 *
 * A photon's words depend on the photon, its index in the order of emission, and two sizes that fit
 * all photons of the map: the edge of a cell and the step of the faintest flux. Both are powers of
 * two times a unit of the scene, and only grow as photons are added. Cells begin at multiples of
 * their edge. Bits for which a larger size has no room are truncated, never rounded. So a word
 * packed for few photons and coarsened for many equals the word packed for many. A map that is
 * extended equals a map made at once.
 *
 * Positions must be finite. Borrows photons and map. Threads: immutable once set up; any thread may
 * compute words.
 */
#ifndef ORL_PHOTON_MAP_WRITE_MAP_H
#define ORL_PHOTON_MAP_WRITE_MAP_H

#include <oriel/base/thread_pool.h>

#include "photon/map/map_layout.h"

struct orl_map_encoder {
    const struct orl_photon_map *earlier; /* or NULL */
    const struct orl_photon *photons;     /* the new photons, in order of emission */
    size_t n_earlier, count;              /* numbers of photons: of the earlier map, and of all */
    /* seed of the dither of fluxes, which depends on the order of emission */
    uint64_t seed;
    double unit;  /* unit of positions: the scene's radius */
    double steps; /* 1 / step: exact, as it is a power of two */
    /* step: edge of a cell in units, a power of two; first: cells from the origin to the first
     * cell */
    double step, first[3];
    double low[3], cell; /* both in m, as in struct orl_map_header */
    int flux_exponent;
};

/* The words that a map stores for one photon (map.h has the format). */
struct orl_photon_words {
    uint32_t a, b; /* position and batch */
    uint32_t flux;
    uint16_t normal, tag;
};

/*
 * Sets up the encoding of earlier's photons and n more. extent: the scene's radius, or 0 for 1.
 * Cells are powers of two times it, not below 2^-32, so that they scale with the scene. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_map_encode_init(struct orl_map_encoder *encoder, const struct orl_photon_map *earlier,
                        const struct orl_photon *photons, size_t n, uint64_t seed, double extent,
                        struct orl_thread_pool *pool);

/* Compute a photon's cell or words. Indices below n_earlier are the earlier map's photons, in that
 * map's order. */
void orl_map_encode_cell(const struct orl_map_encoder *encoder, size_t index, uint32_t ret_cell[3]);
struct orl_photon_words orl_map_encode_words(const struct orl_map_encoder *encoder, size_t index);

/*
 * Encodes as orl_map_encode_words does, for ORL_ENCODED_AT_ONCE consecutive new photons. Requires
 * cells that are not too far from the origin (orl_map_encode_is_near).
 */
enum { ORL_ENCODED_AT_ONCE = 64 };
bool orl_map_encode_is_near(const struct orl_map_encoder *encoder);
void orl_map_encode_words_many(const struct orl_map_encoder *encoder, size_t first,
                               struct orl_photon_words ret_words[ORL_ENCODED_AT_ONCE]);

/*
 * Sorting of photons into the order of the map file: by code, and for equal codes by a hash of
 * their words. The order depends only on the set of photons, not on the number of threads.
 */

struct orl_sort_item {
    uint64_t code;  /* orl_zorder_code (map_layout.h) */
    uint32_t index; /* index of the photon's words */
};

/* Sorts items in place. Returns 0, ORL_ERR_NOMEM or an error of orl_parallel_try. */
int orl_sort_photons(struct orl_sort_item *items, size_t count,
                     const struct orl_photon_words *words, struct orl_thread_pool *pool);

#endif

/*
 * Photons in the words of a map: those of an earlier, smaller map, if there is one, then new ones.
 *
 * What a photon becomes depends on the photon, its number in the order of emission, and two sizes
 * that fit all photons of the map: the edge of a cell and the step of the faintest flux. Both are
 * powers of two, of a unit that is the scene's, and only grow as photons are added; cells begin at
 * multiples of their edge, and bits that a greater size leaves no room for are cut off, never
 * rounded. So a word packed for few
 * photons and coarsened for many is the word that packing for many gives, and a map that is topped
 * up holds what it would hold if it had been made at once.
 *
 * Places must be finite. Borrows photons and map. Threads: immutable once set up; words from any
 * thread.
 */
#ifndef ORL_PHOTON_MAP_MAP_ENCODE_H
#define ORL_PHOTON_MAP_MAP_ENCODE_H

#include <oriel/crew.h>

#include "photon/map/map_layout.h"

struct orl_map_encoder {
    const struct orl_photon_map *earlier; /* or NULL */
    const struct orl_photon *photons;     /* those that come after, in order of emission */
    size_t n_earlier, count;              /* count: of all */
    uint64_t seed;                        /* of the dither of fluxes, by order of emission */
    double unit;                          /* of places: the scene's radius */
    double steps;                         /* in a unit: exact, as powers of two are */
    double step, first[3]; /* edge of a cell, in units, a power of two; edges from the origin to the
                              first cell */
    double low[3], cell;   /* of both: as in struct orl_map_header */
    int flux_exponent;
};

/* What a map keeps of one photon; map.h says how. */
struct orl_photon_words {
    uint32_t a, b; /* place and batch */
    uint32_t flux;
    uint16_t normal, tag;
};

/*
 * Sets up the packing of earlier's photons and n more. extent: the scene's radius, or 0 for 1;
 * cells are powers of two of it, no smaller than 2^-32, so that they scale with the scene.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_map_encode_init(struct orl_map_encoder *packing, const struct orl_photon_map *earlier,
                        const struct orl_photon *photons, size_t n, uint64_t seed, double extent,
                        struct orl_crew *crew);

/* The earlier map's photons have the indices below n_earlier, in the order they have there. */
void orl_map_encode_cell(const struct orl_map_encoder *packing, size_t index, uint32_t ret_cell[3]);
uint16_t orl_map_encode_normal(const struct orl_map_encoder *packing, size_t index);
struct orl_photon_words orl_map_encode_words(const struct orl_map_encoder *packing, size_t index);

/*
 * The same of so many new photons that follow one another; where cells are not too far from the
 * origin for it (orl_map_encode_is_near).
 */
enum { ORL_PACKED_AT_ONCE = 64 };
bool orl_map_encode_is_near(const struct orl_map_encoder *packing);
void orl_map_encode_words_many(const struct orl_map_encoder *packing, size_t first,
                               struct orl_photon_words ret_words[ORL_PACKED_AT_ONCE]);

#endif

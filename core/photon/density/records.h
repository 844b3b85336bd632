/*
 * Irradiance precomputed at a fraction of the photons: the map of kind "precomputed". It is made
 * from a global map, once, and read instead of it.
 *
 * A record is a photon in all but meaning: its place, the normal of the lit side, and as flux the
 * irradiance there, W/m2, times the number emitted, so that a map's unpacked "flux" is irradiance.
 * The estimate is that of adaptive_density.h, from a map without photons of the light that shadow
 * rays and the caustic map count (omit.counted_light). There is one record for every 32 photons,
 * amid a leaf (leaf_center.h) and on the surface itself; or for 64 or 128 where they lie together
 * on one plane and within a disc of some 2048 photons over which light was found to be even: there
 * it hardly differs between records, which share most of their photons. Its tag says how far no
 * wall stands about it (orl_record_clear); its note, what the batches of emission hold of it
 * (batches.h) and what its bias is thought to be.
 *
 * A look-up fits a plane to the nearest records of the same sheet that nothing stands in front of,
 * with weights that fall to zero, with their slope, at the distance of the first one not used: as
 * records come and go nothing steps. A plane, and not a mean: records are as dense as photons, and
 * a mean would lean to the bright side.
 *
 * Determinism: which records there are and what is in them depends on the global map and the scene.
 * Threads: making is by a crew; look-ups are from any thread.
 * References: Christensen 1999, Journal of Graphics Tools 4 (precomputed irradiance); Fan and
 * Gijbels 1996, chapter 3 (local linear fits).
 */
#ifndef ORL_PHOTON_DENSITY_RECORDS_H
#define ORL_PHOTON_DENSITY_RECORDS_H

#include <stdatomic.h>

#include <oriel/crew.h>

#include "photon/density/search.h"

struct orl_records_making {
    const struct orl_photon_map *global;
    const struct orl_world *world;
    struct orl_crew *crew;
    struct orl_search *searches; /* one per crew member */
    atomic_bool *cancel;
    void (*progress)(void *ctx, double fraction);
    void *ctx;
};

/* Of a record, in the map file. */
struct orl_record_note {
    float unit; /* of the estimate's luma, as are these: */
    float bias;
    int8_t off[ORL_MAP_BATCHES]; /* a batch's part less the mean one, in units */
    uint32_t few;                /* 1: there were few photons within the estimate's reach */
};

struct orl_records {
    struct orl_photon *photons;
    struct orl_record_note *notes;
    size_t count;
};
void orl_records_done(struct orl_records *records); /* also of ones that are all zero */

/*
 * Makes the records, to be written with orl_photon_map_write and the global map's number emitted.
 * Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM.
 */
int orl_records_make(const struct orl_records_making *making, struct orl_records *ret_records,
                     struct orl_error *err);

/* Within this distance of a record no wall stands: from its tag. */
double orl_record_clear(const struct orl_world *world, uint32_t tag);

/*
 * Irradiance at a point of a surface, with its parts and standard error; found is 1, or 0 when no
 * record within max_radius serves the point.
 */
struct orl_density orl_records_estimate(const struct orl_photon_map *records,
                                        const struct orl_footing *footing, double max_radius,
                                        struct orl_search *search);

/*
 * The same by the few that are nearest, whatever stands in between: for rays of a hemisphere, which
 * themselves are averaged.
 */
struct orl_density orl_records_glance(const struct orl_photon_map *records,
                                      const struct orl_footing *footing, double max_radius,
                                      struct orl_search *search);

#endif

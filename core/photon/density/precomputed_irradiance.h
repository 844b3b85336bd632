/*
 * Irradiance precomputed at a fraction of the photons: the map of kind "precomputed". It is made
 * once from a global map, and read instead of it.
 *
 * A record is stored as a photon with its position and the normal of the lit side. Its flux is the
 * irradiance there, W/m2, times the number emitted, so that a map's unpacked "flux" is irradiance.
 * The estimate is that of adaptive_density.h, from a map without photons of the light that shadow
 * rays and the caustic map count (omit.counted_light).
 *
 * There is one record for every 32 photons, at the centre of a leaf (leaf_sites.h) and on the
 * surface itself. One record serves 64 or 128 photons if they lie on one plane, within a disc of
 * about 2048 photons over which light is even. There the estimate hardly differs between records,
 * because they share most of their photons. The tag codes the distance within which there is no
 * wall (clearance_of_tag). The note holds the parts of the emission batches (map_layout.h) and the
 * estimated bias.
 *
 * A look-up fits a plane to the nearest records of the same sheet that are not occluded. Weights
 * fall to zero, with zero slope, at the distance of the first record not used. So the result has no
 * steps as records enter and leave. A plane is used instead of a mean because records are as dense
 * as photons, so a mean would be biased to the bright side.
 *
 * Determinism: the records depend only on the global map and the scene. Threads: records are made
 * by a thread pool; look-ups may run in any thread.
 * References: Christensen 1999, Journal of Graphics Tools 4 (precomputed irradiance); Fan and
 * Gijbels 1996, chapter 3 (local linear fits).
 */
#ifndef ORL_PHOTON_DENSITY_PRECOMPUTED_IRRADIANCE_H
#define ORL_PHOTON_DENSITY_PRECOMPUTED_IRRADIANCE_H

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>

#include "photon/density/density_estimate.h"

struct orl_precomputed_build_args {
    const struct orl_photon_map *global;
    const struct orl_lit_scene *lit_scene;
    struct orl_thread_pool *pool;
    struct orl_search *searches; /* one per thread of the pool */
    atomic_bool *cancel;
    void (*progress)(void *ctx, double fraction);
    void *ctx;
};

/* Note of a record in the map file. */
struct orl_precomputed_note {
    float unit; /* unit of off; unit and bias are shares of the estimate's luma */
    float bias;
    int8_t off[ORL_MAP_BATCHES]; /* a batch's part minus the mean part, in units */
    uint32_t sparse;             /* 1: there were few photons within the estimate's radius */
};

struct orl_precomputed {
    struct orl_photon *photons;
    struct orl_precomputed_note *notes;
    size_t count;
};
void orl_precomputed_done(
    struct orl_precomputed *records); /* a struct that is all zero is allowed */

/*
 * Makes the records, to be written with orl_photon_map_write and the global map's number emitted.
 * Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM.
 */
int orl_precomputed_build(const struct orl_precomputed_build_args *args,
                          struct orl_precomputed *ret_records, struct orl_error *err);

/*
 * Returns the irradiance at a point of a surface, with its parts and standard error. found is 1, or
 * 0 if no record within max_radius can be used.
 */
struct orl_density orl_precomputed_estimate(const struct orl_photon_map *records,
                                            const struct orl_surface_point *surface_point,
                                            double max_radius, struct orl_search *search);

/*
 * Estimates irradiance as orl_precomputed_estimate does, but from the mean of the few nearest
 * records without an occlusion test: for rays of a hemisphere, which are averaged themselves.
 */
struct orl_density orl_precomputed_mean(const struct orl_photon_map *records,
                                        const struct orl_surface_point *surface_point,
                                        double max_radius, struct orl_search *search);

#endif

/*
 * Numerical health counters of a job: events that lose data, and totals for comparison. No event
 * stops the job; dropped data are missing from its results.
 *
 * Each part of the work (a thread, or a batch of photons) counts into its own struct, and the parts
 * are added up at the end: no atomics, no globals. Counts are the same for any number of threads.
 * They cover this run only; photons of a map that was found ready were counted when it was built.
 */
#ifndef ORIEL_BASE_HEALTH_H
#define ORIEL_BASE_HEALTH_H

#include <stdint.h>

#include <oriel/base/vec.h>

struct orl_health {
    /* Events that lose data. */
    uint64_t non_finite;     /* values that were NaN or infinite, and were dropped */
    uint64_t bsdf_clamped;   /* negative values of BSDF files, read as zero */
    uint64_t bsdf_rescaled;  /* BSDFs whose values were scaled down to conserve energy */
    uint64_t degenerate;     /* surfaces without area, dropped */
    uint64_t photons_capped; /* photons ended by the bounce limit */
    uint64_t paths_capped;   /* paths from sensors, views and ports ended by the bounce limit */
    uint64_t rays_leaked;    /* rays that left a sealed scene without passing a window */
    uint64_t sparse;         /* density estimates from fewer than 8 photons */
    /* Totals for comparison. */
    uint64_t bsdf_values; /* values of BSDF files */
    uint64_t surfaces;    /* surfaces of the scene, dropped ones included */
    uint64_t instances; /* instances that share one copy of their geometry; coincident surfaces are
                           not searched between them */
    uint64_t photons;   /* photons traced: emissions with a result */
    uint64_t paths;     /* paths from sensors, views and ports */
    uint64_t rays;      /* segments of photons and paths; shadow rays are not counted */
    uint64_t estimates; /* density estimates that found any photon */
    double flux_w;      /* luma flux of the photons traced */
    double flux_capped_w; /* luma flux of the photons ended by the bounce limit */
    /* First leak of a photon: ray origin and direction. A zero direction: no leak. In a result the
     * origin is in the files' coordinates. */
    struct orl_vec3 leak_from, leak_towards;
};

/* Adds part to sum; the first leak in sum stays. */
void orl_health_add(struct orl_health *sum, const struct orl_health *part);

/* Returns the colour if it is finite; otherwise counts it and returns black. */
static inline struct orl_rgb orl_health_filter(struct orl_health *health, struct orl_rgb color)
{
    if (orl_rgb_is_finite(color))
        return color;
    health->non_finite++;
    return orl_gray(0);
}

#endif

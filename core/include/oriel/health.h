/*
 * Numerical health: what went wrong while a job ran, counted, beside the totals that say how much
 * that is. Nothing here stops a job; what was dropped is missing from its results.
 *
 * A part of the work counts into a struct of its own (one per thread, or per batch of photons), and
 * the parts are added up at the end: no atomics, nothing global. Counts are the same for any number
 * of threads. They are of this run: photons of a map that was found ready were counted when it was
 * built.
 */
#ifndef ORIEL_HEALTH_H
#define ORIEL_HEALTH_H

#include <stdint.h>

#include <oriel/vec.h>

struct orl_health {
    /* What went wrong. */
    uint64_t non_finite;     /* values that were no finite number, and were left out */
    uint64_t bsdf_clamped;   /* values of BSDF files below zero: read as zero */
    uint64_t bsdf_rescaled;  /* BSDFs with values scaled down, lest energy be gained */
    uint64_t degenerate;     /* surfaces without area: dropped */
    uint64_t photons_capped; /* photons given up at the bounce limit */
    uint64_t paths_capped;   /* paths from sensors, views and ports, likewise */
    uint64_t rays_leaked;    /* rays that left a sealed scene without passing a window */
    uint64_t sparse;         /* density estimates from fewer than 8 photons */
    /* What that is to be judged against. */
    uint64_t bsdf_values; /* values of BSDF files */
    uint64_t surfaces;    /* of the scene, the dropped ones included */
    uint64_t instances; /* in places where they are kept once: whether surfaces of theirs lie in one
                           place with others is not looked at */
    uint64_t photons;   /* photons traced: emissions that came to something */
    uint64_t paths;     /* paths from sensors, views and ports */
    uint64_t rays;      /* segments of photons and paths; shadow rays are not counted */
    uint64_t estimates; /* density estimates that found any photon */
    double flux_w;      /* of the photons traced: luma */
    double flux_capped_w; /* of those given up */
    /* The first of the photons' leaks: where the ray set out, and its direction. A zero direction:
     * none leaked. In a result the place is in the files' coordinates. */
    struct orl_vec3 leak_from, leak_towards;
};

/* Adds part to sum; the first leak stays. */
void orl_health_add(struct orl_health *sum, const struct orl_health *part);

/* The colour when it is finite; otherwise black, and counted. */
static inline struct orl_rgb orl_health_keep(struct orl_health *health, struct orl_rgb color)
{
    if (orl_rgb_is_finite(color))
        return color;
    health->non_finite++;
    return orl_gray(0);
}

#endif

/*
 * Checks of numbers: of points and directions that users give, and of values while a job runs (its
 * numerical health).
 *
 * Points and directions are those of sensors, viewpoints, eyes and views. All readers of documents,
 * files and options use these, so that the same numbers are refused everywhere.
 */
#ifndef ORIEL_BASE_INPUT_CHECKS_H
#define ORIEL_BASE_INPUT_CHECKS_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Checks that each coordinate is finite and at most ORL_LIMIT_DISTANCE in magnitude. what: "sensor
 * 3", for the message. Returns 0 or ORL_ERR_RANGE. */
int orl_check_point(struct orl_vec3 point, const char *what, struct orl_error *err);

/* Same as orl_check_point, and also rejects a direction whose length is zero or too small for a
 * unit vector. */
int orl_check_direction(struct orl_vec3 direction, const char *what, struct orl_error *err);

/* Named point that results are reported for. */

struct orl_named_point {
    char *name; /* owned */
    struct orl_vec3 at;
};

/* Checks each point with orl_check_point. Returns 0 or ORL_ERR_RANGE, with the point's name. */
int orl_named_points_check(const struct orl_named_point *points, size_t n, struct orl_error *err);

static inline void orl_named_points_free(struct orl_named_point *points, size_t n)
{
    for (size_t i = 0; points && i < n; i++)
        free(points[i].name);
    free(points);
}

/*
 * Numerical health counters of a job: events that lose data, and totals for comparison. No event
 * stops the job; dropped data are missing from its results.
 *
 * Each part of the work (a thread, or a batch of photons) counts into its own struct, and the parts
 * are added up at the end: no atomics, no globals. Counts are the same for any number of threads.
 * They cover this run only; photons of a map that was found ready were counted when it was built.
 */

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

/*
 * Discs in which photons in flight are counted, around sensors in free space where no photon lands.
 * Photons carry flux. So the flux through a disc on its lit side, divided by the disc's area, is
 * the irradiance there, whatever the photons' paths.
 *
 * A disc ends where an object stands on its plane. Its reach is stored by sectors; crossings beyond
 * the reach are not counted, nor is that area. Photons whose light another estimator counts are not
 * counted here (is_unsampled in trace.c): suns by their images in flat mirrors, or by one pane's
 * lobes.
 *
 * The hierarchy is immutable once made, and any thread may query it. It borrows the discs.
 */
#ifndef ORL_PHOTON_TRACING_COUNTING_DISCS_H
#define ORL_PHOTON_TRACING_COUNTING_DISCS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/material/scatter.h"

enum { ORL_COUNTING_DISC_SECTORS = 32 };

struct orl_counting_disc {
    struct orl_vec3 center;
    struct orl_frame frame; /* n: towards the lit side */
    double radius;
    float
        /* distance of the nearest dielectric or curved mirror on its plane; INFINITY: none */
        curved_distance;
    /* squared reach by sectors, counted from frame.u; at most radius^2 */
    float reach2[ORL_COUNTING_DISC_SECTORS];
};

/* The crossing of a photon through a disc. */
struct orl_disc_crossing {
    uint32_t disc;
    float distance2; /* squared distance from the disc's center */
    float flux[3];
    uint8_t batch;
    bool lamp; /* light of a lamp, not of a sun */
};

struct orl_disc_crossings {
    struct orl_disc_crossing *crossings; /* owned by the caller, who frees it */
    size_t count, capacity;
    bool out_of_memory;
};

struct orl_counting_discs;

/* Builds the hierarchy. Returns 0 or ORL_ERR_NOMEM. */
int orl_counting_discs_new(const struct orl_counting_disc *discs, size_t count,
                           struct orl_counting_discs **ret_discs);
void orl_counting_discs_free(struct orl_counting_discs *discs); /* NULL is allowed */

/* A straight part of a photon's path, to its next hit. */
struct orl_ray_segment {
    struct orl_vec3 origin, direction;
    double distance;     /* to the hit; INFINITY: none */
    struct orl_rgb flux; /* at its origin */
    /* the spotlight's beam at the origin (orl_spotlight_falloff); focus 0: no such beam */
    double focus, lamp_distance, spread;
    bool lamp;
    uint8_t batch;
};

/* Records a crossing for every disc that the segment crosses. */
void orl_counting_discs_record(const struct orl_counting_discs *discs,
                               const struct orl_ray_segment *ray_segment,
                               struct orl_disc_crossings *crossings);

#endif

/*
 * Discs in which photons in flight are counted, around sensors in free space where no photon lands.
 * Photons carry flux. So the flux through a disc on its lit side, divided by the disc's area, is
 * the irradiance there, whatever the photons' paths.
 *
 * A disc ends where an object stands on its plane. Its reach is stored by sectors; passes beyond
 * the reach are not counted, nor is that area. Photons whose light another estimator counts are not
 * counted here (is_sought in trace.c): suns by their images in flat mirrors, or by one pane's
 * lobes.
 *
 * The hierarchy is immutable once made, and any thread may query it. It borrows the discs.
 */
#ifndef ORL_PHOTON_FLIGHT_COUNTING_DISCS_H
#define ORL_PHOTON_FLIGHT_COUNTING_DISCS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/material/scatter.h"

enum { ORL_DISC_SECTORS = 32 };

struct orl_disc {
    struct orl_vec3 center;
    struct orl_frame frame; /* n: towards the lit side */
    double radius;
    float
        /* distance of the nearest dielectric or curved mirror on its plane; INFINITY: none */
        curved;
    /* squared reach by sectors, counted from frame.u; at most radius^2 */
    float reach2[ORL_DISC_SECTORS];
};

/* The pass of a photon through a disc. */
struct orl_pass {
    uint32_t disc;
    float distance2; /* squared distance from the disc's center */
    float flux[3];
    uint8_t batch;
    bool lamp; /* light of a lamp, not of a sun */
};

struct orl_passes {
    struct orl_pass *passes; /* owned by the caller, who frees it */
    size_t count, capacity;
    bool out_of_memory;
};

struct orl_discs;

/* Builds the hierarchy. Returns 0 or ORL_ERR_NOMEM. */
int orl_discs_new(const struct orl_disc *discs, size_t count, struct orl_discs **ret_discs);
void orl_discs_free(struct orl_discs *discs); /* NULL is allowed */

/* A straight part of a photon's path, to its next hit. */
struct orl_stretch {
    struct orl_vec3 origin, direction;
    double distance;     /* to the hit; INFINITY: none */
    struct orl_rgb flux; /* at its origin */
    /* the spotlight's beam at the origin (orl_spot_spread); focus 0: no such beam */
    double focus, flown, spread;
    bool lamp;
    uint8_t batch;
};

/* Records a pass for every disc that the stretch crosses. */
void orl_discs_note(const struct orl_discs *discs, const struct orl_stretch *stretch,
                    struct orl_passes *passes);

#endif

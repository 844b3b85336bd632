/*
 * Discs that photons are counted through as they fly: about sensors in mid-air, where no photon
 * lands. What a photon carries is flux, so that what comes through a disc on its lit side, by the
 * disc's area, is the irradiance there, by whatever way it came.
 *
 * A disc ends where something stands on its plane: its reach is known by sectors, and what passes
 * beyond it is not counted, nor is that area. Photons that others count are not (is_sought of
 * trace.c): suns by their images in flat mirrors, or by one pane's lobes.
 *
 * The hierarchy is immutable once made and may be asked by any thread. It borrows the discs.
 */
#ifndef ORL_PHOTON_FLIGHT_DISCS_H
#define ORL_PHOTON_FLIGHT_DISCS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/material/scatter.h"

enum { ORL_DISC_SECTORS = 32 };

struct orl_disc {
    struct orl_vec3 center;
    struct orl_frame frame; /* n: the side that is lit */
    double radius;
    float
        curved; /* distance of the nearest dielectric or curved mirror on its plane; or INFINITY */
    float reach2[ORL_DISC_SECTORS]; /* squared: by sectors from frame.u on; no more than radius^2 */
};

/* A photon on its way through one. */
struct orl_pass {
    uint32_t disc;
    float distance2; /* from its center */
    float flux[3];
    uint8_t batch;
    bool lamp; /* of one, and of no sun */
};

struct orl_passes {
    struct orl_pass *passes; /* the caller's, to free */
    size_t count, capacity;
    bool out_of_memory;
};

struct orl_discs;

/* Returns 0 or ORL_ERR_NOMEM. */
int orl_discs_new(const struct orl_disc *discs, size_t count, struct orl_discs **ret_discs);
void orl_discs_free(struct orl_discs *discs); /* NULL is allowed */

/* A stretch of a photon's way, to what it meets. */
struct orl_stretch {
    struct orl_vec3 origin, direction;
    double distance;             /* INFINITY: it meets nothing */
    struct orl_rgb flux;         /* at its origin */
    double focus, flown, spread; /* of a spotlight's beam (orl_spot_spread): there; focus 0: none */
    bool lamp;
    uint8_t batch;
};

/* Notes every disc that it goes through. */
void orl_discs_note(const struct orl_discs *discs, const struct orl_stretch *stretch,
                    struct orl_passes *passes);

#endif

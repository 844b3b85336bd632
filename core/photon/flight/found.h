/*
 * The estimator that is responsible for a caustic photon's path (partition of path space).
 *
 * Photons that sensors count in flight (counting_discs.h) carry only light that the sensor does not
 * sample itself. A sensor samples suns by their images in flat mirrors, and by the lobes of one
 * pane.
 *
 * For backward paths (render/backward/backward.h), photons carry only light that paths find by
 * chance. Paths sample suns and lamps, with their images, from all surfaces with lobes. They hit
 * lights only by chance by way of curved or refracting surfaces, or of mirrors with more
 * orientations than there are images.
 */
#ifndef ORL_PHOTON_FLIGHT_FOUND_H
#define ORL_PHOTON_FLIGHT_FOUND_H

#include "photon/flight/emit.h"

enum orl_found_by {
    ORL_FOUND_BY_SHADOW_RAYS, /* straight so far */
    /* by mirrors of the image classes, if the image is shown; lamps by one mirror */
    ORL_FOUND_BY_IMAGES,
    /* sensors: a sun by the lobes of one pane; paths: any light by any lobes */
    ORL_FOUND_BY_LOBES,
    ORL_FOUND_BY_NOBODY,
};

#define ORL_FOUND_NO_LAMP UINT32_MAX
struct orl_found {
    enum orl_found_by by;
    int16_t image; /* the sun's image from which the photon comes; negative: none */
    bool paths;    /* true: for backward paths; false: for a sensor */
    /* light of a lamp by a mirror that has its image (light/lamp_images.h) */
    bool lamp_shown;
    uint32_t lamp; /* the lamp's facet; ORL_FOUND_NO_LAMP for a sun */
};

struct orl_found orl_found_at_first(const struct orl_world *world, const struct orl_flight *flight,
                                    bool paths);

/* Updates the state after an event at a hit, other than a straight passage. */
void orl_found_next(struct orl_found *found, const struct orl_world *world,
                    const struct orl_hit *hit, enum orl_event event);

/* Returns true if no other estimator finds the photon in its current state. */
bool orl_found_by_nobody(const struct orl_found *found, const struct orl_world *world);

#endif

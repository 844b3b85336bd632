/*
 * Who else finds the light that a caustic photon carries. Photons that are counted as they fly to
 * sensors (discs.h) bring only what the sensor does not sample by itself: it looks for suns by
 * their images in flat mirrors, and by the lobes of one pane. And of what paths against the light
 * find (render/backward/backward.h) is left what they would have to happen on: they look for suns
 * and lamps from wherever there are lobes, images included, but by way of what is curved, refracts,
 * or faces more ways than there are images for they meet a light only by chance.
 */
#ifndef ORL_PHOTON_FLIGHT_FOUND_H
#define ORL_PHOTON_FLIGHT_FOUND_H

#include "photon/flight/emit.h"

enum orl_found_by {
    ORL_FOUND_BY_SHADOW_RAYS, /* so far straight */
    ORL_FOUND_BY_IMAGES,      /* a sun, by mirrors of its images' classes; where that is shown */
    ORL_FOUND_BY_LOBES,       /* a sun, by those of one pane; by paths, any light, by any lobes */
    ORL_FOUND_BY_NOBODY,
};

#define ORL_FOUND_NO_LAMP UINT32_MAX
struct orl_found {
    enum orl_found_by by;
    int16_t image;   /* of the sun, that it comes from; less than 0: none */
    bool paths;      /* paths look for it, not a sensor */
    bool lamp_shown; /* a lamp, by a mirror that shows it (light/lamp_images.h) */
    uint32_t lamp;   /* the lamp's facet; of a sun ORL_FOUND_NO_LAMP */
};

struct orl_found orl_found_at_first(const struct orl_world *world, const struct orl_flight *flight,
                                    bool paths);

/* After something at that hit other than going straight. */
void orl_found_next(struct orl_found *found, const struct orl_world *world,
                    const struct orl_hit *hit, enum orl_event event);

/* Whether nobody else finds it as it flies now. */
bool orl_found_by_nobody(const struct orl_found *found, const struct orl_world *world);

#endif

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
#ifndef ORL_PHOTON_TRACING_PATH_OWNER_H
#define ORL_PHOTON_TRACING_PATH_OWNER_H

#include "photon/emission/emit.h"

enum orl_path_estimator {
    ORL_ESTIMATOR_SHADOW_RAYS, /* straight so far */
    /* by mirrors of the image classes, if the image is shown; lamps by one mirror */
    ORL_ESTIMATOR_VIRTUAL_LIGHTS,
    /* sensors: a sun by the lobes of one pane; paths: any light by any lobes */
    ORL_ESTIMATOR_LOBES,
    ORL_ESTIMATOR_NONE,
};

#define ORL_OWNER_NO_LAMP UINT32_MAX
struct orl_path_owner {
    enum orl_path_estimator estimator;
    int16_t image;           /* the sun's image from which the photon comes; negative: none */
    bool for_backward_paths; /* true: for backward paths; false: for a sensor */
    /* light of a lamp by a mirror that has its image (light/virtual_lamps.h) */
    bool lamp_has_image;
    uint32_t lamp; /* the lamp's facet; ORL_OWNER_NO_LAMP for a sun */
};

struct orl_path_owner orl_path_owner_init(const struct orl_lit_scene *lit_scene,
                                          const struct orl_photon_ray *photon_ray,
                                          bool for_backward_paths);

/* Updates the state after an event at a hit, other than a straight passage. */
void orl_path_owner_update(struct orl_path_owner *path_owner, const struct orl_lit_scene *lit_scene,
                           const struct orl_hit *hit, enum orl_scatter_event event);

/* Returns true if no other estimator finds the photon in its current state. */
bool orl_path_owner_is_none(const struct orl_path_owner *path_owner,
                            const struct orl_lit_scene *lit_scene);

#endif

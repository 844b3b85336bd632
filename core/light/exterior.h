/*
 * Radiance by path tracing alone, without a photon map. It traces shadow rays to suns and lamps at
 * each bounce, until the path leaves, is absorbed or ends by Russian roulette. Suns in flat mirrors
 * and panes are found by their images (virtual_suns.h). Suns that are refracted, or reflected by
 * curved mirrors, are left out. Of light that BSDF ports send outdoors after a diffuse bounce, the
 * flux is right but not the shape.
 *
 * Photon ports use it for the radiance outwards, so that every photon carries the radiance that
 * arrives, the ground's and the neighbours' included. Views, sensors and rays from inside use it
 * for outdoor surfaces. For these, rooms behind the neighbours' panes shine, too: a path that
 * enters one is handed back to the caller.
 */
#ifndef ORL_LIGHT_EXTERIOR_H
#define ORL_LIGHT_EXTERIOR_H

#include "light/eye_path.h"

/*
 * A path that has passed a port inwards. The caller adds the radiance inside, times the path's
 * weight: it knows how the inside is lit.
 */
struct orl_building_entry {
    bool entered;
    struct orl_path path; /* the path from the inner side of the port */
    struct orl_mis_pdf chance;
};

/*
 * Returns one estimate of the radiance that arrives at origin from direction, without suns seen
 * straight.
 *
 * ret_entry: set to the path if it enters a building. NULL: paths do not pass ports, and light that
 * has passed one is left out, because ports emit first light only (light/lit_scene.h). Lamps seen
 * straight or through panes are weighted by `chance` (MIS). Counts rays and paths in health. With
 * omit.exterior surfaces reflect nothing: the result is the light that arrives straight.
 */
struct orl_rgb orl_exterior_radiance(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                                     struct orl_vec3 direction, struct orl_mis_pdf chance,
                                     struct orl_random *random, struct orl_health *health,
                                     struct orl_building_entry *ret_entry);

/*
 * Adds the outdoor radiance to an eye path that has left a building. Returns true if the path has
 * entered again, with its state set to continue inside; false if it ended outdoors.
 */
bool orl_exterior_continue(struct orl_eye_path *p, struct orl_health *health);

/*
 * Returns the radiance of orl_exterior_radiance without entry, for a known first hit (NULL: none).
 * omit.exterior must be false.
 */
struct orl_rgb orl_exterior_radiance_from(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 direction, const struct orl_hit *first,
                                          struct orl_mis_pdf chance, struct orl_random *random,
                                          struct orl_health *health);

/*
 * Returns the radiance for a path that leaves a port outwards, without lamps seen straight. Beyond
 * a clear port it needs no ray.
 */
struct orl_rgb orl_port_radiance(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                 struct orl_random *random, struct orl_health *health);

/* Returns true if orl_port_radiance equals orl_exterior_radiance_from for the first hit of a
 * ray. */
bool orl_port_traces_exterior(const struct orl_lit_scene *lit_scene, const struct orl_port *port);

#endif

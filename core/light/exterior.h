/*
 * Radiance found by paths alone: no photon map, explicit shadow rays to suns and lights, one
 * bounce after another until the path leaves, is absorbed or dies by roulette. Suns in flat mirrors
 * and panes are found by their images (images.h); suns reflected by curved mirrors, or refracted,
 * are left out, and what BSDF ports send outdoors after a diffuse bounce keeps its flux but not its
 * shape.
 *
 * It is what photon ports see when they look out (so that every photon carries the radiance that
 * arrives, the ground's and the neighbours' included), and what views, sensors and rays from inside
 * see of surfaces outside. To these the rooms behind the neighbours' panes shine too: a path that
 * comes to one is handed back where it enters.
 */
#ifndef ORL_LIGHT_EXTERIOR_H
#define ORL_LIGHT_EXTERIOR_H

#include "light/eye_path.h"

/*
 * Where a path has passed a port inwards, and goes on: what it sees from there, times the weight,
 * is to be added by whoever asked, who knows how the inside is lit.
 */
struct orl_entry {
    bool entered;
    struct orl_path path; /* from inside the port on */
    struct orl_chance chance;
};

/*
 * One estimate of the radiance arriving at origin from direction, suns seen straight excluded.
 * ret_entry: where the path ends in a building, if it does; NULL: paths do not pass ports, and
 * light that has passed one is left out (what ports send in is first light: light/world.h). Of
 * lamps seen straight or through panes it is the share of that chance. Counts into health. With
 * omit.exterior surfaces reflect nothing: what is left is what comes straight.
 */
struct orl_rgb orl_exterior_radiance(const struct orl_world *world, struct orl_vec3 origin,
                                     struct orl_vec3 direction, struct orl_chance chance,
                                     struct orl_random *random, struct orl_health *health,
                                     struct orl_entry *ret_entry);

/*
 * An eye's path that has left a building sees what is outdoors. True: it has come in again, and is
 * where it goes on; false: it ended there.
 */
bool orl_exterior_pass(struct orl_eye_path *p, struct orl_health *health);

/*
 * The same without entry, where it is known what is met first (NULL: nothing), and nothing is left
 * out.
 */
struct orl_rgb orl_exterior_radiance_from(const struct orl_world *world, struct orl_vec3 direction,
                                          const struct orl_hit *first, struct orl_chance chance,
                                          struct orl_random *random, struct orl_health *health);

/*
 * Radiance for a path that leaves a port outwards, without the lamps that it sees straight; beyond
 * a clear port no ray is needed.
 */
struct orl_rgb orl_port_radiance(const struct orl_world *world, const struct orl_port *port,
                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                 struct orl_random *random, struct orl_health *health);

/* Returns true if that is orl_exterior_radiance_from of what a ray meets first. */
bool orl_port_looks(const struct orl_world *world, const struct orl_port *port);

#endif

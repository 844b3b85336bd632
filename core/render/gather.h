/*
 * The gather technique (the paper's GCx): light at a point is
 *   direct     from suns and lights, by shadow rays, through thin glass;
 *   caustic    from suns and lights after a mirror, a lobe or a BSDF: density of caustic photons;
 *   gathered   all the rest: a hemisphere of rays that see the domes, glow, and the radiance of
 *              diffuse surfaces by the density of global photons.
 * Every path of light is in exactly one of the three. Rays pass on through glass and are sampled
 * through BSDFs and mirrors; where they leave a sealed building they go on as exterior paths.
 * Diffuse surfaces nearer than the density's own radius are not read from the map but lit again,
 * directly and by one more ray, so that corners are not dark.
 *
 * A scene point is inside or outside (light/world.h); callers carry that along with the point.
 */
#ifndef ORL_RENDER_GATHER_H
#define ORL_RENDER_GATHER_H

#include "base/sobol.h"
#include "light/exterior.h"
#include "photon/leaves.h"
#include "photon/shoot.h"

struct orl_gather {
    const struct orl_world *world;
    const struct orl_photon_map *maps[ORL_MAP_KINDS]; /* NULL: no photons of that kind */
    uint32_t k[ORL_MAP_KINDS];                        /* neighbours */
    double max_radius[ORL_MAP_KINDS];
    double near;               /* hits closer than this are lit again */
    struct orl_leaves *leaves; /* of the global map, owned; NULL when there is none */
    struct orl_sobol sobol;
    uint64_t seed;
};

/* Chooses neighbours and radii from the maps themselves. Returns 0 or ORL_ERR_NOMEM. */
int orl_gather_init(struct orl_gather *gather, const struct orl_world *world,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed,
                    struct orl_search *search);
void orl_gather_done(struct orl_gather *gather);

/* Where light is asked for. */
struct orl_place {
    struct orl_vec3 point;  /* on or off a surface, clear of it */
    struct orl_vec3 normal; /* unit */
    bool outside;
    bool in_air;  /* off any surface: no photon lands there */
    bool proxied; /* on a surface that a BSDF stands for: lit as views see it; then outside too */
};

/*
 * Radiance along a gather ray: lights and suns not seen straight. first: three numbers in [0,1)
 * from an even sequence for what happens at the first surface, so that of many rays through a pane
 * even shares are mirrored and sent on; NULL for random ones.
 */
struct orl_rgb orl_gather_radiance(const struct orl_gather *gather, struct orl_vec3 origin,
                                   struct orl_vec3 direction, bool outside, const double *first,
                                   struct orl_random *random, struct orl_search *search);

/* The caustic part, by density, for a point of a surface. */
struct orl_density orl_gather_caustic(const struct orl_gather *gather, struct orl_vec3 point,
                                      struct orl_vec3 normal, struct orl_search *search);

/*
 * The gathered part at a place, by a stratified cosine-weighted hemisphere of rows x columns rays,
 * with its gradients and the harmonic mean of the rays' lengths (Ward and Heckbert 1992).
 */
struct orl_hemisphere {
    struct orl_rgb irradiance;
    struct orl_vec3 by_rotation[3], by_translation[3]; /* per channel */
    double mean_distance;
};
struct orl_hemisphere orl_gather_hemisphere(const struct orl_gather *gather,
                                            const struct orl_place *place, uint32_t rows,
                                            uint32_t columns, struct orl_random *random,
                                            struct orl_search *search);

/*
 * Direct light at a place: mean of that many shadow rays per light, the points first, first + 1,
 * ... of the Sobol sequence of that name, so that a pixel's rays can share one.
 */
struct orl_rgb orl_gather_direct(const struct orl_gather *gather, const struct orl_place *place,
                                 uint32_t sequence, uint32_t first, uint32_t rays);

/*
 * Illuminance, in lux, of a sensor: all three parts. A sensor on a surface reads caustics by
 * density. In mid-air, where no photon lands, it takes the sun by points on the BSDF panes and by
 * the sun's images in flat mirrors; caustics of lamps, of curved mirrors and of dielectrics are
 * left out there.
 */
double orl_gather_sensor(const struct orl_gather *gather, struct orl_vec3 position,
                         struct orl_vec3 direction, uint32_t samples, uint64_t index,
                         struct orl_search *search);

#endif

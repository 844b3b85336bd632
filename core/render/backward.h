/*
 * The backward technique (the paper's xxx): unbiased, no cache, no density estimate. Irradiance at
 * a place is the mean of samples, each of which adds up
 * - direct light: one shadow ray to every sun and lamp, and to the suns' images in flat mirrors;
 * - a ray, aimed (aim.h): what it sees of sky and glow, and of suns and lamps in the lobes of what
 *   it meets, panes of BSDF above all;
 * - connections to a few virtual point lights (vpl.h): all diffuse surfaces.
 * Every path of light is in exactly one of the three.
 *
 * Samples fall into 16 groups, each with its own numbers and its own virtual lamps, of emissions
 * that are independent of the other groups'; their spread gives the standard error.
 *
 * Suns by way of a curved mirror, of two mirrors or of a dielectric have no shadow rays: only a ray
 * that happens on the disc finds them. That is noise, not bias. Exterior paths are exterior.h's.
 * BSDFs with a thickness are met as light meets them.
 */
#ifndef ORL_RENDER_BACKWARD_H
#define ORL_RENDER_BACKWARD_H

#include "base/sobol.h"
#include "render/aim.h"
#include "render/paint.h"
#include "render/vpl.h"

struct orl_backward {
    const struct orl_world *world; /* borrowed */
    struct orl_vpls vpls;
    struct orl_aim aim;
    struct orl_sobol sobol;
    uint64_t seed;
};

/* Takes copies of what it needs of the photons. Returns 0 or ORL_ERR_NOMEM. */
int orl_backward_init(struct orl_backward *backward, const struct orl_world *world, uint64_t seed,
                      const struct orl_photon *photons, size_t count, uint64_t emitted);
void orl_backward_done(struct orl_backward *backward); /* also of one that is all zero */

struct orl_estimate {
    struct orl_rgb value;
    double standard_error; /* of its luma */
};

/*
 * Irradiance on a plane at a position, with unit normal, both in moved coordinates. index names the
 * random numbers. Counts into health.
 */
struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            uint32_t samples, uint64_t index,
                                            struct orl_health *health);

/*
 * One estimate of the radiance seen from origin in a direction, suns and lamps seen straight
 * included; the virtual lamps are those of the group.
 */
struct orl_rgb orl_backward_radiance(const struct orl_backward *backward, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside, uint32_t group,
                                     struct orl_random *random, struct orl_health *health);

/* A view, of that many paths a pixel. Returns 0 or ORL_ERR_CANCELLED. */
int orl_backward_render(const struct orl_backward *backward, const struct orl_painting *painting,
                        uint32_t samples, struct orl_error *err);

#endif

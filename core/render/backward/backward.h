/*
 * The backward technique (the paper's xxx): unbiased, no cache, no density estimate. Irradiance at
 * a place is the mean of samples, each of which adds up
 * - direct light: one shadow ray to every sun and lamp, and to the images of both in flat mirrors;
 * - rays, aimed (aim.h): what they see of sky and glow, and of suns and lamps in the lobes of what
 *   they meet, panes of BSDF above all;
 * - connections to a few virtual point lights (vpl.h): all diffuse surfaces.
 * Every path of light is in exactly one of the three.
 *
 * Sensors: samples fall into 16 groups, each with its own numbers and its own virtual lamps, of
 * emissions that are independent of the other groups'; their spread gives the standard error.
 * Views: rays are followed both ways where they split (shade.h), and one sample is taken at every
 * diffuse surface that they come to; branches of little weight are followed by lot. A pixel's
 * samples fall into up to 16 groups of consecutive ones, each with virtual lamps of its own; their
 * spread, smoothed over neighbours (error_map.h), gives the standard error, on the safe side: the
 * groups' samples are spread evenly together, which no group has of itself. Of one sample a pixel
 * it is not known.
 *
 * Suns and lamps by way of a curved mirror, of a dielectric or of several mirrors have no shadow
 * rays: only a ray that happens on the light finds them. That is noise, not bias, but hardly any
 * job has the samples to notice: photons bring such light to the sensors, intervals are widened to
 * include it, and a warning names the sensors that lack it (run/chance.c). Exterior paths are
 * exterior.h's, until they enter a building. BSDFs with a thickness are met as light meets them,
 * but by views' own rays, which see what they stand for.
 */
#ifndef ORL_RENDER_BACKWARD_BACKWARD_H
#define ORL_RENDER_BACKWARD_BACKWARD_H

#include "base/sobol.h"
#include "render/gather/aim.h"
#include "render/gather/gather.h"
#include "render/gather/vpl.h"
#include "render/image/paint.h"

struct orl_backward {
    const struct orl_world *world; /* borrowed */
    struct orl_vpls vpls;
    struct orl_aim aim;
    struct orl_effort deep; /* rays at surfaces that a ray comes to */
    struct orl_sobol sobol;
    uint64_t seed;             /* of views */
    const atomic_bool *cancel; /* ends a sensor's sampling, whose value is none then; or NULL */
};

/* What depends on the world alone, without virtual lamps yet. Returns 0 or ORL_ERR_NOMEM;
 * orl_backward_done in either case. */
int orl_backward_init(struct orl_backward *backward, const struct orl_world *world,
                      struct orl_crew *crew);
void orl_backward_done(struct orl_backward *backward); /* also of one that is all zero */

/* Virtual lamps from photons, of which it takes copies, in place of those it had; and the seed of
 * views by them. Returns 0, ORL_ERR_NOMEM or what orl_crew_try does. */
int orl_backward_put_lamps(struct orl_backward *backward, struct orl_crew *crew, uint64_t seed,
                           const struct orl_photon *photons, size_t count, uint64_t emitted);

/* Samples of a sensor: so many of its sequences, which seed and index name, from one of them on. */
struct orl_span {
    uint64_t seed, index;
    uint32_t first, samples; /* multiples of ORL_MAP_BATCHES, or fewer */
};

/*
 * Irradiance on a plane at a position, with unit normal, both in moved coordinates; and what each
 * group found. Spans that follow one another, of virtual lamps that may be others, are together as
 * even as one. Counts into health.
 */
struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            const struct orl_span *span, struct orl_health *health,
                                            struct orl_rgb ret_groups[ORL_MAP_BATCHES]);

/* A view, of that many rays a pixel; of_sums: what is wanted are sums over many pixels, such as
 * glare, and a ray is given less than for a picture. Returns 0 or ORL_ERR_CANCELLED. */
int orl_backward_render(const struct orl_backward *backward, const struct orl_painting *painting,
                        uint32_t samples, bool of_sums, struct orl_error *err);

/* ---- One sample ------------------------------------------------------------------------------ */

/* What the paths of one sample share. */
struct orl_tracer {
    const struct orl_backward *backward;
    uint32_t group; /* whose virtual lamps it is lit by */
    struct orl_random random;
    struct orl_health *health;
};

/* What a sample at a place is made of. Its first numbers are the points of even sequences. */
struct orl_sampling {
    uint32_t sequence, index;
    struct orl_effort effort;
    uint32_t lamps;
};

/* One estimate of the irradiance at a place. */
struct orl_rgb orl_backward_light(struct orl_tracer *tracer, const struct orl_place *place,
                                  const struct orl_sampling *sampling);

/* One estimate of the radiance along a ray that a lobe sent: suns not seen straight. */
struct orl_rgb orl_backward_radiance(struct orl_tracer *tracer, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside,
                                     struct orl_chance chance);

#endif

/*
 * Caustics in mid-air: light of suns and lamps that mirrors, lobes and dielectrics have sent on, at
 * sensors where no photon lands. Suns by their images in flat mirrors or one pane's lobes are
 * sampled (sensor.c); all else - off rough metal, through two panes, down a light pipe, out of a
 * lens, of lamps - comes as photons that fly through a disc about the sensor
 * (photon/flight/discs.h).
 *
 * They are flights of their own, in rounds, and end where more of them would not change the
 * sensors' errors by much, where what they have found is not felt at any sensor beside its error,
 * or at a number. Each disc is read at several widths at once; of these the one counts whose
 * scatter and bias together are least, a bias being in proportion to the area and so told by the
 * next width. The scatter that is chosen by is no less than the widest's, by area: what has caught
 * little by chance scatters little, too. The standard error is that of batches, and no less than if
 * one photon more had come: where none came there may be light that is rare.
 *
 * A sensor's disc may be made by any member of the crew, each sensor once; all else by the lead.
 */
#ifndef ORL_RENDER_GATHER_AIR_H
#define ORL_RENDER_GATHER_AIR_H

#include "render/gather/gather.h"

struct orl_air;

/* Whether anything sends such light on in that world, as it is simulated. */
bool orl_air_may_be_lit(const struct orl_world *world);

/* Whether all such light is of suns by flat mirrors, so that their images tell it exactly. */
bool orl_air_is_by_images(const struct orl_world *world);

/* For so many sensors. *ret_air is NULL where nothing can send such light on. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_air_new(const struct orl_gather *gather, size_t sensors, struct orl_air **ret_air);

/*
 * Of another kind: for the backward technique, of light that its paths would have to happen on
 * (photon/flight/found.h), at all of so many sensors, wherever they are. It is not added to
 * anything but told: orl_air_caught.
 */
int orl_air_by_chance(const struct orl_world *world, size_t sensors, struct orl_air **ret_air);
void orl_air_free(struct orl_air *air); /* NULL is allowed */

/* A sensor's place, and what it gets besides. */
void orl_air_put(struct orl_air *air, size_t sensor, const struct orl_place *place,
                 const struct orl_estimate *rest);

/* Whether there is any sensor in mid-air. */
bool orl_air_is_needed(const struct orl_air *air);

/* The first round has so many emissions, or all there are. */
enum { ORL_AIR_FEWEST = 1 << 16 };

struct orl_air_bounds {
    uint64_t emissions;   /* at the most */
    double rays_not_felt; /* rays are no more than these, but for the first round, while no sensor
                             feels what they bring; INFINITY: however many */
};

/* Flies photons by. Counts into health. Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_air_catch(struct orl_air *air, const struct orl_shoot_env *env,
                  const struct orl_air_bounds *bounds, struct orl_health *health);

/* The sensor's estimate with what was caught. */
struct orl_estimate orl_air_estimate(const struct orl_air *air, size_t sensor);

/* What was caught alone, at a sensor that has a disc; and the luma of what of it is of lamps. */
struct orl_estimate orl_air_caught(const struct orl_air *air, size_t sensor, double *ret_lamps);

#endif

/*
 * Caustics at sensors in mid-air, where no photon lands: light of suns and lamps that mirrors,
 * lobes and dielectrics have redirected. gather_sensor.c samples suns seen by flat mirrors or by
 * one pane's lobes. Photons that pass through a disc about the sensor measure all other caustics
 * (photon/tracing/counting_discs.h): off rough metal, through two panes, down a light pipe, out of
 * a lens, of lamps.
 *
 * These photons are emitted for this purpose, in rounds. Rounds end if more photons would change
 * the sensors' errors little, or if no sensor's estimate changes by more than its error. They also
 * end at a number of emissions. Each disc is read at several widths at once, and the width with the
 * least sum of scatter and bias is used. Bias is in proportion to the area, so that the next width
 * shows it. For this choice the scatter is at least the widest disc's, scaled by area: a width that
 * few photons crossed has a small scatter by chance. The standard error is that of batches, but at
 * least that of one more photon: a disc that no photon crossed may still receive rare light.
 *
 * Any member of the crew may make a sensor's disc, each sensor once; all other calls are for the
 * crew's lead.
 */
#ifndef ORL_RENDER_GATHER_SENSOR_FLUX_H
#define ORL_RENDER_GATHER_SENSOR_FLUX_H

#include "render/gather/direction_sampling.h"
#include "render/gather/gather.h"

struct orl_sensor_flux;

/* Returns true if some caustics in mid-air need photons, in that world as it is simulated. */
bool orl_sensor_flux_may_exist(const struct orl_lit_scene *lit_scene);

/* Returns true if all caustics are of suns by flat mirrors, so that their images give them
 * exactly. */
bool orl_sensor_flux_is_virtual_suns(const struct orl_lit_scene *lit_scene);

/* Creates the estimator for a number of sensors. *ret_air is NULL if no caustics in mid-air need
 * photons. Returns 0 or ORL_ERR_NOMEM. */
int orl_sensor_flux_new(const struct orl_gather *gather, size_t sensors,
                        struct orl_sensor_flux **ret_air);

/*
 * Creates an estimator for the backward technique: of light that its paths find only by chance
 * (photon/tracing/path_owner.h), at all of the sensors, wherever they are. The result is reported
 * by orl_sensor_flux_caustics and not added to any estimate.
 */
int orl_sensor_flux_new_unsampled(const struct orl_lit_scene *lit_scene, size_t sensors,
                                  struct orl_sensor_flux **ret_air);
void orl_sensor_flux_free(struct orl_sensor_flux *sensor_flux); /* NULL is allowed */

/* Sets a sensor's place, and the estimate of its other light. */
void orl_sensor_flux_set_sensor(struct orl_sensor_flux *sensor_flux, size_t sensor,
                                const struct orl_shading_point *place,
                                const struct orl_estimate *rest);

/* Returns true if any sensor is in mid-air. */
bool orl_sensor_flux_is_needed(const struct orl_sensor_flux *sensor_flux);

/* Number of emissions in the first round, unless the limit is lower. */
enum { ORL_SENSOR_FLUX_FIRST_ROUND = 1 << 16 };

struct orl_sensor_flux_limits {
    uint64_t emissions; /* upper limit */
    /* Limit of rays after the first round, while no sensor's estimate changes by more than its
     * error; INFINITY: no limit. */
    double negligible_rays;
};

/* Traces photons in rounds. Counts into health. Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_sensor_flux_collect(struct orl_sensor_flux *sensor_flux, const struct orl_shoot_env *env,
                            const struct orl_sensor_flux_limits *bounds, struct orl_health *health);

/* Returns the sensor's estimate including the measured caustics. */
struct orl_estimate orl_sensor_flux_estimate(const struct orl_sensor_flux *sensor_flux,
                                             size_t sensor);

/* Returns the measured caustics alone, for a sensor that has a disc; *ret_lamps: the luma of the
 * lamps' part. */
struct orl_estimate orl_sensor_flux_caustics(const struct orl_sensor_flux *sensor_flux,
                                             size_t sensor, double *ret_lamps);

/*
 * Light of suns through BSDF panes at a place where no photon lands. Half of the points are uniform
 * over a pane, half are drawn along the sun lobe (sun_lobe.h). A lobe a few degrees wide
 * lights a place from a thousandth of the pane, which uniform points miss and the sun lobe's points
 * find. Points are weighed by the balance heuristic of Veach and Guibas 1995.
 */

struct orl_pane_query {
    const struct orl_lit_scene *lit_scene;
    const struct orl_direction_sampler
        *sampler; /* made for that world; NULL: only uniform points */
    const struct orl_sobol *sobol;
    const struct orl_shading_point *place;
    /* Names of the sequences of uniform points and of those drawn, for all panes. */
    uint32_t sequences[2];
};

/* Returns one estimate of the irradiance at the place, W/m2. */
struct orl_rgb orl_sun_through_panes(const struct orl_pane_query *query);

#endif

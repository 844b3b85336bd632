/*
 * Caustics at sensors in free space, where no photon is stored: light of suns and lamps that
 * mirrors, lobes and dielectrics have redirected. gather_sensor.c samples suns seen by flat mirrors
 * or by one pane's lobes. Photons that pass through a disc about the sensor measure all other
 * caustics (photon/tracing/trace.h): off rough metal, through two panes, down a light pipe, out of
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
 * Threads: any thread of the pool may make a sensor's disc, each sensor once. All other calls are
 * for the thread that leads the pool.
 */
#ifndef ORL_RENDER_GATHER_SENSOR_FLUX_H
#define ORL_RENDER_GATHER_SENSOR_FLUX_H

#include "render/gather/gather.h"

struct orl_sensor_flux;

/* Returns true if some caustics in free space need photons, with the lit scene's effects. */
bool orl_sensor_flux_may_exist(const struct orl_lit_scene *lit_scene);

/* Returns true if all caustics are of suns by flat mirrors, so that virtual suns give them
 * exactly. */
bool orl_sensor_flux_is_virtual_suns(const struct orl_lit_scene *lit_scene);

/* Creates the estimator for a number of sensors. *ret_flux is NULL if no caustics in free space
 * need photons. Returns 0 or ORL_ERR_NOMEM. */
int orl_sensor_flux_new(const struct orl_gather *gather, size_t sensors,
                        struct orl_sensor_flux **ret_flux);

/*
 * Creates an estimator for the backward technique: of light that its paths find only by chance
 * (photon/tracing/trace.h), at all of the sensors, wherever they are. The result is reported
 * by orl_sensor_flux_caustics and not added to any estimate.
 */
int orl_sensor_flux_new_unsampled(const struct orl_lit_scene *lit_scene, size_t sensors,
                                  struct orl_sensor_flux **ret_flux);
void orl_sensor_flux_free(struct orl_sensor_flux *sensor_flux); /* NULL is allowed */

/* Sets a sensor's place, and the estimate of its other light. */
void orl_sensor_flux_set_sensor(struct orl_sensor_flux *sensor_flux, size_t sensor,
                                const struct orl_shading_point *place,
                                const struct orl_estimate *rest);

/* Returns true if any sensor is in free space. */
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

#endif

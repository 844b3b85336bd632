/*
 * Sunlight at a place: straight, through panes, and by one reflection in a flat mirror or a pane.
 * Paths use the sun's nodes; sensors use the sun of every hour.
 *
 * Light by several mirrors in sequence is left out. Scenes in which it exceeds the faint second
 * reflections of panes are refused (check_supported.h).
 */
#ifndef ORL_ANNUAL_SUN_SUNLIGHT_H
#define ORL_ANNUAL_SUN_SUNLIGHT_H

#include "annual/coefficients/path_sums.h"
#include "annual/sun/sensor_sunlight.h"
#include "annual/year/annual_scene.h"

/* A place and the weight of its irradiance. If lobes is not NULL, the light that they send towards
 * eye counts instead of irradiance. */
struct orl_sunlight_query {
    struct orl_shading_point place;
    struct orl_rgb weight;
    /* First port by which the path to the place left the building; ORL_NO_PORT: none. */
    int32_t port;
    /* True if all nodes are tried, not a random subset; for surfaces that a sensor sees
     * directly. */
    bool all;
    /* True if the map of sunlight supplies the rest: only mirrors seen through ports are
     * searched. */
    bool mapped;
    const struct orl_material *lobes;
    const struct orl_hit *hit;
    struct orl_vec3 eye;
};

/* Adds light to the nodes of each window group, for a sun with a normal illuminance of 1. */
void orl_sunlight_add(const struct orl_annual_scene *scene, const struct orl_sunlight_query *query,
                      struct orl_random *random, const struct orl_path_sums *sums);

/*
 * Computes irradiance at a sensor by the discs of all wanted suns, each with a normal illuminance
 * of 1: straight, through panes, and by mirrors. Cancellation of the crew is checked before each
 * sun, straight and by each mirror pane; the rest is then left out. crew may be NULL.
 */
void orl_sunlight_find_hours(const struct orl_annual_scene *scene, const struct orl_year_suns *suns,
                             const struct orl_shading_point *place, uint64_t name,
                             const struct orl_thread_pool *pool,
                             const struct orl_sensor_sunlight *sunlight);

#endif

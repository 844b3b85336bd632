/* Sunlight at a place, and the arrays that hold it. */
#ifndef ORL_ANNUAL_SUN_SUNLIGHT_H
#define ORL_ANNUAL_SUN_SUNLIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/year/annual_scene.h"

/*
 * Direct sunlight at a sensor by sun (hours.h), and by the window group through which it
 * comes in (annual_scene.h): irradiance for a sun with a normal irradiance of 1.
 */

/* Rows: sunlight straight and through BSDF panes (oriel/annual/annual.h); sunlight by mirrors; and
 * the square of the standard error of both together. */
enum orl_sunlight_row {
    ORL_SUNLIGHT_DIRECT,
    ORL_SUNLIGHT_MIRRORED,
    ORL_SUNLIGHT_VARIANCE,
    ORL_SUNLIGHT_ROWS
};

/* Returns the number of samples of a disc for the given paths per sensor, such that both errors
 * fall together. */
enum { ORL_DISC_LEAST_POINTS = 128, ORL_DISC_MOST_POINTS = 2048, ORL_PATHS_A_DISC_POINT = 32 };
static inline uint32_t orl_disc_points(uint32_t samples)
{
    const uint32_t points = samples / ORL_PATHS_A_DISC_POINT;
    return points < ORL_DISC_LEAST_POINTS  ? ORL_DISC_LEAST_POINTS
           : points > ORL_DISC_MOST_POINTS ? ORL_DISC_MOST_POINTS
                                           : points;
}

struct orl_sensor_sunlight {
    float *at; /* [window group][ORL_SUNLIGHT_ROWS][sun] */
    size_t n_suns;
    unsigned char *
        lit; /* by window group: 1 if its rows are set; rows of other window groups are undefined */
    uint32_t disc_points; /* samples of a sun's disc that an edge crosses; at least 4 */
    bool direct_only;     /* true if light by mirrors is not computed */
    /* [window group][sun]: nonzero if the caller needs that sun for that window group; NULL: all
     * are needed. BSDF panes are sampled for these suns only. */
    const unsigned char *wanted;
};

static inline float *orl_sensor_sunlight_row(const struct orl_sensor_sunlight *sunlight,
                                             uint32_t window_group, enum orl_sunlight_row row)
{
    return sunlight->at + ((size_t)window_group * ORL_SUNLIGHT_ROWS + row) * sunlight->n_suns;
}

/* Sets the rows of a window group to 0 at their first use. */
static inline void orl_sensor_sunlight_ensure(const struct orl_sensor_sunlight *sunlight,
                                              uint32_t window_group)
{
    if (sunlight->lit[window_group])
        return;
    sunlight->lit[window_group] = 1;
    memset(orl_sensor_sunlight_row(sunlight, window_group, ORL_SUNLIGHT_DIRECT), 0,
           ORL_SUNLIGHT_ROWS * sunlight->n_suns * sizeof *sunlight->at);
}

static inline void orl_sensor_sunlight_add(const struct orl_sensor_sunlight *sunlight,
                                           uint32_t window_group, enum orl_sunlight_row row,
                                           size_t sun, double light)
{
    orl_sensor_sunlight_ensure(sunlight, window_group);
    orl_sensor_sunlight_row(sunlight, window_group, row)[sun] += (float)light;
}

/*
 * Sunlight at a place: straight, through panes, and by one reflection in a flat mirror or a pane.
 * Paths use the sun's nodes; sensors use the sun of every hour.
 *
 * Light by several mirrors in sequence is left out. Scenes in which it exceeds the faint second
 * reflections of panes are refused (orl_annual_check_supported).
 */

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
 * of 1: straight, through panes, and by mirrors. The cancel flag of the pool is polled before each
 * sun, straight and by each mirror pane; the rest is then left out. pool may be NULL.
 */
void orl_sunlight_find_hours(const struct orl_annual_scene *scene, const struct orl_year_suns *suns,
                             const struct orl_shading_point *place, uint64_t name,
                             const struct orl_thread_pool *pool,
                             const struct orl_sensor_sunlight *sunlight);

#endif

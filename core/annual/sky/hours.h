/*
 * The hours of a weather file: its rows as steps of the year, and for rows with light the sun and
 * the sky's radiance in every bin.
 *
 * A sky is the Perez pattern of its row. A bin's value is the mean over the bin's row in height, at
 * the middle of the bin in azimuth. The bins are scaled so that together they give a horizontal
 * plane exactly the diffuse flux of the row. The ground is lit by sky and sun
 * (light/daylight/daylight.h).
 *
 * Skies are stored in tiles of ORL_HOURS_TILE columns, [bin][column]. A matrix product loops over
 * bins and handles the columns of a tile side by side. Immutable once made.
 */
#ifndef ORL_ANNUAL_SKY_HOURS_H
#define ORL_ANNUAL_SKY_HOURS_H

#include <stdbool.h>

#include <oriel/annual/annual.h>
#include <oriel/base/limits.h>

#include "annual/sky/bins.h"
#include "annual/sun/direction_tree.h"
#include "base/memory/memory.h"
#include "light/daylight/weather.h"

enum { ORL_HOURS_TILE = 64, ORL_HOURS_MOST = ORL_LIMIT_YEAR_ROWS };

/* A sun in scene axes (north turned). */
struct orl_hour_sun {
    struct orl_vec3 towards; /* unit */
    double angle_rad;        /* angular diameter */
    bool wanted;             /* true if some column has sunlight from it */
};

/*
 * Positions of the sun at the rows of a file. They do not depend on the weather: another file of
 * the same site and times has the same suns. Light found for a sun refers to a normal illuminance
 * of 1.
 */
struct orl_year_suns {
    struct orl_hour_sun *at;
    struct orl_vec3 *in_sky; /* the same directions before north is turned */
    size_t count;
    struct orl_direction_tree tree; /* searches the directions `towards` */
};

/* Sun of a column: its index, and the illuminance of a plane that faces it; 0 lx: no sun. */
struct orl_column_sun {
    uint32_t sun;
    double normal_lx;
};

struct orl_hours {
    struct orl_annual_step *steps; /* all rows; owned until taken */
    size_t n_steps;
    uint32_t *step_of_column; /* owned until taken */
    size_t n_columns, n_tiles;
    struct orl_arrays arrays; /* the arrays below */
    struct orl_year_suns suns;
    struct orl_column_sun *sun_of_column;
    float *fine, *coarse;       /* tiles of ORL_BINS and of ORL_BINS_COARSE rows: W/sr/m2 */
    size_t n_missing, n_warned; /* numbers of rows */
    char warning[640];          /* first warning of the sky models, or "" */
};

/* Returns 0, ORL_ERR_LIMIT, _NOMEM, _CANCELLED or the error of a faulty row. The caller calls
 * orl_hours_done in either case. */
int orl_hours_init(struct orl_hours *hours, const struct orl_bins *bins,
                   const struct orl_weather *weather, const char *weather_name, double north_deg,
                   double ground_reflectance, struct orl_thread_pool *pool, struct orl_error *err);
void orl_hours_done(struct orl_hours *hours);

/* Rotation between scene and sky axes, which differ by the direction of true north. */
struct orl_sky_rotation {
    double cosine, sine;
};
static inline struct orl_sky_rotation orl_sky_rotation_by_north(double north_deg)
{
    return (struct orl_sky_rotation){cos(north_deg * ORL_DEG_TO_RAD),
                                     sin(north_deg * ORL_DEG_TO_RAD)};
}
static inline struct orl_vec3 orl_sky_rotation_to_sky(struct orl_sky_rotation t, struct orl_vec3 d)
{
    return orl_v3(t.cosine * d.x + t.sine * d.y, t.cosine * d.y - t.sine * d.x, d.z);
}
static inline struct orl_vec3 orl_sky_rotation_to_scene(struct orl_sky_rotation t,
                                                        struct orl_vec3 d)
{
    return orl_v3(t.cosine * d.x - t.sine * d.y, t.cosine * d.y + t.sine * d.x, d.z);
}

#endif

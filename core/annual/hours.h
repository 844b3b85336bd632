/*
 * The hours of a weather file: its rows as steps of the year; of those with light the sun, and the
 * sky's radiance in every bin.
 *
 * A sky is the Perez pattern of its row, its mean over each bin's row in height and its value in
 * the middle of the bin in azimuth, balanced so that the bins together give a horizontal plane
 * exactly the diffuse flux of the row; the ground is lit by both (light/daylight.h).
 *
 * Skies lie in tiles of ORL_HOURS_TILE columns, [bin][column]: whoever multiplies goes through
 * bins, and does the columns of a tile side by side. Immutable once made.
 */
#ifndef ORL_ANNUAL_HOURS_H
#define ORL_ANNUAL_HOURS_H

#include <stdbool.h>

#include <oriel/annual.h>
#include <oriel/limits.h>

#include "annual/bins.h"
#include "annual/direction_tree.h"
#include "light/weather.h"

enum { ORL_HOURS_TILE = 64, ORL_HOURS_MOST = ORL_LIMIT_YEAR_ROWS };

/* A sun, as the scene has it (north turned). */
struct orl_hour_sun {
    struct orl_vec3 towards; /* unit */
    double angle_rad;        /* across */
    bool wanted;             /* some column has it */
};

/*
 * Where the sun stands at the rows of a file, whatever weather they have: another file of the same
 * site and times has the same. What it gives is said for a sun that gives 1 to what faces it.
 */
struct orl_year_suns {
    struct orl_hour_sun *at;
    struct orl_vec3 *in_sky; /* the same directions before north is turned */
    size_t count;
    struct orl_direction_tree tree; /* of towards */
};

/* Of a column: which of the suns, and what it gives a plane that faces it; 0 lx: none. */
struct orl_column_sun {
    uint32_t sun;
    double normal_lx;
};

struct orl_hours {
    struct orl_annual_step *steps; /* of all rows; owned until taken */
    size_t n_steps;
    uint32_t *step_of_column; /* likewise */
    size_t n_columns, n_tiles;
    struct orl_year_suns suns;
    struct orl_column_sun *sun_of_column;
    float *fine, *coarse;       /* tiles of ORL_BINS, and of ORL_BINS_COARSE, rows: W/sr/m2 */
    size_t n_missing, n_warned; /* rows */
    char warning[640];          /* the first of those that models gave, or "" */
};

/* Returns 0, ORL_ERR_LIMIT, _NOMEM, _CANCELLED or what is wrong with a row; orl_hours_done in
 * either case. */
int orl_hours_init(struct orl_hours *hours, const struct orl_bins *bins,
                   const struct orl_weather *weather, const char *weather_name, double north_deg,
                   double ground_reflectance, struct orl_crew *crew, struct orl_error *err);
void orl_hours_done(struct orl_hours *hours);
/* As if every sun had a column that it shines in. */
void orl_hours_want_all(struct orl_hours *hours);

/* A direction of the scene as the sky has it, north being turned; and back. */
struct orl_turn {
    double cosine, sine;
};
static inline struct orl_turn orl_turn_by(double north_deg)
{
    return (struct orl_turn){cos(north_deg * ORL_DEG_TO_RAD), sin(north_deg * ORL_DEG_TO_RAD)};
}
static inline struct orl_vec3 orl_turn_to_sky(struct orl_turn t, struct orl_vec3 d)
{
    return orl_v3(t.cosine * d.x + t.sine * d.y, t.cosine * d.y - t.sine * d.x, d.z);
}
static inline struct orl_vec3 orl_turn_to_scene(struct orl_turn t, struct orl_vec3 d)
{
    return orl_v3(t.cosine * d.x - t.sine * d.y, t.cosine * d.y + t.sine * d.x, d.z);
}

#endif

/*
 * Exposure to sunlight by EN 17037:2018 (5.3 and annex D): the hours for which the sun is visible
 * from a point at a window, on a day between 1 February and 21 March under a clear sky. The
 * recommendations are 1.5 h (minimum), 3 h (medium) and 4 h (high), for one habitable room of a
 * dwelling and similar rooms.
 *
 * The standard defines the point: in the plane of the inner surface and in the middle of the
 * opening's width, at least 1.2 m above the floor and 0.3 m above the sill. Any day of the period
 * may be chosen: the day with the most sun is reported, and 21 March beside it. The sun is
 * represented by the middle of its disc, every minute. It counts from least_altitude_deg up, for
 * which the standard has a table of places. The sun's position is that of the request's sun_method
 * in 2017, whatever the years of the weather file. On a date in March, declinations differ between
 * years by up to 0.4 degrees; 2017 lies in the middle. Behind a horizon of 28 degrees in Helsinki
 * that is 20 minutes. Windows count as open, even if their glazing scatters or is tinted: glass,
 * dielectrics, BSDFs and illums. Shades are in their first state. Everything else is opaque.
 *
 * South of the equator the period is half a year later, 1 August to 21 September.
 *
 * Points are in scene units. Results do not depend on the number of threads. They are accurate to
 * about a minute for an opening's edge.
 */
#ifndef ORIEL_ANNUAL_SUN_EXPOSURE_H
#define ORIEL_ANNUAL_SUN_EXPOSURE_H

#include <oriel/base/input_checks.h>

enum { ORL_EXPOSURE_MOST_POINTS = 4096 };

struct orl_exposure_request {
    struct orl_named_point *points; /* owned; none: no exposure is computed */
    size_t n_points;
    double least_altitude_deg; /* 0..90 */
};
void orl_exposure_request_done(struct orl_exposure_request *exposure_request); /* zeros are fine */

enum orl_exposure_level {
    ORL_EXPOSED_NONE,
    ORL_EXPOSED_MINIMUM,
    ORL_EXPOSED_MEDIUM,
    ORL_EXPOSED_HIGH
};
const char *orl_exposure_level_name(enum orl_exposure_level level); /* "none", "minimum", ... */

/* Exposure of a point. */
struct orl_exposure {
    int month, day; /* day with the most sun, the first of equals */
    double hours, last_day_hours;
    enum orl_exposure_level level;
};

struct orl_annual_request;
struct orl_annual_site;
struct orl_run_env;

/* Computes the exposure of each point. Reads the request's scene, or finds it in the memory cache;
 * north is the request's. Returns 0, ORL_ERR_NOMEM, _CANCELLED, or the error of loading. */
int orl_exposure_compute(const struct orl_exposure_request *exposure_request,
                         const struct orl_annual_site *site,
                         const struct orl_annual_request *request, const struct orl_run_env *env,
                         struct orl_exposure *ret_exposures, struct orl_error *err);

#endif

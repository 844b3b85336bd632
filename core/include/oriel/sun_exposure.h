/*
 * Exposure to sunlight by EN 17037:2018 (5.3 and annex D): for how long the sun can be seen from a
 * point at a window, on a day between 1 February and 21 March, were the sky clear. 1.5 h are its
 * minimum, 3 h its medium and 4 h its high recommendation, of one habitable room of a home and the
 * like.
 *
 * The point is where the standard puts it: in the plane of the inner surface, in the middle of the
 * opening's width, 1.2 m above the floor or more and 0.3 m above the sill or more. The day may be
 * any one of those: the one with the most sun is told, and 21 March beside it. The sun is its
 * middle, every minute; it counts from least_altitude_deg up, for which the standard has a table of
 * places. It stands where the request's sun_method has it in 2017, whatever years the weather file
 * is of: on a date of March, declinations of years differ by up to 0.4 degrees, which is 20 minutes
 * behind a horizon of 28 degrees in Helsinki, and 2017 lies in the middle. Windows are open here,
 * whatever their glazing scatters or tints: glass, dielectrics, BSDFs and illums; shades are in
 * their first state. All else is opaque.
 *
 * South of the equator the days are those half a year later, 1 August to 21 September.
 *
 * Points are in scene units. Results do not depend on the crew. A minute either way is what an
 * opening's edge is known to.
 */
#ifndef ORIEL_SUN_EXPOSURE_H
#define ORIEL_SUN_EXPOSURE_H

#include <oriel/place.h>

enum { ORL_EXPOSURE_MOST_POINTS = 4096 };

struct orl_exposure_wish {
    struct orl_named_place *points; /* owned; none: exposure is not asked for */
    size_t n_points;
    double least_altitude_deg; /* 0..90 */
};
void orl_exposure_wish_done(struct orl_exposure_wish *wish); /* zeros are fine */

enum orl_exposure_level {
    ORL_EXPOSED_LESS,
    ORL_EXPOSED_MINIMUM,
    ORL_EXPOSED_MEDIUM,
    ORL_EXPOSED_HIGH
};
const char *orl_exposure_level_name(enum orl_exposure_level level); /* "none", "minimum", ... */

/* Of a point. */
struct orl_exposure {
    int month, day; /* with the most sun, the first of equals */
    double hours, last_day_hours;
    enum orl_exposure_level level;
};

struct orl_annual_request;
struct orl_run_env;

/* A place, as weather files have it: degrees, east. */
struct orl_exposure_site {
    double latitude_deg, longitude_deg, time_zone_h;
};

/* Reads the request's scene, or finds it on the shelf; north is the request's. ret_exposures: of
 * each point. ORL_ERR_NOMEM, _CANCELLED, or what loading says. */
int orl_exposure_find(const struct orl_exposure_wish *wish, const struct orl_exposure_site *site,
                      const struct orl_annual_request *request, const struct orl_run_env *env,
                      struct orl_exposure *ret_exposures, struct orl_error *err);

#endif

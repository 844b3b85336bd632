/* Checks of a sky request. Messages use the names of the job document. */
#include <math.h>
#include <stddef.h>

#include "light/daylight/daylight.h"

struct range {
    const char *name;
    double value, low, high;
};

/* Checks that values are in their ranges; NaN is in none. */
static int check_ranges(const struct range *ranges, size_t count, struct orl_error *err)
{
    for (size_t i = 0; i < count; i++) {
        const struct range *r = &ranges[i];
        if (!(r->value >= r->low && r->value <= r->high)) {
            orl_error_set(err, ORL_ERR_RANGE, "the sky's %s is %g; it must lie between %g and %g",
                          r->name, r->value, r->low, r->high);
            orl_error_at(err, NULL, 0, "sky");
            return ORL_ERR_RANGE;
        }
    }
    return 0;
}

/* Checks the hour, which must be before midnight. 24 is refused with a hint that it is the next
 * day's 0. */
static int check_hour(double hour, struct orl_error *err)
{
    if (hour >= 0 && hour < 24)
        return 0;
    orl_error_set(err, ORL_ERR_RANGE, "the sky's hour is %g, and must be at least 0 and below 24",
                  hour);
    orl_error_at(err, NULL, 0, "sky");
    if (hour == 24)
        orl_error_hint(err, "Midnight is hour 0 of the next day");
    return ORL_ERR_RANGE;
}

static int set_invalid_error(struct orl_error *err, const char *what)
{
    orl_error_set(err, ORL_ERR_INVALID, "%s", what);
    orl_error_at(err, NULL, 0, "sky");
    return ORL_ERR_INVALID;
}

static int check_time(const struct orl_sky_request *r, struct orl_error *err)
{
    static const signed char days[12] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const struct range ranges[] = {{"month", r->month, 1, 12},
                                   {"day", r->day, 1, 31},
                                   {"latitude", r->latitude_deg, -90, 90},
                                   {"longitude", r->longitude_deg, -180, 180},
                                   {"time_zone", r->time_zone_h, -14, 14}};
    int code = check_ranges(ranges, sizeof ranges / sizeof *ranges, err);
    if (code == 0)
        code = check_hour(r->hour, err);
    if (code == 0 && r->day > days[r->month - 1])
        return set_invalid_error(err, "the sky's month has no such day");
    return code;
}

static int check_sun(const struct orl_sky_request *r, bool needed, struct orl_error *err)
{
    const struct range angles[] = {{"sun_altitude", r->sun_altitude_deg, -90, 90},
                                   {"sun_azimuth", r->sun_azimuth_deg, -360, 360}};
    if (r->sun_given && r->time_given)
        return set_invalid_error(
            err, "the sky's sun is given twice: by its angles, and by time and site");
    if (r->sun_given)
        return check_ranges(angles, 2, err);
    if (r->time_given)
        return check_time(r, err);
    if (!needed)
        return 0;
    set_invalid_error(err, "the sky's sun has no position");
    orl_error_hint(err, "give month, day, hour, latitude, longitude and time_zone, or sun_altitude "
                        "and sun_azimuth");
    return ORL_ERR_INVALID;
}

/* The upper limits of irradiance are the solar constant, above which gendaylit's sky is black.
 * The other limits are those of its model. */
static int check_perez(const struct orl_sky_request *r, struct orl_error *err)
{
    struct range ranges[2] = {{"direct_normal_w_m2", r->first, 0, ORL_DAYLIGHT_MOST_W},
                              {"diffuse_horizontal_w_m2", r->second, 0, ORL_DAYLIGHT_MOST_W}};
    size_t count = 2;
    switch (r->input) {
    case ORL_SKY_NORMAL_W:
        break;
    case ORL_SKY_NORMAL_LX:
        ranges[0] = (struct range){"direct_normal_lx", r->first, 0, ORL_DAYLIGHT_MOST_LX};
        ranges[1] = (struct range){"diffuse_horizontal_lx", r->second, 0, ORL_DAYLIGHT_MOST_LX};
        break;
    case ORL_SKY_HORIZONTAL_W:
        ranges[0].name = "direct_horizontal_w_m2";
        break;
    case ORL_SKY_GLOBAL_W:
        ranges[0].name = "global_horizontal_w_m2";
        count = 1;
        break;
    case ORL_SKY_INDICES:
        ranges[0] = (struct range){"clearness", r->first, 1, 12.009};
        ranges[1] = (struct range){"brightness", r->second, 0.01, 0.6};
        break;
    default:
        return set_invalid_error(err, "a Perez sky cannot be made from these inputs");
    }
    const int code = check_ranges(ranges, count, err);
    return code < 0 ? code : check_sun(r, true, err);
}

static int check_cie(const struct orl_sky_request *r, struct orl_error *err)
{
    const bool even = r->cie_type == ORL_SKY_OVERCAST || r->cie_type == ORL_SKY_UNIFORM;
    const struct range ranges[] = {{"turbidity", r->turbidity, 1, 20},
                                   {"direct_normal_lx", r->direct_normal_lx, -1, 200000},
                                   {"brightness", r->first, 0, 1e6}};
    if (!even && r->cie_type != ORL_SKY_CLEAR && r->cie_type != ORL_SKY_INTERMEDIATE)
        return set_invalid_error(err, "the sky's CIE type is unknown");
    if (r->input != ORL_SKY_TYPICAL && r->input != ORL_SKY_ZENITH_CD_M2 &&
        r->input != ORL_SKY_DIFFUSE_LX)
        return set_invalid_error(err, "a CIE sky cannot be made from these inputs");
    if (even && r->direct_normal_lx > 0)
        return set_invalid_error(err, "an overcast or uniform sky has no sun");
    const int code = check_ranges(ranges, sizeof ranges / sizeof *ranges, err);
    return code < 0 ? code : check_sun(r, !even || r->input == ORL_SKY_TYPICAL, err);
}

int orl_daylight_check(const struct orl_sky_request *request, struct orl_error *err)
{
    const struct range ground = {"ground_reflectance", request->ground_reflectance, 0, 1};
    int code;
    if (request->model == ORL_SKY_OF_SCENE)
        return 0;
    code = check_ranges(&ground, 1, err);
    if (code < 0)
        return code;
    if (request->model == ORL_SKY_BY_PEREZ)
        return check_perez(request, err);
    if (request->model == ORL_SKY_BY_CIE)
        return check_cie(request, err);
    if (!request->weather_file || !request->time_given)
        return set_invalid_error(err, "a sky by weather needs a file, month, day and hour");
    return check_time(request, err);
}

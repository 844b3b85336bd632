#include "light/daylight/daylight.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "base/text/words.h"
#include "scene/generate/generate.h"

/* ---- Command line of the program that would give the same sky -------------------------------- */

/* Adds a number with 17 digits, from which every double is read back unchanged. */
static void add_number(struct orl_shell_words *command, double value)
{
    orl_shell_words_add(command, "%.17g", value);
}

static void add_option(struct orl_shell_words *command, const char *option, double value)
{
    orl_shell_words_add(command, "%s", option);
    add_number(command, value);
}

/* Adds time and site, or the sun's position. If a sky needs neither, adds an arbitrary position. */
static void add_when(struct orl_shell_words *command, const struct orl_sky_request *request)
{
    if (!request->time_given) {
        add_option(command, "-ang", request->sun_given ? request->sun_altitude_deg : 45.0);
        add_number(command, request->sun_given ? request->sun_azimuth_deg : 0.0);
        return;
    }
    add_number(command, request->month);
    add_number(command, request->day);
    orl_shell_words_add(command, "%.12f", request->hour); /* gensky does not read exponents here */
    add_option(command, "-a", request->latitude_deg);
    add_option(command, "-o", -request->longitude_deg);
    add_option(command, "-m", -15.0 * request->time_zone_h);
}

const char *orl_sun_method_name(enum orl_sun_method method)
{
    return method == ORL_SUN_ACCURATE ? "accurate" : "radiance";
}

/* Half the sun's diameter: the depth of its centre below the horizon when the disc has just set. */
static const double half_disc_rad = 0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD;

/*
 * Returns the sun at the middle of the part of an interval in which it is up; of several parts, the
 * longest. If it is never up, returns `at`, its position at the middle of the interval.
 */
static struct orl_sun_position sun_in_part(const struct orl_location *site,
                                           const struct orl_moment *middle, double interval_h,
                                           struct orl_sun_position at)
{
    enum { STEPS = 60 };
    static const double fastest_rad = 15 * ORL_DEG_TO_RAD; /* change of altitude in an hour */
    struct orl_moment moment = *middle;
    int length = 0, longest = 0, end = 0;
    if (at.altitude_rad + 0.5 * interval_h * fastest_rad <= -half_disc_rad)
        return at;
    for (int i = 0; i < STEPS; i++) {
        moment.hour = middle->hour + interval_h * ((i + 0.5) / STEPS - 0.5);
        length = orl_sun_accurate(site, &moment).altitude_rad > -half_disc_rad ? length + 1 : 0;
        if (length > longest) {
            longest = length;
            end = i + 1;
        }
    }
    moment.hour = middle->hour + interval_h * ((end - 0.5 * longest) / STEPS - 0.5);
    return longest > 0 ? orl_sun_accurate(site, &moment) : at;
}

/* Returns the position of the sun; any position for a sky that needs none. */
static struct orl_sun_position sun_of(const struct orl_sky_request *request)
{
    const struct orl_location site = {request->latitude_deg * ORL_DEG_TO_RAD,
                                      -request->longitude_deg * ORL_DEG_TO_RAD,
                                      -15.0 * request->time_zone_h * ORL_DEG_TO_RAD};
    struct orl_moment moment = {
        .year = request->year, .month = request->month, .day = request->day, .hour = request->hour};
    double declination, solar_hour;
    if (!request->time_given)
        return (struct orl_sun_position){
            .altitude_rad =
                (request->sun_given ? request->sun_altitude_deg : 45.0) * ORL_DEG_TO_RAD,
            .azimuth_rad = request->sun_azimuth_deg * ORL_DEG_TO_RAD};
    if (request->sun_method == ORL_SUN_ACCURATE) {
        const struct orl_sun_position at = orl_sun_accurate(&site, &moment);
        return request->interval_h > 0 && at.altitude_rad <= -half_disc_rad
                   ? sun_in_part(&site, &moment, request->interval_h, at)
                   : at;
    }
    moment.year = 0;
    orl_sun_clock(&site, &moment, &declination, &solar_hour);
    return orl_sun_at(&site, declination, solar_hour);
}

static int find_perez(const struct orl_sky_request *request, const struct orl_sun_position *placed,
                      struct orl_text *text, struct orl_sky_numbers *ret_numbers,
                      struct orl_error *err)
{
    static const char *const options[] = {[ORL_SKY_NORMAL_W] = "-W",
                                          [ORL_SKY_NORMAL_LX] = "-L",
                                          [ORL_SKY_HORIZONTAL_W] = "-G",
                                          [ORL_SKY_GLOBAL_W] = "-E",
                                          [ORL_SKY_INDICES] = "-P"};
    struct orl_shell_words command = {.count = 0};
    orl_shell_words_add(&command, "gendaylit");
    add_when(&command, request);
    add_option(&command, "-g", request->ground_reflectance);
    add_option(&command, options[request->input], request->first);
    if (request->input != ORL_SKY_GLOBAL_W)
        add_number(&command, request->second);
    return orl_gendaylit_numbers(command.words, command.count, placed, text, ret_numbers, err);
}

/* Returns the solid angle of a disc, without cancellation. */
static double disc_sr(double angle_deg)
{
    const double quarter = sin(0.25 * angle_deg * ORL_DEG_TO_RAD);
    return 4 * ORL_PI * quarter * quarter;
}

static int find_cie(const struct orl_sky_request *request, const struct orl_sun_position *placed,
                    struct orl_text *text, struct orl_sky_numbers *ret_numbers,
                    struct orl_error *err)
{
    static const char *const types[] = {[ORL_SKY_CLEAR] = "+s",
                                        [ORL_SKY_OVERCAST] = "-c",
                                        [ORL_SKY_UNIFORM] = "-u",
                                        [ORL_SKY_INTERMEDIATE] = "+i"};
    static const double gensky_disc_deg = 0.5;
    struct orl_shell_words command = {.count = 0};
    orl_shell_words_add(&command, "gensky");
    add_when(&command, request);
    orl_shell_words_add(&command, "%s", types[request->cie_type]);
    add_option(&command, "-g", request->ground_reflectance);
    add_option(&command, "-t", request->turbidity);
    if (request->input != ORL_SKY_TYPICAL)
        add_option(&command, request->input == ORL_SKY_DIFFUSE_LX ? "-B" : "-b",
                   request->first / ORL_EFFICACY_LM_PER_W);
    if (request->direct_normal_lx >= 0)
        add_option(&command, "-r",
                   request->direct_normal_lx / ORL_EFFICACY_LM_PER_W / disc_sr(gensky_disc_deg));
    return orl_gensky_numbers(command.words, command.count, placed, text, ret_numbers, err);
}

/* ---- Normalisation --------------------------------------------------------------------------- */

/* Returns the index of the sky's brightness in pattern->a; the ground's is the next. */
static int brightness_argument(const struct orl_sky *pattern)
{
    return pattern->kind == ORL_SKY_PEREZ ? 0 : 1;
}

/* Returns the irradiance from the pattern's upper half with these two brightnesses. */
static double horizontal_irradiance(const struct orl_sky *pattern, double sky, double ground)
{
    struct orl_sky changed = *pattern;
    const int at = brightness_argument(pattern);
    changed.a[at] = sky;
    changed.a[at + 1] = ground;
    return orl_sky_horizontal(&changed);
}

double orl_daylight_direct_normal(const struct orl_daylight *daylight)
{
    return daylight->sun_radiance * disc_sr(daylight->sun_angle_deg);
}

struct orl_sky_balance orl_daylight_balance(const struct orl_daylight *daylight, double diffuse,
                                            double reflectance, double per_sky, double per_ground)
{
    const double direct = orl_daylight_direct_normal(daylight) * fmax(0.0, daylight->sun.z);
    const double ground = reflectance / ORL_PI * (diffuse + direct);
    return (struct orl_sky_balance){(diffuse - ground * per_ground) / per_sky, ground};
}

/*
 * Scales the sky to its given diffuse flux, if there is one (diffuse >= 0), and sets the ground to
 * what sun and sky reflect from it. The ground also shines a little above the horizon, because
 * skybright blends the two there. So one depends on the other, linearly except where the model's
 * negative values are clamped. A last step therefore corrects the remaining difference.
 */
static void normalise(struct orl_daylight *daylight, double diffuse, double reflectance)
{
    struct orl_sky *pattern = &daylight->pattern;
    double *sky = pattern->a + brightness_argument(pattern), *ground = sky + 1;
    const double per_sky = horizontal_irradiance(pattern, 1, 0);
    const double per_ground = horizontal_irradiance(pattern, 0, 1);
    const double direct = orl_daylight_direct_normal(daylight) * fmax(0.0, daylight->sun.z);
    const double share = reflectance / ORL_PI;
    if (!(per_sky > 0))
        return;
    if (diffuse < 0)
        diffuse = (*sky * per_sky + share * direct * per_ground) / (1.0 - share * per_ground);
    const struct orl_sky_balance balance =
        orl_daylight_balance(daylight, diffuse, reflectance, per_sky, per_ground);
    *ground = balance.ground;
    *sky = balance.sky;
    *sky += (diffuse - horizontal_irradiance(pattern, *sky, *ground)) / per_sky;
    *sky = fmax(*sky, 0.0);
}

/* ---- Horizon --------------------------------------------------------------------------------- */

static double altitude_of(struct orl_vec3 sun)
{
    return atan2(sun.z, hypot(sun.x, sun.y));
}

/* Returns the direction with the same azimuth and another altitude. */
static struct orl_vec3 sun_at_altitude(struct orl_vec3 sun, double altitude_rad)
{
    const double level = hypot(sun.x, sun.y);
    if (!(level > 0))
        return sun;
    return orl_v3(sun.x / level * cos(altitude_rad), sun.y / level * cos(altitude_rad),
                  sin(altitude_rad));
}

/*
 * Replaces the sun's disc by the part above the horizon: a smaller disc of the same radiance, area
 * and centroid. So the flux, its direction, and (to first order) the irradiance of level ground are
 * those of the segment. With the sun's centre h radii above the horizon, the share of the disc
 * above it is 1 - (acos h - h sqrt(1 - h^2)) / pi, and its moment is 2/3 (1 - h^2)^(3/2).
 */
static void cut_by_horizon(struct orl_daylight *daylight)
{
    const double radius = 0.5 * daylight->sun_angle_deg * ORL_DEG_TO_RAD;
    const double altitude = altitude_of(daylight->sun), h = altitude / radius;
    const double side2 = fmax(0, 1 - h * h);
    double share;
    if (h >= 1)
        return;
    share = h > -1 ? 1 - (acos(h) - h * sqrt(side2)) / ORL_PI : 0;
    if (!(share > 1e-9)) {
        daylight->sun_radiance = 0;
        return;
    }
    daylight->sun = sun_at_altitude(daylight->sun, altitude + radius * 2.0 / 3.0 * side2 *
                                                                  sqrt(side2) / (ORL_PI * share));
    daylight->sun_angle_deg *= sqrt(share);
}

/* Returns true if the sun's centre has set and its rim has not. The models round, and let it set
 * a little early. */
static bool is_half_set(struct orl_vec3 sun)
{
    const double rounding = 1e-5;
    return sun.z <= rounding && altitude_of(sun) > -half_disc_rad;
}

/* ---- Entry points ---------------------------------------------------------------------------- */

static void warn_site(const struct orl_sky_request *request, struct orl_text *text)
{
    const double hours = orl_sun_hours_apart(request->longitude_deg / 15.0, request->time_zone_h);
    if (request->time_given && fabs(hours) > 3.0)
        orl_text_warn(
            text, "longitude and time zone differ by %.1f hours (both count positive to the east)",
            fabs(hours));
}

static bool needs_sun(const struct orl_sky *pattern)
{
    return pattern->kind == ORL_SKY_PEREZ || pattern->n_args == 7;
}

/* Computes the sky's numbers. placed: the sun's position; NULL: as the programs compute it. */
static int find_numbers(const struct orl_sky_request *request,
                        const struct orl_sun_position *placed, struct orl_text *text,
                        struct orl_sky_numbers *ret_numbers, struct orl_error *err)
{
    const int code = request->model == ORL_SKY_BY_CIE
                         ? find_cie(request, placed, text, ret_numbers, err)
                         : find_perez(request, placed, text, ret_numbers, err);
    if (code == 0 && placed)
        ret_numbers->sun = ret_numbers->true_sun;
    return code;
}

/*
 * Computes the numbers for a half-set sun. The models have no sun below the horizon, so until the
 * whole disc has set the sky is that of a sun on the horizon. The position of the sun itself stays.
 */
static int find_half_set(const struct orl_sky_request *request,
                         const struct orl_sun_position *placed, struct orl_text *text,
                         struct orl_sky_numbers *numbers, struct orl_error *err)
{
    const struct orl_vec3 sun = numbers->sun;
    struct orl_sun_position risen = *placed;
    risen.altitude_rad = 1e-6 * ORL_DEG_TO_RAD;
    text->warnings[0] = '\0'; /* discards the models' warnings about a setting sun */
    const int code = find_numbers(request, &risen, text, numbers, err);
    numbers->sun = sun;
    return code;
}

/*
 * Handles a Perez model that grows without bound towards the horizon (a strong sun low in a bright
 * sky), for which gendaylit's sky is black. With a measured flux the sky is not black. Sun and flux
 * stay, and the rest of the pattern, its glow around the sun, is scaled to them.
 */
static void replace_missing_gradation(struct orl_sky_numbers *numbers, bool by_flux,
                                      struct orl_text *text)
{
    if (!numbers->no_gradation)
        return;
    numbers->black = !by_flux;
    if (by_flux)
        numbers->pattern.a[0] = 1;
    orl_text_warn(text, by_flux ? "the sky model gives no valid values here: the sky is used "
                                  "without its change from zenith to horizon"
                                : "the sky model gives no valid values here: the sky is black");
}

/* Warns that the sun is below the horizon, and how much of the requested light is left out. */
static void warn_night(const struct orl_sky_request *request, struct orl_vec3 sun,
                       struct orl_text *text)
{
    const bool measured = request->model == ORL_SKY_BY_PEREZ && request->input != ORL_SKY_INDICES;
    const bool two = request->input != ORL_SKY_GLOBAL_W;
    const char *unit = request->input == ORL_SKY_NORMAL_LX ? "lx" : "W/m2";
    if (!measured || !(request->first > 0 || (two && request->second > 0))) {
        orl_text_warn(text, "the sun is below the horizon: the sky is black");
        return;
    }
    const double below_deg = -altitude_of(sun) / ORL_DEG_TO_RAD;
    if (two)
        orl_text_warn(text,
                      "the sun is %.1f degrees below the horizon: the sky is black, and %g %s "
                      "direct and %g %s diffuse are left out",
                      below_deg, request->first, unit, request->second, unit);
    else
        orl_text_warn(text,
                      "the sun is %.1f degrees below the horizon: the sky is black, and %g %s are "
                      "left out",
                      below_deg, request->first, unit);
    if (request->time_given && below_deg > 1)
        orl_text_warn(text, "check the signs of longitude and time zone (east is positive here and "
                            "in EPW, west in WEA) and whether times are shifted");
}

/* Computes all but the balance of sky and ground; *ret_diffuse is the diffuse irradiance for
 * that. */
static int find_unbalanced(const struct orl_sky_request *request, struct orl_text *text,
                           struct orl_daylight *daylight, double *ret_diffuse,
                           struct orl_error *err)
{
    const bool by_flux = request->normalise == ORL_SKY_FLUX;
    const struct orl_sun_position placed = sun_of(request);
    struct orl_sky_numbers numbers;
    int code = find_numbers(request, by_flux ? &placed : NULL, text, &numbers, err);
    bool half_set = false;
    if (code == 0 && by_flux && needs_sun(&numbers.pattern) && is_half_set(numbers.sun)) {
        half_set = true;
        code = find_half_set(request, &placed, text, &numbers, err);
    }
    if (code < 0)
        return code;
    warn_site(request, text);
    replace_missing_gradation(&numbers, by_flux, text);
    daylight->pattern = numbers.pattern;
    daylight->sun = numbers.sun;
    daylight->sun_radiance = numbers.sun_radiance;
    daylight->sun_angle_deg = numbers.sun_angle_deg;
    daylight->black = numbers.black;
    *ret_diffuse = numbers.diffuse;
    if (!half_set && needs_sun(&numbers.pattern) && numbers.sun.z <= 0 &&
        (by_flux || !numbers.black)) {
        warn_night(request, numbers.sun, text);
        daylight->black = true;
    }
    if (!daylight->black && by_flux) {
        /* The disc of our conventions, with the same flux; gensky's is smaller. */
        daylight->sun_radiance =
            numbers.sun_measured * (disc_sr(numbers.sun_angle_deg) / disc_sr(ORL_SUN_DIAMETER_DEG));
        daylight->sun_angle_deg = ORL_SUN_DIAMETER_DEG;
        cut_by_horizon(daylight);
    }
    return 0;
}

/* Sets time and site of a request to those of a weather row. */
static void set_time_of_row(const struct orl_weather *weather, const struct orl_weather_row *row,
                            struct orl_sky_request *request)
{
    request->time_given = true;
    request->year = row->year;
    request->month = row->month;
    request->day = row->day;
    request->hour = row->hour;
    request->interval_h = weather->interval_h;
    request->latitude_deg = weather->latitude_deg;
    request->longitude_deg = weather->longitude_deg;
    request->time_zone_h = weather->time_zone_h;
}

double orl_daylight_altitude_of_row(const struct orl_weather *weather,
                                    const struct orl_weather_row *row)
{
    struct orl_sky_request request = {.sun_method = weather->sun_method};
    set_time_of_row(weather, row, &request);
    return sun_of(&request).altitude_rad / ORL_DEG_TO_RAD;
}

/* Limits the direct normal light of a low sun to the solar constant, with a warning: programs
 * divide by the sine of its altitude. An impossible value of a high sun is left, and refused
 * later. */
static void limit_low_sun(const struct orl_weather *weather, const struct orl_weather_row *row,
                          struct orl_sky_request *request, struct orl_text *text)
{
    static const double low_deg = 10;
    const bool lux = weather->units == ORL_WEATHER_NORMAL_LX;
    const double most = lux ? ORL_DAYLIGHT_MOST_LX : ORL_DAYLIGHT_MOST_W;
    if (weather->units == ORL_WEATHER_HORIZONTAL_W || request->first <= most ||
        orl_daylight_altitude_of_row(weather, row) > low_deg)
        return;
    orl_text_warn(text,
                  "line %d of the weather file: %g %s of direct light from a low sun are reduced "
                  "to %g, the maximum for sunlight",
                  row->line, request->first, lux ? "lx" : "W/m2", most);
    request->first = most;
}

/* Converts a weather row to the Perez sky that it stands for, at the middle of its interval. */
static int fill_request_from_row(const struct orl_weather *weather,
                                 const struct orl_weather_row *row, struct orl_sky_request *request,
                                 struct orl_text *text, struct orl_error *err)
{
    static const enum orl_sky_input inputs[] = {[ORL_WEATHER_NORMAL_W] = ORL_SKY_NORMAL_W,
                                                [ORL_WEATHER_HORIZONTAL_W] = ORL_SKY_HORIZONTAL_W,
                                                [ORL_WEATHER_NORMAL_LX] = ORL_SKY_NORMAL_LX};
    if (row->missing) {
        orl_error_set(err, ORL_ERR_RANGE, "sun and sky were not measured at this hour");
        orl_error_at(err, NULL, row->line, NULL);
        return ORL_ERR_RANGE;
    }
    if (row->direct < 0 || row->diffuse < 0)
        orl_text_warn(text, "line %d of the weather file: a negative value is read as 0",
                      row->line);
    request->model = ORL_SKY_BY_PEREZ;
    set_time_of_row(weather, row, request);
    request->input = inputs[weather->units];
    request->first = fmax(row->direct, 0.0);
    request->second = fmax(row->diffuse, 0.0);
    limit_low_sun(weather, row, request, text);
    const int code = orl_daylight_check(request, err);
    if (code < 0) {
        orl_error_at(err, NULL, row->line, NULL);
        orl_error_hint(
            err, "correct the row; if other rows are similar, the file's values are not in %s",
            weather->units == ORL_WEATHER_NORMAL_LX ? "lx" : "W/m2");
    }
    return code;
}

static int request_of_row(const struct orl_sky_request *request, const struct orl_weather *weather,
                          struct orl_sky_request *ret_request, struct orl_text *text,
                          struct orl_error *err)
{
    const struct orl_weather_row *row =
        orl_weather_find(weather, request->month, request->day, request->hour);
    if (!row) {
        orl_error_set(err, ORL_ERR_NOT_FOUND, "the file has no row for month %d, day %d, hour %g",
                      request->month, request->day, request->hour);
        return ORL_ERR_NOT_FOUND;
    }
    *ret_request = *request;
    const int code = fill_request_from_row(weather, row, ret_request, text, err);
    if (code == 0 && fabs(row->hour - request->hour) > 1e-6)
        orl_text_warn(text, "the weather file's row for hour %g is used for hour %g", row->hour,
                      request->hour);
    return code;
}

int orl_daylight_from_row(const struct orl_weather *weather, const struct orl_weather_row *row,
                          struct orl_daylight *ret_daylight, double *ret_diffuse,
                          struct orl_error *err)
{
    struct orl_text text = {0};
    struct orl_daylight daylight = {0};
    struct orl_sky_request request;
    orl_sky_request_init(&request);
    request.sun_method = weather->sun_method;
    int code = fill_request_from_row(weather, row, &request, &text, err);
    if (code == 0)
        code = find_unbalanced(&request, &text, &daylight, ret_diffuse, err);
    if (code == 0) {
        snprintf(daylight.warnings, sizeof daylight.warnings, "%s", text.warnings);
        *ret_daylight = daylight;
    }
    orl_text_done(&text);
    return code;
}

/* Uses a bright sky, because sun and disc depend only on place and time. */
struct orl_daylight_sun orl_daylight_sun_of_row(const struct orl_weather *weather,
                                                const struct orl_weather_row *row)
{
    static const double bright_w = 500;
    struct orl_weather place = *weather;
    struct orl_weather_row lit = *row;
    struct orl_daylight daylight = {0};
    double diffuse;
    place.units = ORL_WEATHER_NORMAL_W;
    lit.missing = false;
    lit.direct = lit.diffuse = bright_w;
    if (orl_daylight_from_row(&place, &lit, &daylight, &diffuse, NULL) < 0 || daylight.black ||
        !(daylight.sun_radiance > 0))
        return (struct orl_daylight_sun){.angle_deg = 0};
    return (struct orl_daylight_sun){daylight.sun, daylight.sun_angle_deg};
}

int orl_daylight_from_request(const struct orl_sky_request *request,
                              const struct orl_weather *weather, struct orl_daylight *ret_daylight,
                              struct orl_error *err)
{
    struct orl_text text = {0};
    struct orl_daylight daylight = {0};
    struct orl_sky_request row;
    double diffuse;
    int code = 0;
    if (request->model == ORL_SKY_BY_WEATHER) {
        code = request_of_row(request, weather, &row, &text, err);
        request = &row;
    }
    if (code == 0)
        code = find_unbalanced(request, &text, &daylight, &diffuse, err);
    if (code == 0) {
        if (!daylight.black && request->normalise == ORL_SKY_FLUX)
            normalise(&daylight, diffuse, request->ground_reflectance);
        snprintf(daylight.warnings, sizeof daylight.warnings, "%s", text.warnings);
        *ret_daylight = daylight;
    }
    orl_text_done(&text);
    return code;
}

/*
 * gensky: CIE clear, intermediate, overcast and uniform skies.
 * References: gensky(1) of Radiance; CIE No. 22 (TC-4.2), 1973, for the clear sky; the zenith
 * brightness of a clear sky by turbidity after Dogniaux.
 */
#include "scene/generate/generate.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "base/text/words.h"
#include "scene/generate/sky/sky_models.h"
#include "scene/generate/sky/sun.h"

/* First argument of skybright.cal. */
enum sky { SKY_CLEAR = 1, SKY_OVERCAST = 2, SKY_UNIFORM = 3, SKY_INTERMEDIATE = 4 };

/* Form in which a brightness was given on the command line. */
enum given { GIVEN_NOT, GIVEN_RADIANCE, GIVEN_IRRADIANCE };

/* Efficacies, lm/W, by which the program converts its empirical luminances to radiances. */
#define SKY_EFFICACY 203.0
#define SUN_EFFICACY 208.0

struct gensky {
    struct orl_location site;
    struct orl_moment moment;
    struct orl_sun_position sun;
    const struct orl_sun_position
        *sun_override; /* sun position from the caller; NULL: from the words */
    bool by_angle, zone_given;
    enum sky type;
    bool with_sun;
    enum given zenith_given, solar_given;
    double zenith, solar, turbidity, ground_reflectance;
    struct orl_vec3 direction, true_direction;
    double shape; /* A4: the CIE formula's value at the sun's zenith distance */
    double ground;
    double diffuse; /* horizontal irradiance as given (-B), or -1 */
};

struct zone {
    char name[5];
    double meridian_deg; /* west */
};

static int set_zone(struct gensky *sky, const char *name, struct orl_error *err)
{
    static const struct zone zones[] = {
        {"YST", 135},  {"YDT", 120},   {"PST", 120},  {"PDT", 105}, {"MST", 105},   {"MDT", 90},
        {"CST", 90},   {"CDT", 75},    {"EST", 75},   {"EDT", 60},  {"AST", 60},    {"ADT", 45},
        {"NST", 52.5}, {"NDT", 37.5},  {"GMT", 0},    {"BST", -15}, {"CET", -15},   {"CEST", -30},
        {"EET", -30},  {"EEST", -45},  {"GST", -60},  {"GDT", -75}, {"IST", -82.5}, {"IDT", -97.5},
        {"JST", -135}, {"NZST", -180}, {"NZDT", -195}};
    for (size_t i = 0; i < sizeof zones / sizeof *zones; i++) {
        if (strcasecmp(zones[i].name, name) == 0) {
            sky->site.meridian_rad = zones[i].meridian_deg * ORL_DEG_TO_RAD;
            sky->zone_given = true;
            return 0;
        }
    }
    return orl_error_refuse(
        err, ORL_ERR_SYNTAX,
        "write for example GMT, CET, CEST, EST or PST, or give the meridian with -m",
        "gensky: '%.40s' is not a time zone", name);
}

/* Reads [+]hour, [+]hour.fraction or [+]hour:minutes, and a time zone after standard time. */
static int read_hour(struct gensky *sky, const char *word, struct orl_error *err)
{
    const char *at = word + (*word == '+'), *start = at;
    double hour = 0, minutes = 0;
    size_t digits = strspn(at, "0123456789");
    bool good = digits > 0;
    sky->moment.solar = *word == '+';
    at += digits;
    if (*at == ':') {
        good = good && orl_number_read(start, digits, &hour) == ORL_NUMBER_OK;
        digits = strspn(++at, "0123456789");
        good = good && orl_number_read(at, digits, &minutes) == ORL_NUMBER_OK && minutes < 60;
        at += digits;
    } else {
        if (*at == '.')
            at += 1 + strspn(at + 1, "0123456789");
        good = good && orl_number_read(start, (size_t)(at - start), &hour) == ORL_NUMBER_OK;
    }
    if (!good || hour > 24 || (*at && (sky->moment.solar || !isalpha((unsigned char)*at))))
        return orl_error_refuse(err, ORL_ERR_SYNTAX,
                                "write 14.5, 14:30, 14:30CET, or +14.5 for solar time",
                                "gensky: '%.40s' is not a time of day", word);
    sky->moment.hour = hour + minutes / 60.0;
    return *at ? set_zone(sky, at, err) : 0;
}

static int read_when(struct gensky *sky, struct orl_words *words, struct orl_error *err)
{
    const char *hour = NULL;
    const int code = orl_words_when(words, &sky->sun, &sky->moment, &hour, err);
    sky->by_angle = !hour;
    return code == 0 && hour ? read_hour(sky, hour, err) : code;
}

static int read_option(struct gensky *sky, struct orl_words *words, struct orl_error *err)
{
    double unused;
    const struct orl_words_field fields[] = {
        {'t', false, &sky->turbidity},
        {'g', false, &sky->ground_reflectance},
        {'a', true, &sky->site.latitude_rad},
        {'o', true, &sky->site.longitude_rad},
        /* overridden by a time zone */
        {'m', true, sky->zone_given ? &unused : &sky->site.meridian_rad}};
    const char *option = orl_words_take(words);
    if ((option[0] != '-' && option[0] != '+') || option[1] == '\0' || option[2] != '\0')
        return orl_words_refuse(words, option, err);
    switch (option[1]) {
    case 's':
        sky->type = SKY_CLEAR;
        sky->with_sun = option[0] == '+';
        return 0;
    case 'i':
        sky->type = SKY_INTERMEDIATE;
        sky->with_sun = option[0] == '+';
        return 0;
    case 'c':
        sky->type = SKY_OVERCAST;
        return 0;
    case 'u':
        sky->type = SKY_UNIFORM;
        return 0;
    case 'y':
        return orl_words_int(words, option, 1950, 2050, &sky->moment.year, err);
    case 'r':
    case 'R':
        sky->solar_given = option[1] == 'R' ? GIVEN_IRRADIANCE : GIVEN_RADIANCE;
        return orl_words_number(words, option, &sky->solar, err);
    case 'b':
    case 'B':
        sky->zenith_given = option[1] == 'B' ? GIVEN_IRRADIANCE : GIVEN_RADIANCE;
        return orl_words_number(words, option, &sky->zenith, err);
    default:
        return orl_words_field(words, option, fields, sizeof fields / sizeof *fields, err);
    }
}

static bool is_overcast(const struct gensky *sky)
{
    return sky->type == SKY_OVERCAST || sky->type == SKY_UNIFORM;
}

static void place_sun(struct gensky *sky, struct orl_text *text)
{
    const double highest = 87.0 * ORL_DEG_TO_RAD;
    if (sky->sun_override) {
        sky->sun = *sky->sun_override;
    } else if (!sky->by_angle) {
        double declination, hour;
        orl_sun_clock(&sky->site, &sky->moment, &declination, &hour);
        sky->sun = orl_sun_at(&sky->site, declination, hour);
    }
    sky->true_direction = orl_sun_direction(&sky->sun);
    if (!is_overcast(sky) && sky->sun.altitude_rad > highest) {
        if (!sky->sun_override)
            orl_text_warn(text, "gensky: the sun is too close to the zenith for this sky: its "
                                "altitude is taken as 87 degrees");
        sky->sun.altitude_rad = highest;
    }
    sky->direction = orl_sun_direction(&sky->sun);
}

/* Sets shape and returns horizontal irradiance / (pi * zenith radiance). */
static double normalise(struct gensky *sky)
{
    const enum orl_cie_type type =
        sky->type == SKY_INTERMEDIATE ? ORL_CIE_INTERMEDIATE : ORL_CIE_CLEAR;
    if (sky->type == SKY_UNIFORM)
        return 1.0;
    if (sky->type == SKY_OVERCAST)
        return 0.777778;
    sky->shape = orl_cie_shape(type, sky->sun.altitude_rad);
    return orl_cie_factor(type, sky->sun.altitude_rad);
}

static double zenith_by_model(const struct gensky *sky)
{
    const double overcast = 8.6 * sky->direction.z + 0.123; /* kcd/m2 */
    double value = (1.376 * sky->turbidity - 1.81) * tan(sky->sun.altitude_rad) + 0.38;
    if (is_overcast(sky))
        value = overcast;
    else if (sky->type == SKY_INTERMEDIATE)
        value = (value + overcast) / 2.0;
    return value < 0.0 ? 0.0 : value * 1000.0 / SKY_EFFICACY;
}

/* Sets the solar radiance; returns false if no sun is written. */
static bool find_solar(struct gensky *sky)
{
    const double height = sky->direction.z;
    if (is_overcast(sky) || height <= 0.0 || (sky->solar_given && sky->solar <= 0.0))
        return false;
    if (sky->solar_given == GIVEN_IRRADIANCE) {
        sky->solar /= 5.98e-5 * height;
    } else if (sky->solar_given == GIVEN_NOT) {
        sky->solar = 1.5e9 / SUN_EFFICACY * (1.147 - 0.147 / fmax(height, 0.16));
        if (sky->type == SKY_INTERMEDIATE)
            sky->solar *= 0.15;
    }
    return true;
}

static void find_brightness(struct gensky *sky)
{
    const double factor = normalise(sky);
    sky->diffuse = sky->zenith_given == GIVEN_IRRADIANCE ? sky->zenith : -1.0;
    if (sky->zenith_given == GIVEN_IRRADIANCE)
        sky->zenith /= factor * ORL_PI;
    else if (sky->zenith_given == GIVEN_NOT)
        sky->zenith = zenith_by_model(sky);
    sky->ground = sky->zenith * factor;
    if (find_solar(sky))
        sky->ground += 6e-5 / ORL_PI * sky->solar * sky->direction.z;
    else
        sky->with_sun = false;
    sky->ground *= sky->ground_reflectance;
}

int orl_gensky_numbers(const char *const *words, size_t count,
                       const struct orl_sun_position *sun_override, struct orl_text *text,
                       struct orl_sky_numbers *ret_numbers, struct orl_error *err)
{
    struct gensky sky = {.site = orl_location_default,
                         .sun_override = sun_override,
                         .type = SKY_CLEAR,
                         .with_sun = true,
                         .turbidity = 2.45,
                         .ground_reflectance = 0.2};
    struct orl_words rest = {"gensky", words + 1, count - 1};
    int code = read_when(&sky, &rest, err);
    while (code == 0 && rest.left > 0)
        code = read_option(&sky, &rest, err);
    if (code < 0)
        return code;
    place_sun(&sky, text);
    find_brightness(&sky);
    *ret_numbers = (struct orl_sky_numbers){
        .pattern = {.kind = ORL_SKY_CIE,
                    .a = {(double)sky.type, sky.zenith, sky.ground, sky.shape, sky.direction.x,
                          sky.direction.y, sky.direction.z},
                    .n_args = is_overcast(&sky) ? 3 : 7},
        .has_sun = sky.with_sun,
        .sun = sky.direction,
        .true_sun = sky.true_direction,
        .sun_radiance = sky.with_sun ? sky.solar : 0.0,
        .sun_measured = sky.with_sun ? sky.solar : 0.0,
        .sun_angle_deg = 0.5,
        .diffuse = sky.diffuse,
        .by_clock = !sky.by_angle && !sky.moment.solar,
        .site = sky.site};
    return 0;
}

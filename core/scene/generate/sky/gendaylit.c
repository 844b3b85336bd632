/*
 * gendaylit: the Perez all-weather sky from measured irradiance or illuminance, with its sun.
 * References: gendaylit(1) of Radiance; sky_models.h; Erbs, Klein, Duffie, "Estimation of the
 * diffuse radiation fraction", Solar Energy 28(4), 1982 (option -E); Kasten 1965 (air mass).
 */
#include "scene/generate/generate.h"

#include <string.h>

#include "base/text/words.h"
#include "scene/generate/sky/sky_models.h"
#include "scene/generate/sky/sun.h"

enum input { INPUT_PEREZ, INPUT_NORMAL_W, INPUT_NORMAL_LX, INPUT_HORIZONTAL_W, INPUT_GLOBAL_W };
enum output { OUTPUT_VISIBLE = 0, OUTPUT_SOLAR = 1, OUTPUT_LUMEN = 2 };

/* Extraterrestrial normal irradiance (W/m2) and illuminance (lx), with the program's values. */
#define SOLAR_CONSTANT_W 1367.0
#define SOLAR_CONSTANT_LX 127500.0
#define HALF_SUN_DEG (0.5 * ORL_SUN_DIAMETER_DEG)

struct gendaylit {
    struct orl_location site;
    struct orl_moment moment;
    struct orl_sun_position sun;
    const struct orl_sun_position
        *sun_override; /* sun position from the caller; NULL: from the words */
    bool by_angle, with_sun, cloudy, quiet;
    enum input input;
    enum output output;
    double first, second; /* the numbers behind -P, -W, -L, -G, -E */
    double ground_reflectance, dew_point_c, interval_min;
    /* results */
    struct orl_vec3 direction, true_direction;
    /* sine of the altitude, for converting between horizontal and normal irradiance */
    double height;
    double zenith_deg; /* the sun's zenith angle; at most 90 after air_mass() */
    double clearness, brightness, water_cm;
    double direct_w, diffuse_w, direct_lx, diffuse_lx;
    struct orl_perez shape;
    double normalisation, solar, ground;
};

/* ---- Options --------------------------------------------------------------------------------- */

/* The program reads "12:30" as 12; so does this, with a warning. */
static int read_hour(struct gendaylit *sky, const char *word, struct orl_text *text,
                     struct orl_error *err)
{
    const size_t length = strcspn(word, ":");
    double hour = 0;
    if (orl_number_read(word, length, &hour) != ORL_NUMBER_OK || hour < 0 || hour >= 24)
        return orl_error_refuse(err, ORL_ERR_SYNTAX, "write 14.5, or +14.5 for solar time",
                                "gendaylit: '%.40s' is not a time of day", word);
    if (word[length])
        orl_text_warn(text,
                      "gendaylit reads '%.40s' as %g hours: it does not support minutes; write "
                      "12.5 for half past twelve",
                      word, hour);
    sky->moment.solar = *word == '+';
    sky->moment.hour = hour;
    return 0;
}

static int read_when(struct gendaylit *sky, struct orl_words *words, struct orl_text *text,
                     struct orl_error *err)
{
    const char *hour = NULL;
    const int code = orl_words_when(words, &sky->sun, &sky->moment, &hour, err);
    sky->by_angle = !hour;
    return code == 0 && hour ? read_hour(sky, hour, text, err) : code;
}

static int read_input(struct gendaylit *sky, struct orl_words *words, const char *option,
                      enum input input, struct orl_error *err)
{
    int code = orl_words_number(words, option, &sky->first, err);
    if (code == 0 && input != INPUT_GLOBAL_W)
        code = orl_words_number(words, option, &sky->second, err);
    sky->input = input;
    return code;
}

static int read_output(struct gendaylit *sky, struct orl_words *words, struct orl_error *err)
{
    int kind = 0;
    const int code = orl_words_int(words, "-O", 0, 2, &kind, err);
    sky->output = (enum output)kind;
    return code;
}

/* The letters of inputs, in the order of enum input. */
static const char inputs[] = "PWLGE";

static int read_option(struct gendaylit *sky, struct orl_words *words, struct orl_error *err)
{
    double unused;
    /* R, t and b are accepted without effect, as in the program. */
    const struct orl_words_field fields[] = {{'a', true, &sky->site.latitude_rad},
                                             {'o', true, &sky->site.longitude_rad},
                                             {'m', true, &sky->site.meridian_rad},
                                             {'g', false, &sky->ground_reflectance},
                                             {'d', false, &sky->dew_point_c},
                                             {'i', false, &sky->interval_min},
                                             {'R', false, &unused},
                                             {'t', false, &unused},
                                             {'b', false, &unused}};
    const char *option = orl_words_take(words);
    if ((option[0] != '-' && option[0] != '+') || option[1] == '\0' || option[2] != '\0')
        return orl_words_refuse(words, option, err);
    const char *const input = strchr(inputs, option[1]);
    if (input)
        return read_input(sky, words, option, (enum input)(input - inputs), err);
    switch (option[1]) {
    case 's':
        sky->with_sun = option[0] == '+';
        sky->cloudy = false;
        return 0;
    case 'c':
        sky->with_sun = false;
        sky->cloudy = true;
        return 0;
    case 'w':
        sky->quiet = true;
        return 0;
    case 'y':
        return orl_words_int(words, option, 1950, 2050, &sky->moment.year, err);
    case 'O':
        return read_output(sky, words, err);
    case 'C':
    case 'l':
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "gendaylit: coloured skies (%s) are not supported",
                      option);
        return ORL_ERR_UNSUPPORTED;
    default:
        return orl_words_field(words, option, fields, sizeof fields / sizeof *fields, err);
    }
}

/* ---- The sun --------------------------------------------------------------------------------- */

/* Returns half the day's length in hours by the fitted declination; NaN in polar day and night. */
static double half_day(const struct gendaylit *sky)
{
    const int day = orl_day_of_year(sky->moment.month, sky->moment.day);
    const float w = (float)-(tan(sky->site.latitude_rad) * tan(orl_sun_declination(day)));
    const float rest = 1.0F - w * w;
    return (ORL_PI / 2.0 - atan2(w, sqrt((double)rest))) * 180.0 / (ORL_PI * 15.0);
}

/*
 * Moves a time near sunrise or sunset into the middle of the sunlit time of the interval (-i).
 * Returns false if the sun is down: the program then writes a black sky.
 */
static bool sun_is_up(const struct gendaylit *sky, double *hour, struct orl_text *text)
{
    const double half = half_day(sky), rise = 12.0 - half, set = 12.0 + half;
    const double margin = sky->interval_min / 120.0;
    const double asked = *hour;
    if (sky->interval_min == 0)
        return !(*hour < rise || *hour > set);
    if (fabs(rise - *hour) <= margin)
        *hour = (*hour + margin + rise) / 2.0;
    if (fabs(set - *hour) < margin)
        *hour = (*hour - margin + set) / 2.0;
    if (*hour != asked)
        orl_text_warn(
            text, "gendaylit: the sun was moved to the middle of the sunlit part of the interval");
    return !(*hour < rise - margin || *hour > set + margin);
}

/* Returns false if the sky is black. */
static bool place_sun(struct gendaylit *sky, struct orl_text *text)
{
    const double highest = 87.0 * ORL_DEG_TO_RAD;
    bool up = true;
    if (sky->sun_override) {
        sky->sun = *sky->sun_override;
        up = sky->sun.altitude_rad > 0;
    } else if (!sky->by_angle) {
        double declination, hour;
        orl_sun_clock(&sky->site, &sky->moment, &declination, &hour);
        up = sun_is_up(sky, &hour, text);
        sky->sun = orl_sun_at(&sky->site, declination, hour);
    }
    if (!up && !sky->sun_override)
        orl_text_warn(text, "gendaylit: the sun is below the horizon: the sky is black");
    sky->true_direction = orl_sun_direction(&sky->sun);
    if (up && !sky->cloudy && sky->sun.altitude_rad > highest) {
        if (!sky->quiet && !sky->sun_override)
            orl_text_warn(text, "gendaylit: the sun is too close to the zenith for this sky: its "
                                "altitude is taken as 87 degrees");
        sky->sun.altitude_rad = highest;
    }
    sky->direction = orl_sun_direction(&sky->sun);
    sky->height = sky->sun_override ? sky->true_direction.z : sin(sky->sun.altitude_rad);
    sky->zenith_deg = 90.0 - sky->sun.altitude_rad / ORL_DEG_TO_RAD;
    return up;
}

/* ---- From measurements to clearness and brightness ------------------------------------------- */

static double zenith_rad(const struct gendaylit *sky)
{
    return sky->zenith_deg * ORL_DEG_TO_RAD;
}

/* Relative optical air mass. A sun below the horizon is moved to the horizon, permanently. */
static double air_mass(struct gendaylit *sky)
{
    sky->zenith_deg = fmin(sky->zenith_deg, 90.0);
    return 1.0 / (cos(zenith_rad(sky)) + 0.15 * pow(93.885 - sky->zenith_deg, -1.253));
}

/* Extraterrestrial normal irradiance, with the annual variation of the sun's distance. */
static double extraterrestrial(const struct gendaylit *sky)
{
    const int day = sky->by_angle ? 0 : orl_day_of_year(sky->moment.month, sky->moment.day);
    const double t = 2.0 * ORL_PI * (day - 1) / 365.0;
    return SOLAR_CONSTANT_W * (1.00011 + 0.034221 * cos(t) + 0.00128 * sin(t) +
                               0.000719 * cos(2.0 * t) + 0.000077 * sin(2.0 * t));
}

static double cubed_zenith(const struct gendaylit *sky)
{
    const double z = zenith_rad(sky);
    return 1.041 * z * z * z;
}

static void clamp_indices(struct gendaylit *sky)
{
    if (sky->clearness < ORL_PEREZ_CLEARNESS_MIN)
        sky->clearness = ORL_PEREZ_CLEARNESS_MIN;
    if (sky->clearness > ORL_PEREZ_CLEARNESS_MAX)
        sky->clearness = ORL_PEREZ_CLEARNESS_MAX - 0.001;
    sky->brightness =
        fmin(fmax(sky->brightness, ORL_PEREZ_BRIGHTNESS_MIN), ORL_PEREZ_BRIGHTNESS_MAX);
}

/* Perez 1990, equations 1 and 2. The order matters: air_mass() limits the zenith angle. */
static void find_brightness(struct gendaylit *sky)
{
    sky->brightness = sky->diffuse_w * air_mass(sky) / extraterrestrial(sky);
}
static void find_clearness(struct gendaylit *sky)
{
    const double k = cubed_zenith(sky);
    sky->clearness = ((sky->diffuse_w + sky->direct_w) / sky->diffuse_w + k) / (1.0 + k);
}

static void irradiance_from_indices(struct gendaylit *sky)
{
    sky->clearness = sky->first;
    sky->brightness = sky->second;
    clamp_indices(sky);
    sky->diffuse_w = sky->brightness / air_mass(sky) * extraterrestrial(sky);
    sky->direct_w = sky->diffuse_w * ((sky->clearness - 1.0) * (1.0 + cubed_zenith(sky)));
}

/* Splits global horizontal irradiance after Erbs 1982. */
static void split_global(struct gendaylit *sky, struct orl_text *text)
{
    const double height = sky->height, most = extraterrestrial(sky) * height;
    double global = sky->first, kt, fraction = 0.165;
    sky->diffuse_w = sky->direct_w = 0;
    if (sky->sun.altitude_rad <= 0)
        return;
    if (global > most) {
        orl_text_warn(text,
                      "gendaylit: the global irradiance exceeds the extraterrestrial irradiance");
        global = most * 0.999;
    }
    kt = global / most;
    if (kt <= 0.22)
        fraction = 1.0 - 0.09 * kt;
    else if (kt <= 0.8)
        fraction = 0.9511 + kt * (-0.1604 + kt * (4.388 + kt * (-16.638 + kt * 12.336)));
    sky->diffuse_w = global * fraction;
    sky->direct_w = (global - sky->diffuse_w) / height;
}

static double diffuse_efficacy(const struct gendaylit *sky)
{
    return orl_perez_diffuse_efficacy(orl_perez_bin(sky->clearness), sky->brightness,
                                      zenith_rad(sky), sky->water_cm);
}
static double direct_efficacy(const struct gendaylit *sky)
{
    return orl_perez_direct_efficacy(orl_perez_bin(sky->clearness), sky->brightness,
                                     zenith_rad(sky), sky->water_cm);
}

/*
 * Finds the irradiances for given illuminances. Efficacies depend on the result, so nine iterations
 * are made. The program makes nine, too: within the model's range its test for an early end is
 * never true.
 */
static bool irradiance_from_illuminance(struct gendaylit *sky)
{
    sky->diffuse_w = sky->diffuse_lx * SOLAR_CONSTANT_W / SOLAR_CONSTANT_LX;
    sky->direct_w = sky->direct_lx * SOLAR_CONSTANT_W / SOLAR_CONSTANT_LX;
    find_clearness(sky);
    find_brightness(sky);
    clamp_indices(sky);
    for (int round = 0; round < 9; round++) {
        if (orl_perez_bin(sky->clearness) < 0)
            return false;
        sky->diffuse_w = sky->diffuse_lx / diffuse_efficacy(sky);
        const double efficacy = direct_efficacy(sky);
        sky->direct_w = efficacy < 0.1 ? 0.0 : sky->direct_lx / efficacy;
        find_brightness(sky);
        find_clearness(sky);
        clamp_indices(sky);
    }
    return true;
}

/* ---- The sky --------------------------------------------------------------------------------- */

/* Clamps negative values to 0. Returns false, with a warning, if the sky is black. */
static bool check_pair(const struct gendaylit *sky, double *direct, double *diffuse, double most,
                       const char *what, struct orl_text *text)
{
    if (*direct < 0 || *diffuse < 0)
        orl_text_warn(text, "gendaylit: negative %s is taken as 0", what);
    *direct = fmax(*direct, 0.0);
    *diffuse = fmax(*diffuse, 0.0);
    if (*direct + *diffuse == 0.0 && sky->sun.altitude_rad > 0) {
        orl_text_warn(text, "gendaylit: zero %s with the sun up: the sky is black", what);
        return false;
    }
    if (*direct > most) {
        orl_text_warn(text, "gendaylit: direct %s exceeds the solar constant: the sky is black",
                      what);
        return false;
    }
    return true;
}

static bool check_irradiance(struct gendaylit *sky, struct orl_text *text)
{
    return check_pair(sky, &sky->direct_w, &sky->diffuse_w, SOLAR_CONSTANT_W, "irradiance", text);
}
static bool check_illuminance(struct gendaylit *sky, struct orl_text *text)
{
    return check_pair(sky, &sky->direct_lx, &sky->diffuse_lx, SOLAR_CONSTANT_LX, "illuminance",
                      text);
}

/* Sets irradiances, clearness and brightness from the input. Returns false for a black sky. */
static bool find_indices(struct gendaylit *sky, struct orl_text *text)
{
    switch (sky->input) {
    case INPUT_PEREZ:
        irradiance_from_indices(sky);
        return check_irradiance(sky, text);
    case INPUT_NORMAL_LX:
        sky->direct_lx = sky->first;
        sky->diffuse_lx = sky->second;
        return check_illuminance(sky, text) && irradiance_from_illuminance(sky);
    case INPUT_HORIZONTAL_W:
        sky->direct_w = sky->sun.altitude_rad > 0 ? sky->first / sky->height : 0.0;
        sky->diffuse_w = sky->sun.altitude_rad > 0 ? sky->second : 0.0;
        break;
    case INPUT_GLOBAL_W:
        split_global(sky, text);
        break;
    default:
        sky->direct_w = sky->first;
        sky->diffuse_w = sky->second;
    }
    if (!check_irradiance(sky, text))
        return false;
    find_brightness(sky);
    find_clearness(sky);
    clamp_indices(sky);
    return true;
}

/* Computes illuminances for the outputs that need them. Returns false for a black sky. */
static bool find_illuminance(struct gendaylit *sky, struct orl_text *text)
{
    if (orl_perez_bin(sky->clearness) < 0) {
        orl_text_warn(text, "gendaylit: the sky is outside the model's range: it is black");
        return false;
    }
    if (sky->output == OUTPUT_SOLAR || sky->input == INPUT_NORMAL_LX)
        return true;
    sky->diffuse_lx = sky->diffuse_w * diffuse_efficacy(sky);
    sky->direct_lx = sky->direct_w * direct_efficacy(sky);
    return check_illuminance(sky, text);
}

/* The ground's factor of zenith radiance, from the closest CIE sky. */
static double ground_factor(const struct gendaylit *sky)
{
    if (sky->clearness == 1.0)
        return 0.777778;
    return orl_cie_factor(sky->clearness >= 6.0 ? ORL_CIE_CLEAR : ORL_CIE_INTERMEDIATE,
                          sky->sun.altitude_rad);
}

static void find_radiances(struct gendaylit *sky, struct orl_text *text)
{
    const double disc_sr = 2.0 * ORL_PI * (1.0 - cos(HALF_SUN_DEG * ORL_DEG_TO_RAD));
    const bool solar_output = sky->output == OUTPUT_SOLAR;
    const double unit = sky->output == OUTPUT_VISIBLE ? ORL_EFFICACY_LM_PER_W : 1.0;
    const double z = zenith_rad(sky);
    sky->shape = orl_perez_shape(z, sky->clearness, sky->brightness);
    sky->normalisation = (solar_output ? sky->diffuse_w : sky->diffuse_lx) /
                         orl_perez_patch_integral(&sky->shape, z) / unit;
    sky->solar = (solar_output ? sky->direct_w : sky->direct_lx) / disc_sr / unit;
    if (sky->sun.altitude_rad <= -HALF_SUN_DEG * ORL_DEG_TO_RAD) {
        /* The program includes direct light from below the horizon. */
        if (sky->with_sun && sky->solar > 0)
            orl_text_warn(text,
                          "gendaylit: the sun is below the horizon: its direct light is ignored");
        sky->with_sun = false;
        sky->solar = 0.0;
    }
    sky->ground =
        orl_perez_luminance(&sky->shape, 0.0, z) * sky->normalisation * ground_factor(sky);
    if (sky->with_sun && sky->clearness > 1.0)
        sky->ground += 6.8e-5 / ORL_PI * sky->solar * sky->direction.z;
    sky->ground *= sky->ground_reflectance;
}

/* Computes radiances from the options. Returns false for a black sky. */
static bool compute_sky(struct gendaylit *sky, struct orl_text *text)
{
    if (sky->dew_point_c < -40 || sky->dew_point_c > 40)
        sky->dew_point_c = 10.97353115;
    sky->water_cm = exp(0.07 * sky->dew_point_c - 0.075); /* Perez 1990, equation 3 */
    if (!place_sun(sky, text) || !find_indices(sky, text) || !find_illuminance(sky, text))
        return false;
    find_radiances(sky, text);
    return true;
}

static void store_numbers(const struct gendaylit *sky, struct orl_sky_numbers *numbers)
{
    const double *c = sky->shape.c;
    const struct orl_vec3 d = sky->direction;
    *numbers = (struct orl_sky_numbers){
        .pattern = {.kind = ORL_SKY_PEREZ,
                    .a = {sky->normalisation, sky->ground, c[0], c[1], c[2], c[3], c[4]},
                    .n_args = 10},
        .has_sun = sky->with_sun,
        .sun = d,
        .true_sun = sky->true_direction,
        .sun_radiance = sky->with_sun && sky->clearness > 1.0 ? sky->solar : 0.0,
        .sun_measured = sky->solar,
        .black = c[1] > 0, /* the formula diverges at the horizon */
        .no_gradation = c[1] > 0,
        .sun_angle_deg = 2.0 * HALF_SUN_DEG,
        .diffuse = sky->output == OUTPUT_SOLAR ? sky->diffuse_w : sky->diffuse_lx};
    numbers->diffuse /= sky->output == OUTPUT_VISIBLE ? ORL_EFFICACY_LM_PER_W : 1.0;
    if (numbers->no_gradation)
        numbers->pattern.a[2] = numbers->pattern.a[3] = 0;
}

int orl_gendaylit_numbers(const char *const *words, size_t count,
                          const struct orl_sun_position *sun_override, struct orl_text *text,
                          struct orl_sky_numbers *ret_numbers, struct orl_error *err)
{
    struct gendaylit sky = {.site = orl_location_default,
                            .sun_override = sun_override,
                            .with_sun = true,
                            .ground_reflectance = 0.2,
                            .dew_point_c = 10.97353115};
    struct orl_words rest = {"gendaylit", words + 1, count - 1};
    int code = read_when(&sky, &rest, text, err);
    while (code == 0 && rest.left > 0)
        code = read_option(&sky, &rest, err);
    if (code == 0 && sky.interval_min < 0)
        code = orl_error_set(err, ORL_ERR_RANGE, "gendaylit: the interval -i is negative");
    if (code < 0)
        return code;
    if (compute_sky(&sky, text))
        store_numbers(&sky, ret_numbers);
    else
        *ret_numbers = (struct orl_sky_numbers){.pattern = {.kind = ORL_SKY_PEREZ, .n_args = 10},
                                                .black = true,
                                                .sun = sky.direction,
                                                .true_sun = sky.true_direction};
    memcpy(ret_numbers->pattern.a + 7,
           (double[3]){sky.direction.x, sky.direction.y, sky.direction.z}, 3 * sizeof(double));
    ret_numbers->by_clock = !sky.by_angle && !sky.moment.solar;
    ret_numbers->site = sky.site;
    return 0;
}

#include "recipe/recipe_sky.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/job/sun_position.h>

enum { TEXT_SIZE = 512, MOST_WORDS = 40 };

/* Words of a sky, and what they say. */
struct sky_reader {
    char text[TEXT_SIZE];
    char *words[MOST_WORDS];
    size_t n_words;
    bool has_time, is_uniform;
    struct orl_sun_time time;
    double value, altitude, azimuth, time_zone, north, type, ground, direct, diffuse;
    struct orl_error *err;
};

static int fail(const struct sky_reader *reader, const char *word, const char *what)
{
    orl_error_set(reader->err, ORL_ERR_INVALID, "sky: '%.60s': %s", word, what);
    orl_error_hint(reader->err,
                   "a sky is a text such as \"cie 21 Jun 12:00 -lat 42 -lon -71 -tz -5\" "
                   "or \"climate-based -alt 60 -az 180 -dni 800 -dhi 120\"");
    return ORL_ERR_INVALID;
}

static bool read_number(const char *word, double *ret_value)
{
    char *end;
    const double value = strtod(word, &end);
    if (end == word || *end != '\0' || !isfinite(value))
        return false;
    *ret_value = value;
    return true;
}

/* Reads "21 Jun 12:00" from three words. */
static int read_time(struct sky_reader *reader, char *const words[3])
{
    static const char *const months[] = {"jan", "feb", "mar", "apr", "may", "jun",
                                         "jul", "aug", "sep", "oct", "nov", "dec"};
    char *end;
    for (int m = 0; m < 12; m++)
        if (strncasecmp(words[1], months[m], 3) == 0)
            reader->time.month = m + 1;
    reader->time.day = (int)strtol(words[0], NULL, 10);
    const long hour = strtol(words[2], &end, 10),
               minute = *end == ':' ? strtol(end + 1, &end, 10) : -1;
    if (reader->time.month == 0 || reader->time.day < 1 || reader->time.day > 31 || *end != '\0' ||
        hour < 0 || hour > 23 || minute < 0 || minute > 59)
        return fail(reader, words[0], "a time such as \"21 Jun 12:00\" is expected");
    reader->time.hour = (double)hour + (double)minute / 60;
    reader->has_time = true;
    return 0;
}

static int read_option(struct sky_reader *reader, size_t *at)
{
    const struct {
        const char *name, *long_name;
        double *value;
    } options[] = {{"-lat", "--latitude", &reader->time.latitude_deg},
                   {"-lon", "--longitude", &reader->time.longitude_deg},
                   {"-tz", "--time-zone", &reader->time_zone},
                   {"-n", "--north", &reader->north},
                   {"-alt", "--altitude", &reader->altitude},
                   {"-az", "--azimuth", &reader->azimuth},
                   {"-type", "--sky-type", &reader->type},
                   {"-g", "--ground", &reader->ground},
                   {"-dni", "--direct-normal-irradiance", &reader->direct},
                   {"-dhi", "--diffuse_horizontal_irradiance", &reader->diffuse}};
    const char *word = reader->words[*at];
    if (strcmp(word, "-u") == 0 || strcmp(word, "--uniform") == 0) {
        reader->is_uniform = true;
        return 0;
    }
    if (strcmp(word, "--cloudy") == 0)
        return 0;
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        if (strcmp(word, options[i].name) != 0 && strcmp(word, options[i].long_name) != 0)
            continue;
        *at += 1;
        if (*at >= reader->n_words || !read_number(reader->words[*at], options[i].value))
            return fail(reader, word, "a number is expected behind it");
        return 0;
    }
    return fail(reader, word, "this word is not known");
}

static int split(const char *text, struct sky_reader *reader)
{
    char *rest = NULL;
    if (strlen(text) >= sizeof reader->text)
        return fail(reader, text, "the text is too long");
    snprintf(reader->text, sizeof reader->text, "%s", text);
    for (char *word = strtok_r(reader->text, " \t", &rest); word && reader->n_words < MOST_WORDS;
         word = strtok_r(NULL, " \t", &rest))
        reader->words[reader->n_words++] = word;
    return reader->n_words > 0 && !rest[0] ? 0 : fail(reader, text, "a sky is expected");
}

/* Reads the words behind the first. */
static int read_words(struct sky_reader *reader, bool has_value)
{
    size_t at = 1;
    int rc = 0;
    if (has_value) {
        if (at >= reader->n_words || !read_number(reader->words[at], &reader->value))
            return fail(reader, reader->words[0], "a number is expected behind it");
        at++;
    } else if (at < reader->n_words && reader->words[at][0] != '-') {
        if (at + 2 >= reader->n_words)
            return fail(reader, reader->words[at], "a time has day, month and hour");
        rc = read_time(reader, &reader->words[at]);
        at += 3;
    }
    for (; at < reader->n_words && rc == 0; at++)
        rc = read_option(reader, &at);
    return rc;
}

/* Finds the sun, in degrees, and its azimuth from south towards west in the scene. */
static void place_sun(const struct sky_reader *reader, double *ret_altitude, double *ret_azimuth)
{
    struct orl_sun_time time = reader->time;
    if (!reader->has_time) {
        *ret_altitude = reader->altitude;
        *ret_azimuth = remainder(reader->azimuth - 180, 360);
        return;
    }
    time.is_solar = isnan(reader->time_zone);
    time.time_zone_h = reader->time_zone;
    orl_sun_angles(&time, ret_altitude, ret_azimuth);
    *ret_azimuth = remainder(*ret_azimuth - reader->north, 360);
}

/* Honeybee's sky types: sunny, intermediate, each with and without sun; cloudy; uniform. */
static json_t *make_cie(const struct sky_reader *reader)
{
    static const char *const types[] = {"clear",        "clear",    "intermediate",
                                        "intermediate", "overcast", "uniform"};
    const int type = (int)reader->type;
    double altitude, azimuth;
    place_sun(reader, &altitude, &azimuth);
    json_t *cie = json_pack("{s:s, s:f, s:f, s:f}", "type", types[type], "sun_altitude", altitude,
                            "sun_azimuth", azimuth, "ground_reflectance", reader->ground);
    if (type == 1 || type == 3)
        json_object_set_new(cie, "direct_normal_lx", json_integer(0));
    return json_pack("{s:o, s:s}", "cie", cie, "normalise", "gendaylit");
}

static json_t *make_climate(const struct sky_reader *reader)
{
    double altitude, azimuth;
    place_sun(reader, &altitude, &azimuth);
    return json_pack("{s:{s:f, s:f, s:f, s:f, s:f}, s:s}", "perez", "sun_altitude", altitude,
                     "sun_azimuth", azimuth, "direct_normal_w_m2", reader->direct,
                     "diffuse_horizontal_w_m2", reader->diffuse, "ground_reflectance",
                     reader->ground, "normalise", "gendaylit");
}

static json_t *make_diffuse(const struct sky_reader *reader, double lx)
{
    return json_pack("{s:{s:s, s:f, s:f}}", "cie", "type",
                     reader->is_uniform ? "uniform" : "overcast", "diffuse_horizontal_lx", lx,
                     "ground_reflectance", reader->ground);
}

int orl_recipe_sky_to_json(const char *text, json_t **ret_sky, struct orl_error *err)
{
    static const double lm_per_w = 179; /* Radiance's luminous efficacy of white light */
    struct sky_reader reader = {.time_zone = NAN, .altitude = 90, .ground = 0.2, .err = err};
    int rc = split(text, &reader);
    if (rc)
        return rc;
    const char *kind = reader.words[0];
    const bool is_cie = strcasecmp(kind, "cie") == 0,
               is_climate = strcasecmp(kind, "climate-based") == 0,
               is_lux = strcasecmp(kind, "illuminance") == 0,
               is_watt = strcasecmp(kind, "irradiance") == 0;
    if (!is_cie && !is_climate && !is_lux && !is_watt)
        return fail(&reader, kind,
                    "a sky begins with cie, climate-based, illuminance or irradiance");
    rc = read_words(&reader, is_lux || is_watt);
    if (rc == 0 && (reader.type < 0 || reader.type > 5 || reader.type != floor(reader.type)))
        rc = fail(&reader, "-type", "a whole number from 0 to 5 is expected behind it");
    if (rc)
        return rc;
    *ret_sky = is_cie       ? make_cie(&reader)
               : is_climate ? make_climate(&reader)
                            : make_diffuse(&reader, reader.value * (is_watt ? lm_per_w : 1));
    return *ret_sky ? 0 : orl_error_no_memory(err);
}

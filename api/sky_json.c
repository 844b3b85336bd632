#include "sky_json.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "decode.h"

enum { FILE_NAME_MAX_BYTES = 1024 };

/* One model's object, being decoded. */
struct part {
    const json_t *doc;
    const char *path; /* "sky.perez" */
    struct orl_sky_request *request;
    struct orl_error *err;
};

static void member_path(const struct part *part, const char *name, char path[ORL_JSON_PATH_MAX])
{
    snprintf(path, ORL_JSON_PATH_MAX, "%s.%s", part->path, name);
}

static bool has(const struct part *part, const char *name)
{
    return json_object_get(part->doc, name) != NULL;
}

static int real(const struct part *part, const char *name, double *ret_value)
{
    char path[ORL_JSON_PATH_MAX];
    member_path(part, name, path);
    return orl_json_real(json_object_get(part->doc, name), path, ret_value, part->err);
}

static int optional_real(const struct part *part, const char *name, double *ret_value)
{
    return has(part, name) ? real(part, name, ret_value) : 0;
}

static int whole(const struct part *part, const char *name, uint64_t max, int *ret_value)
{
    char path[ORL_JSON_PATH_MAX];
    uint64_t value = 0;
    int rc;
    member_path(part, name, path);
    rc = orl_json_whole(json_object_get(part->doc, name), path, 1, max, &value, part->err);
    if (rc == 0)
        *ret_value = (int)value;
    return rc;
}

static bool has_any(const struct part *part, const char *const *names)
{
    for (; *names; names++)
        if (has(part, *names))
            return true;
    return false;
}

static int decode_date(const struct part *part)
{
    struct orl_sky_request *request = part->request;
    int rc = whole(part, "month", 12, &request->month);
    if (rc == 0)
        rc = whole(part, "day", 31, &request->day);
    if (rc == 0)
        rc = real(part, "hour", &request->hour);
    request->time_given = rc == 0;
    return rc;
}

/* Time and site, the sun's place, or neither: what a sky needs is the core's to say. */
static int decode_when(const struct part *part)
{
    static const char *const time[] = {"month",     "day",       "hour", "latitude",
                                       "longitude", "time_zone", NULL};
    static const char *const sun[] = {"sun_altitude", "sun_azimuth", NULL};
    struct orl_sky_request *request = part->request;
    int rc = 0;
    if (has_any(part, sun)) {
        rc = real(part, "sun_altitude", &request->sun_altitude_deg);
        if (rc == 0)
            rc = real(part, "sun_azimuth", &request->sun_azimuth_deg);
        request->sun_given = rc == 0;
    }
    if (rc || !has_any(part, time))
        return rc;
    rc = decode_date(part);
    if (rc == 0)
        rc = real(part, "latitude", &request->latitude_deg);
    if (rc == 0)
        rc = real(part, "longitude", &request->longitude_deg);
    if (rc == 0)
        rc = real(part, "time_zone", &request->time_zone_h);
    return rc;
}

/* One way to say how bright a sky is: one member or two that go together. */
struct way {
    enum orl_sky_input input;
    const char *first, *second;
};

/*
 * Exactly one way must be complete, and no member of another given. The way that is meant is the
 * one whose first member is there.
 */
static int decode_way(const struct part *part, const struct way *ways, size_t count)
{
    const struct way *meant = NULL;
    for (size_t i = 0; i < count; i++) {
        if (!has(part, ways[i].first))
            continue;
        if (meant)
            return orl_json_fail(part->err, ORL_ERR_INVALID, part->path,
                                 "\"%s\" and \"%s\" cannot both be given", meant->first,
                                 ways[i].first);
        meant = &ways[i];
    }
    if (!meant)
        return orl_json_fail(part->err, ORL_ERR_INVALID, part->path,
                             "how bright it is is missing: \"%s\"%s%s%s, for one", ways[0].first,
                             ways[0].second ? " and \"" : "", ways[0].second ? ways[0].second : "",
                             ways[0].second ? "\"" : "");
    for (size_t i = 0; i < count; i++) {
        const char *second = ways[i].second;
        const bool wanted = second && meant->second && strcmp(second, meant->second) == 0;
        if (second && has(part, second) && !wanted)
            return orl_json_fail(part->err, ORL_ERR_INVALID, part->path,
                                 "\"%s\" and \"%s\" do not go together", meant->first, second);
    }
    part->request->input = meant->input;
    const int rc = real(part, meant->first, &part->request->first);
    return rc || !meant->second ? rc : real(part, meant->second, &part->request->second);
}

#define WHEN_MEMBERS                                                                               \
    "month", "day", "hour", "latitude", "longitude", "time_zone", "sun_altitude", "sun_azimuth",   \
        "ground_reflectance"

static int decode_perez(const struct part *part)
{
    static const char *const allowed[] = {WHEN_MEMBERS,
                                          "direct_normal_w_m2",
                                          "diffuse_horizontal_w_m2",
                                          "direct_normal_lx",
                                          "diffuse_horizontal_lx",
                                          "direct_horizontal_w_m2",
                                          "global_horizontal_w_m2",
                                          "clearness",
                                          "brightness",
                                          NULL};
    static const struct way ways[] = {
        {ORL_SKY_NORMAL_W, "direct_normal_w_m2", "diffuse_horizontal_w_m2"},
        {ORL_SKY_NORMAL_LX, "direct_normal_lx", "diffuse_horizontal_lx"},
        {ORL_SKY_HORIZONTAL_W, "direct_horizontal_w_m2", "diffuse_horizontal_w_m2"},
        {ORL_SKY_GLOBAL_W, "global_horizontal_w_m2", NULL},
        {ORL_SKY_INDICES, "clearness", "brightness"}};
    int rc = orl_json_object(part->doc, part->path, allowed, part->err);
    part->request->model = ORL_SKY_BY_PEREZ;
    if (rc == 0)
        rc = decode_when(part);
    if (rc == 0)
        rc = decode_way(part, ways, sizeof ways / sizeof *ways);
    return rc ? rc : optional_real(part, "ground_reflectance", &part->request->ground_reflectance);
}

static int decode_type(const struct part *part)
{
    static const struct {
        const char *name;
        enum orl_sky_cie type;
    } types[] = {{"clear", ORL_SKY_CLEAR},
                 {"overcast", ORL_SKY_OVERCAST},
                 {"uniform", ORL_SKY_UNIFORM},
                 {"intermediate", ORL_SKY_INTERMEDIATE}};
    const char *type = json_string_value(json_object_get(part->doc, "type"));
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++) {
        if (strcmp(type, types[i].name) == 0) {
            part->request->cie_type = types[i].type;
            return 0;
        }
    }
    return orl_json_fail(part->err, ORL_ERR_INVALID, "sky.cie.type",
                         "\"clear\", \"intermediate\", \"overcast\" or \"uniform\" is wanted");
}

static int decode_cie(const struct part *part)
{
    static const char *const allowed[] = {
        WHEN_MEMBERS, "type", "zenith_cd_m2", "diffuse_horizontal_lx", "direct_normal_lx",
        "turbidity",  NULL};
    static const char *const bright[] = {"zenith_cd_m2", "diffuse_horizontal_lx", NULL};
    static const struct way ways[] = {{ORL_SKY_ZENITH_CD_M2, "zenith_cd_m2", NULL},
                                      {ORL_SKY_DIFFUSE_LX, "diffuse_horizontal_lx", NULL}};
    struct orl_sky_request *request = part->request;
    int rc = orl_json_object(part->doc, part->path, allowed, part->err);
    request->model = ORL_SKY_BY_CIE;
    request->input = ORL_SKY_TYPICAL;
    if (rc == 0)
        rc = decode_type(part);
    if (rc == 0)
        rc = decode_when(part);
    if (rc == 0 && has_any(part, bright))
        rc = decode_way(part, ways, sizeof ways / sizeof *ways);
    if (rc == 0)
        rc = optional_real(part, "direct_normal_lx", &request->direct_normal_lx);
    if (rc == 0 && has(part, "direct_normal_lx") && request->direct_normal_lx < 0)
        rc = orl_json_fail(part->err, ORL_ERR_RANGE, "sky.cie.direct_normal_lx", "it is negative");
    if (rc == 0)
        rc = optional_real(part, "turbidity", &request->turbidity);
    return rc ? rc : optional_real(part, "ground_reflectance", &request->ground_reflectance);
}

static int decode_weather(const struct part *part)
{
    static const char *const allowed[] = {"file", "month", "day", "hour", "ground_reflectance",
                                          NULL};
    struct orl_sky_request *request = part->request;
    int rc = orl_json_object(part->doc, part->path, allowed, part->err);
    request->model = ORL_SKY_BY_WEATHER;
    if (rc == 0)
        rc = orl_json_string(json_object_get(part->doc, "file"), "sky.weather.file",
                             FILE_NAME_MAX_BYTES, &request->weather_file, part->err);
    if (rc == 0)
        rc = decode_date(part);
    return rc ? rc : optional_real(part, "ground_reflectance", &request->ground_reflectance);
}

static int decode_normalise(const json_t *value, struct orl_sky_request *request,
                            struct orl_error *err)
{
    const char *text = json_string_value(value);
    if (!value)
        return 0;
    if (text && strcmp(text, "flux") == 0)
        request->normalise = ORL_SKY_FLUX;
    else if (text && strcmp(text, "gendaylit") == 0)
        request->normalise = ORL_SKY_GENDAYLIT;
    else
        return orl_json_fail(err, ORL_ERR_INVALID, "sky.normalise",
                             "\"flux\" or \"gendaylit\" is wanted");
    return 0;
}

int orl_sky_from_json(const json_t *sky, struct orl_sky_request *request, struct orl_error *err)
{
    static const char *const allowed[] = {"perez", "cie", "weather", "normalise", NULL};
    static const struct {
        const char *name, *path;
        int (*decode)(const struct part *part);
    } models[] = {{"perez", "sky.perez", decode_perez},
                  {"cie", "sky.cie", decode_cie},
                  {"weather", "sky.weather", decode_weather}};
    const size_t n_models = sizeof models / sizeof *models;
    size_t found = n_models;
    if (!sky)
        return 0;
    int rc = orl_json_object(sky, "sky", allowed, err);
    for (size_t i = 0; i < n_models && rc == 0; i++) {
        if (!json_object_get(sky, models[i].name))
            continue;
        if (found < n_models)
            rc = orl_json_fail(err, ORL_ERR_INVALID, "sky", "a sky is one of perez, cie, weather");
        found = i;
    }
    if (rc == 0 && found == n_models)
        rc = orl_json_fail(err, ORL_ERR_INVALID, "sky", "a sky is one of perez, cie, weather");
    if (rc == 0)
        rc = decode_normalise(json_object_get(sky, "normalise"), request, err);
    if (rc)
        return rc;
    const struct part part = {json_object_get(sky, models[found].name), models[found].path, request,
                              err};
    return models[found].decode(&part);
}

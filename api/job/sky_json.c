#include "job/job_members_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "schemas.h"
#include "json/decode.h"

static bool has_any(const json_t *value, const char *const *names)
{
    for (; *names; names++)
        if (json_object_get(value, *names))
            return true;
    return false;
}

/* Rows for a sky's date and hour. All are required if `is_required` is true. */
#define DATE(request, is_required)                                                                 \
    {"month", .whole_int = &(request)->month, .required = (is_required)},                          \
        {"day", .whole_int = &(request)->day, .required = (is_required)},                          \
    {                                                                                              \
        "hour", .real = &(request)->hour, .required = (is_required)                                \
    }
/* Rows for date, site and sun position. The core checks which of them a sky needs. */
#define WHEN(request, is_required)                                                                 \
    DATE(request, is_required),                                                                    \
        {"latitude", .real = &(request)->latitude_deg, .required = (request)->time_given},         \
        {"longitude", .real = &(request)->longitude_deg, .required = (request)->time_given},       \
        {"time_zone", .real = &(request)->time_zone_h, .required = (request)->time_given},         \
        {"sun_altitude", .real = &(request)->sun_altitude_deg, .required = (request)->sun_given},  \
        {"sun_azimuth", .real = &(request)->sun_azimuth_deg, .required = (request)->sun_given},    \
    {                                                                                              \
        "ground_reflectance", .real = &(request)->ground_reflectance                               \
    }

/* Returns true if the sky has its own time: some of it is given, and none is given elsewhere. */
static bool find_time(const json_t *value, struct orl_sky_request *request)
{
    static const char *const time[] = {"month",     "day",       "hour", "latitude",
                                       "longitude", "time_zone", NULL};
    static const char *const sun[] = {"sun_altitude", "sun_azimuth", NULL};
    const bool known = request->time_given;
    request->sun_given = has_any(value, sun);
    request->time_given = known || has_any(value, time);
    return request->time_given && !known;
}

/* An input for a sky's brightness: one member, or two that go together. */
struct sky_input_pair {
    enum orl_sky_input input;
    const char *first, *second;
};

/*
 * Decodes the brightness. Exactly one pair must be complete, and members of other pairs are errors.
 * The pair is identified by its first member. schema: of the sky.
 */
static int decode_input_pair(const json_t *value, const char *path,
                             const struct orl_json_schema *schema,
                             const struct sky_input_pair *pairs, size_t count,
                             struct orl_sky_request *request, struct orl_error *err)
{
    const struct sky_input_pair *chosen = NULL;
    for (size_t i = 0; i < count; i++) {
        if (!json_object_get(value, pairs[i].first))
            continue;
        if (chosen)
            return orl_json_fail(err, ORL_ERR_INVALID, path,
                                 "\"%s\" and \"%s\" cannot both be given", chosen->first,
                                 pairs[i].first);
        chosen = &pairs[i];
    }
    if (!chosen)
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "the brightness is missing: give \"%s\"%s%s%s, for example",
                             pairs[0].first, pairs[0].second ? " and \"" : "",
                             pairs[0].second ? pairs[0].second : "", pairs[0].second ? "\"" : "");
    for (size_t i = 0; i < count; i++) {
        const char *second = pairs[i].second;
        const bool is_required = second && chosen->second && strcmp(second, chosen->second) == 0;
        if (second && json_object_get(value, second) && !is_required)
            return orl_json_fail(err, ORL_ERR_INVALID, path, "\"%s\" and \"%s\" cannot be combined",
                                 chosen->first, second);
    }
    request->input = chosen->input;
    const struct orl_json_member first = {chosen->first, .required = true, .real = &request->first},
                                 second = {chosen->second, .required = true,
                                           .real = &request->second};
    const int rc = orl_json_member(value, path, schema, &first, err);
    return rc || !chosen->second ? rc : orl_json_member(value, path, schema, &second, err);
}

static int decode_perez(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    static const struct sky_input_pair pairs[] = {
        {ORL_SKY_NORMAL_W, "direct_normal_w_m2", "diffuse_horizontal_w_m2"},
        {ORL_SKY_NORMAL_LX, "direct_normal_lx", "diffuse_horizontal_lx"},
        {ORL_SKY_HORIZONTAL_W, "direct_horizontal_w_m2", "diffuse_horizontal_w_m2"},
        {ORL_SKY_GLOBAL_W, "global_horizontal_w_m2", NULL},
        {ORL_SKY_INDICES, "clearness", "brightness"}};
    struct orl_sky_request *request = into;
    request->model = ORL_SKY_BY_PEREZ;
    const bool timed = find_time(value, request);
    const struct orl_json_member members[] = {WHEN(request, timed),
                                              {.name = "direct_normal_w_m2"},
                                              {.name = "diffuse_horizontal_w_m2"},
                                              {.name = "direct_normal_lx"},
                                              {.name = "diffuse_horizontal_lx"},
                                              {.name = "direct_horizontal_w_m2"},
                                              {.name = "global_horizontal_w_m2"},
                                              {.name = "clearness"},
                                              {.name = "brightness"},
                                              {0}};
    const int rc = orl_json_members(value, path, &orl_schema_perez_sky, members, err);
    return rc ? rc
              : decode_input_pair(value, path, &orl_schema_perez_sky, pairs,
                                  sizeof pairs / sizeof *pairs, request, err);
}

static int decode_type(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    enum orl_sky_cie type = 0;
    const int rc = orl_json_word(value, path, orl_schema_cie_sky_type.words, &type, err);
    if (rc == 0)
        *(enum orl_sky_cie *)into = ORL_SKY_CLEAR + type;
    return rc;
}

static int decode_cie(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    static const char *const bright[] = {"zenith_cd_m2", "diffuse_horizontal_lx", NULL};
    static const struct sky_input_pair pairs[] = {
        {ORL_SKY_ZENITH_CD_M2, "zenith_cd_m2", NULL},
        {ORL_SKY_DIFFUSE_LX, "diffuse_horizontal_lx", NULL}};
    struct orl_sky_request *request = into;
    request->model = ORL_SKY_BY_CIE;
    request->input = ORL_SKY_TYPICAL;
    const bool timed = find_time(value, request);
    const struct orl_json_member members[] = {
        WHEN(request, timed),
        {"type", .decode = decode_type, .into = &request->cie_type},
        {.name = "zenith_cd_m2"},
        {.name = "diffuse_horizontal_lx"},
        {"direct_normal_lx", .real = &request->direct_normal_lx},
        {"turbidity", .real = &request->turbidity},
        {0}};
    const int rc = orl_json_members(value, path, &orl_schema_cie_sky, members, err);
    if (rc || !has_any(value, bright))
        return rc;
    return decode_input_pair(value, path, &orl_schema_cie_sky, pairs, sizeof pairs / sizeof *pairs,
                             request, err);
}

static int decode_weather(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_sky_request *request = into;
    const bool in_sequence = request->time_given;
    const struct orl_json_schema *schema =
        in_sequence ? &orl_schema_sequence_weather : &orl_schema_weather_sky;
    request->model = ORL_SKY_BY_WEATHER;
    request->time_given = true;
    const struct orl_json_member members[] = {
        {"file", .text = &request->weather_file},
        {"year", .whole_int = &request->weather_year},
        {"ground_reflectance", .real = &request->ground_reflectance},
        {in_sequence ? NULL : "month", .whole_int = &request->month},
        {"day", .whole_int = &request->day},
        {"hour", .real = &request->hour},
        {0}};
    return orl_json_members(value, path, schema, members, err);
}

/* ret_name: gets the sky's name; NULL where skies have none. */
static int decode_sky(const json_t *value, const char *path, struct orl_sky_request *request,
                      char **ret_name, struct orl_error *err)
{
    const struct orl_json_schema *schema = ret_name ? &orl_schema_named_sky : &orl_schema_sky;
    const struct orl_json_member members[] = {
        {"perez", .decode = decode_perez, .into = request},
        {"cie", .decode = decode_cie, .into = request},
        {"weather", .decode = decode_weather, .into = request},
        {"normalise", .word = &request->normalise},
        {"sun", .word = &request->sun_method},
        {ret_name ? "name" : NULL, .text = ret_name},
        {0}};
    int given = 0;
    for (int i = 0; i < 3; i++)
        given += json_object_get(value, members[i].name) != NULL;
    const int rc = given > 1 ? 0 : orl_json_members(value, path, schema, members, err);
    if (rc == 0 && given != 1)
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "a sky has exactly one of perez, cie, weather");
    return rc;
}

int orl_sky_from_json(const json_t *value, const char *path, void *request, struct orl_error *err)
{
    return decode_sky(value, path, request, NULL, err);
}

/* Decodes one of several skies into a struct orl_named_sky of zeros; "name" is optional. */
static int decode_named_sky(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_named_sky *sky = into;
    orl_sky_request_init(&sky->request);
    return decode_sky(value, path, &sky->request, &sky->name, err);
}

/* Days before each month, in a year without leap days. */
static const int days_before[13] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, 365};
static const double day_h = 24;
/* Tolerance in hours for rounding errors of added steps. */
static const double slack_h = 1e-6;

static int name_sky(struct orl_named_sky *sky, size_t index, struct orl_error *err)
{
    const struct orl_sky_request *request = &sky->request;
    const int minutes = (int)floor(60 * request->hour + slack_h);
    char made[64];
    if (request->time_given && request->hour >= 0 && request->hour < day_h)
        snprintf(made, sizeof made, "%02d%02d-%02d%02d", request->month, request->day, minutes / 60,
                 minutes % 60);
    else
        snprintf(made, sizeof made, "sky-%04zu", index);
    sky->name = strdup(made);
    return sky->name ? 0 : orl_error_no_memory(err);
}

static int decode_list(const json_t *skies, const char *path, struct orl_job *job,
                       struct orl_error *err)
{
    const struct orl_json_list list = {.items = &job->skies,
                                       .count = &job->n_skies,
                                       .size = sizeof *job->skies,
                                       .each = decode_named_sky};
    int rc = orl_json_list(skies, path, &orl_schema_named_skies, &list, err);
    for (size_t i = 0; i < job->n_skies && rc == 0; i++)
        if (!job->skies[i].name)
            rc = name_sky(&job->skies[i], i, err);
    return rc;
}

/* ---- Sequences ------------------------------------------------------------------------------- */

/* Decodes {"month", "day", "hour"} as hours since the year began. */
static int decode_moment(const json_t *value, const char *path, void *ret_h, struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    uint64_t month = 1, day = 1;
    double hour = 0;
    const struct orl_json_member members[] = {
        {"month", .whole = &month},
        {.name = "day"}, /* decoded below: its bounds depend on the month */
        {"hour", .real = &hour},
        {0}};
    int rc = orl_json_members(value, path, &orl_schema_moment, members, err);
    const int before = days_before[month - 1], days = days_before[month] - before;
    if (rc == 0)
        rc = orl_json_whole(json_object_get(value, "day"), orl_json_path(path, "day", at), 1,
                            (uint64_t)days, &day, err);
    *(double *)ret_h = (before + (double)day - 1) * day_h + hour;
    return rc;
}

/* Finds the one sky model that is given, as an object without a time. */
static int find_model(const json_t *doc, const char *path, const char **ret_model,
                      struct orl_error *err)
{
    static const char *const models[] = {"perez", "cie", "weather"};
    static const char *const times[] = {"month", "day", "hour", "sun_altitude", "sun_azimuth"};
    const char *model = NULL;
    for (size_t i = 0; i < 3; i++) {
        if (!json_object_get(doc, models[i]))
            continue;
        if (model)
            return orl_json_fail(err, ORL_ERR_INVALID, path,
                                 "a sky has exactly one of perez, cie, weather");
        model = models[i];
    }
    const json_t *sky = model ? json_object_get(doc, model) : NULL;
    if (!json_is_object(sky))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "perez, cie or weather is expected here, as an object");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
        if (json_object_get(sky, times[i]))
            return orl_json_fail(
                err, ORL_ERR_INVALID, path,
                "\"%s\" is computed from \"from\", \"to\" and \"step_h\": leave it out", times[i]);
    *ret_model = model;
    return 0;
}

struct sequence {
    double from_h, to_h, step_h;
    size_t count;
};

static int decode_sequence(const json_t *doc, const char *path, struct sequence *seq,
                           struct orl_error *err)
{
    char at[ORL_JSON_PATH_MAX];
    const struct orl_json_member members[] = {
        {.name = "perez"},
        {.name = "cie"},
        {.name = "weather"},
        {.name = "normalise"},
        {.name = "sun"},
        {"from", .decode = decode_moment, .into = &seq->from_h},
        {"to", .decode = decode_moment, .into = &seq->to_h},
        {"step_h", .real = &seq->step_h},
        {0}};
    const int rc = orl_json_members(doc, path, &orl_schema_sky_sequence, members, err);
    if (rc)
        return rc;
    if (seq->to_h < seq->from_h)
        return orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, "to", at),
                             "it is before \"from\"");
    seq->count = 1 + (size_t)floor((seq->to_h - seq->from_h + slack_h) / seq->step_h);
    if (seq->count > ORL_LIMIT_SKIES)
        return orl_json_fail(err, ORL_ERR_LIMIT, path, "%zu steps; at most %u are allowed",
                             seq->count, ORL_LIMIT_SKIES);
    return 0;
}

static void set_moment(struct orl_sky_request *request, double time_h)
{
    const int day = (int)floor((time_h + slack_h) / day_h);
    int month = 1;
    while (days_before[month] <= day)
        month++;
    request->month = month;
    request->day = day - days_before[month - 1] + 1;
    /* Rounding to nine digits: 0.3 must stay 0.3 after many steps of a tenth. */
    request->hour = fmax(round((time_h - day * day_h) * 1e9) / 1e9, 0);
}

static int add_hours(const struct sequence *seq, const struct orl_sky_request *shared,
                     struct orl_job *job, struct orl_error *err)
{
    int rc = 0;
    job->skies = calloc(seq->count, sizeof *job->skies);
    if (!job->skies)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu skies", seq->count);
    for (size_t i = 0; i < seq->count && rc == 0; i++) {
        struct orl_named_sky *sky = &job->skies[job->n_skies++];
        sky->request = *shared;
        set_moment(&sky->request, fmin(seq->from_h + (double)i * seq->step_h, seq->to_h));
        if (shared->weather_file) {
            sky->request.weather_file = strdup(shared->weather_file);
            if (!sky->request.weather_file)
                rc = orl_error_no_memory(err);
        }
        rc = rc ? rc : name_sky(sky, i, err);
    }
    return rc;
}

static int decode_hours(const json_t *doc, const char *path, struct orl_job *job,
                        struct orl_error *err)
{
    struct orl_sky_request shared;
    struct sequence seq = {.step_h = 1};
    const char *model = NULL;
    orl_sky_request_init(&shared);
    shared.time_given = true;
    int rc = decode_sequence(doc, path, &seq, err);
    if (rc == 0)
        rc = find_model(doc, path, &model, err);
    if (rc)
        return rc;
    json_t *sky = json_pack("{s:O, s:O*, s:O*}", model, json_object_get(doc, model), "normalise",
                            json_object_get(doc, "normalise"), "sun", json_object_get(doc, "sun"));
    rc = sky ? orl_sky_from_json(sky, path, &shared, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = add_hours(&seq, &shared, job, err);
    json_decref(sky);
    free(shared.weather_file);
    return rc;
}

int orl_skies_from_json(const json_t *skies, const char *path, void *job, struct orl_error *err)
{
    if (json_is_array(skies))
        return decode_list(skies, path, job, err);
    if (json_is_object(skies))
        return decode_hours(skies, path, job, err);
    return orl_json_fail(err, ORL_ERR_INVALID, path,
                         "a list of skies is expected, or a sequence of hours as an object");
}

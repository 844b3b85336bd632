#include "job/skies_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "job/sky_json.h"

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
    return sky->name ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

static int decode_list(const json_t *skies, const char *path, struct orl_job *job,
                       struct orl_error *err)
{
    const struct orl_json_list list = {.items = &job->skies,
                                       .count = &job->n_skies,
                                       .size = sizeof *job->skies,
                                       .most = ORL_LIMIT_SKIES,
                                       .each = orl_named_sky_from_json,
                                       .empty = "there is none"};
    int rc = orl_json_list(skies, path, &list, err);
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
        {"month", .whole = &month, .from = 1, .to = 12, .required = true},
        {.name = "day"}, /* decoded below: its bounds depend on the month */
        {"hour", .real = &hour, .least = 0, .most = day_h, .below = true, .required = true,
         .bounds = "it lies between 0 and 24"},
        {0}};
    int rc = orl_json_members(value, path, members, err);
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
            return orl_json_fail(err, ORL_ERR_INVALID, path, "a sky is one of perez, cie, weather");
        model = models[i];
    }
    const json_t *sky = model ? json_object_get(doc, model) : NULL;
    if (!json_is_object(sky))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "perez, cie or weather is wanted here, as an object");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
        if (json_object_get(sky, times[i]))
            return orl_json_fail(err, ORL_ERR_INVALID, path,
                                 "\"%s\" follows from \"from\", \"to\" and \"step_h\"", times[i]);
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
        {"from", .decode = decode_moment, .into = &seq->from_h, .required = true},
        {"to", .decode = decode_moment, .into = &seq->to_h, .required = true},
        {"step_h", .real = &seq->step_h, .least = 1.0 / 60, .most = 365 * day_h,
         .bounds = "it is in hours, from a minute to a year"},
        {0}};
    const int rc = orl_json_members(doc, path, members, err);
    if (rc)
        return rc;
    if (seq->to_h < seq->from_h)
        return orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, "to", at),
                             "it comes before \"from\"");
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
                rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
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
    rc = sky ? orl_sky_from_json(sky, path, &shared, err)
             : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
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
                         "a list of skies is wanted, or a sequence of hours as an object");
}

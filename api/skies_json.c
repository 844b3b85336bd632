#include "skies_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "decode.h"
#include "sky_json.h"

enum { NAME_MAX = 64, PLACE_MAX = 32 };

/* Hours since the year began, by a calendar without leap days. */
static const int days_before[13] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, 365};
static const double day_h = 24;
/* Steps add up to a multiple of hours with rounding errors, which are less than this. */
static const double slack_h = 1e-6;

/* A mistake in "sky" is one in "skies[3]". */
static void move_place(struct orl_error *err, const char *place)
{
    char was[ORL_ERROR_NAME_MAX], rest[ORL_ERROR_TEXT_MAX], now[ORL_ERROR_NAME_MAX + PLACE_MAX];
    if (!err || strncmp(err->primitive, "sky", 3) != 0)
        return;
    memcpy(was, err->primitive, sizeof was);
    snprintf(now, sizeof now, "%s%s", place, was + 3);
    if (strncmp(err->message, was, strlen(was)) == 0) {
        memcpy(rest, err->message, sizeof rest);
        snprintf(err->message, sizeof err->message, "%.160s%.340s", now, rest + strlen(was));
    }
    orl_error_at(err, NULL, 0, now);
}

static int name_sky(const json_t *name, const char *place, size_t index, struct orl_named_sky *sky,
                    struct orl_error *err)
{
    const struct orl_sky_request *request = &sky->request;
    char path[PLACE_MAX + 8], made[NAME_MAX];
    const int minutes = (int)floor(60 * request->hour + slack_h);
    if (name) {
        snprintf(path, sizeof path, "%s.name", place);
        return orl_json_string(name, path, NAME_MAX, &sky->name, err);
    }
    if (request->time_given && request->hour >= 0 && request->hour < day_h)
        snprintf(made, sizeof made, "%02d%02d-%02d%02d", request->month, request->day, minutes / 60,
                 minutes % 60);
    else
        snprintf(made, sizeof made, "sky-%04zu", index);
    sky->name = strdup(made);
    return sky->name ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Appends a sky; the job's list has room. doc may hold a name. */
static int add_sky(const json_t *doc, const char *place, struct orl_job *job, struct orl_error *err)
{
    struct orl_named_sky *sky = &job->skies[job->n_skies];
    json_t *plain = json_is_object(doc) ? json_copy((json_t *)(uintptr_t)doc) : NULL;
    const json_t *name = json_object_get(doc, "name");
    orl_sky_request_init(&sky->request);
    job->n_skies++;
    json_object_del(plain, "name");
    int rc = orl_sky_from_json(plain ? plain : doc, &sky->request, err);
    json_decref(plain);
    if (rc)
        move_place(err, place);
    return rc ? rc : name_sky(name, place, job->n_skies - 1, sky, err);
}

static int make_room(struct orl_job *job, size_t count, struct orl_error *err)
{
    job->skies = calloc(count + 1, sizeof *job->skies);
    return job->skies ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu skies", count);
}

static int decode_list(const json_t *skies, struct orl_job *job, struct orl_error *err)
{
    const size_t count = json_array_size(skies);
    int rc = orl_json_array(skies, "skies", ORL_LIMIT_SKIES, err);
    if (rc == 0 && count == 0)
        rc = orl_json_fail(err, ORL_ERR_INVALID, "skies", "there is none");
    if (rc == 0)
        rc = make_room(job, count, err);
    for (size_t i = 0; i < count && rc == 0; i++) {
        char place[PLACE_MAX];
        snprintf(place, sizeof place, "skies[%zu]", i);
        rc = add_sky(json_array_get(skies, i), place, job, err);
    }
    return rc;
}

/* ---- Sequences ------------------------------------------------------------------------------- */

/* {"month", "day", "hour"} as hours since the year began. */
static int decode_moment(const json_t *doc, const char *path, double *ret_h, struct orl_error *err)
{
    static const char *const allowed[] = {"month", "day", "hour", NULL};
    char member[PLACE_MAX];
    uint64_t month = 1, day = 1;
    double hour = 0;
    int rc = orl_json_object(doc, path, allowed, err);
    snprintf(member, sizeof member, "%s.month", path);
    if (rc == 0)
        rc = orl_json_whole(json_object_get(doc, "month"), member, 1, 12, &month, err);
    const int before = days_before[month - 1], days = days_before[month] - before;
    snprintf(member, sizeof member, "%s.day", path);
    if (rc == 0)
        rc = orl_json_whole(json_object_get(doc, "day"), member, 1, (uint64_t)days, &day, err);
    snprintf(member, sizeof member, "%s.hour", path);
    if (rc == 0)
        rc = orl_json_real(json_object_get(doc, "hour"), member, &hour, err);
    if (rc == 0 && !(hour >= 0 && hour < day_h))
        rc = orl_json_fail(err, ORL_ERR_RANGE, member, "it lies between 0 and 24");
    *ret_h = (before + (double)day - 1) * day_h + hour;
    return rc;
}

struct sequence {
    double from_h, to_h, step_h;
    size_t count;
};

static int decode_sequence(const json_t *doc, struct sequence *seq, struct orl_error *err)
{
    const json_t *step = json_object_get(doc, "step_h");
    int rc = decode_moment(json_object_get(doc, "from"), "skies.from", &seq->from_h, err);
    seq->step_h = 1;
    if (rc == 0)
        rc = decode_moment(json_object_get(doc, "to"), "skies.to", &seq->to_h, err);
    if (rc == 0 && step)
        rc = orl_json_real(step, "skies.step_h", &seq->step_h, err);
    if (rc == 0 && !(seq->step_h >= 1.0 / 60 && seq->step_h <= 365 * day_h))
        rc = orl_json_fail(err, ORL_ERR_RANGE, "skies.step_h",
                           "it is in hours, from a minute to a year");
    if (rc == 0 && seq->to_h < seq->from_h)
        rc = orl_json_fail(err, ORL_ERR_INVALID, "skies.to", "it comes before \"from\"");
    if (rc)
        return rc;
    seq->count = 1 + (size_t)floor((seq->to_h - seq->from_h + slack_h) / seq->step_h);
    if (seq->count > ORL_LIMIT_SKIES)
        return orl_json_fail(err, ORL_ERR_LIMIT, "skies", "%zu steps; at most %u are allowed",
                             seq->count, ORL_LIMIT_SKIES);
    return 0;
}

/* The sky's own object ("weather", ...) with the moment added; NULL when out of memory. */
static json_t *sky_at(const json_t *doc, const char *model, double time_h)
{
    const int day = (int)floor((time_h + slack_h) / day_h);
    /* Nine digits: 0.3 is to be 0.3 after many steps of a tenth. */
    const double hour = fmax(round((time_h - day * day_h) * 1e9) / 1e9, 0);
    int month = 1;
    while (days_before[month] <= day)
        month++;
    json_t *sky = json_deep_copy(json_object_get(doc, model));
    json_object_set_new(sky, "month", json_integer(month));
    json_object_set_new(sky, "day", json_integer(day - days_before[month - 1] + 1));
    json_object_set_new(sky, "hour", json_real(hour));
    return json_pack("{s:o, s:O*}", model, sky, "normalise", json_object_get(doc, "normalise"));
}

/* Which of the models is given: exactly one, an object without a time. */
static int find_model(const json_t *doc, const char **ret_model, struct orl_error *err)
{
    static const char *const models[] = {"perez", "cie", "weather"};
    static const char *const times[] = {"month", "day", "hour", "sun_altitude", "sun_azimuth"};
    const char *model = NULL;
    for (size_t i = 0; i < 3; i++) {
        if (!json_object_get(doc, models[i]))
            continue;
        if (model)
            return orl_json_fail(err, ORL_ERR_INVALID, "skies",
                                 "a sky is one of perez, cie, weather");
        model = models[i];
    }
    const json_t *sky = model ? json_object_get(doc, model) : NULL;
    if (!json_is_object(sky))
        return orl_json_fail(err, ORL_ERR_INVALID, "skies",
                             "perez, cie or weather is wanted here, as an object");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
        if (json_object_get(sky, times[i]))
            return orl_json_fail(err, ORL_ERR_INVALID, "skies",
                                 "\"%s\" follows from \"from\", \"to\" and \"step_h\"", times[i]);
    *ret_model = model;
    return 0;
}

static int decode_hours(const json_t *doc, struct orl_job *job, struct orl_error *err)
{
    static const char *const allowed[] = {"perez", "cie", "weather", "normalise",
                                          "from",  "to",  "step_h",  NULL};
    struct sequence seq = {0};
    const char *model = NULL;
    int rc = orl_json_object(doc, "skies", allowed, err);
    if (rc == 0)
        rc = find_model(doc, &model, err);
    if (rc == 0)
        rc = decode_sequence(doc, &seq, err);
    if (rc == 0)
        rc = make_room(job, seq.count, err);
    for (size_t i = 0; i < seq.count && rc == 0; i++) {
        const double time_h = fmin(seq.from_h + (double)i * seq.step_h, seq.to_h);
        json_t *sky = sky_at(doc, model, time_h);
        rc = sky ? add_sky(sky, "skies", job, err)
                 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        json_decref(sky);
    }
    return rc;
}

int orl_skies_from_json(const json_t *skies, struct orl_job *job, struct orl_error *err)
{
    if (!skies)
        return 0;
    if (json_is_array(skies))
        return decode_list(skies, job, err);
    if (json_is_object(skies))
        return decode_hours(skies, job, err);
    return orl_json_fail(err, ORL_ERR_INVALID, "skies",
                         "a list of skies is wanted, or a sequence of hours as an object");
}

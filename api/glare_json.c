#include "glare_json.h"

#include <stdio.h>
#include <string.h>

#include "decode.h"
#include "encode.h"

/* ---- What is asked for ----------------------------------------------------------------------- */

static int decode_metric(const json_t *value, const char *path, uint32_t *metrics,
                         struct orl_error *err)
{
    const char *name = json_string_value(value);
    if (name && strcmp(name, "all") == 0) {
        *metrics = (1U << ORL_GLARE_METRICS) - 1;
        return 0;
    }
    for (int m = 0; name && m < ORL_GLARE_METRICS; m++)
        if (strcmp(name, orl_glare_metric_name((enum orl_glare_metric)m)) == 0) {
            *metrics |= 1U << m;
            return 0;
        }
    orl_json_fail(err, ORL_ERR_INVALID, path, "there is no such metric");
    orl_error_hint(err,
                   "\"all\", or some of \"dgp\", \"dgps\", \"dgi\", \"ugr\", \"vcp\", \"cgi\", "
                   "\"ugp\", \"vertical_illuminance_lx\", \"average_luminance_cd_m2\", "
                   "\"background_luminance_cd_m2\"");
    return ORL_ERR_INVALID;
}

int orl_glare_metrics_from_json(const json_t *value, const char *path, uint32_t *ret_metrics,
                                struct orl_error *err)
{
    uint32_t metrics = 0;
    if (!value)
        return 0;
    int rc = orl_json_array(value, path, ORL_GLARE_METRICS + 1, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(value); i++) {
        char at[ORL_JSON_PATH_MAX];
        snprintf(at, sizeof at, "%.120s[%zu]", path, i);
        rc = decode_metric(json_array_get(value, i), at, &metrics, err);
    }
    if (rc == 0)
        *ret_metrics = metrics;
    return rc;
}

/* Numbers of an object: where there is one, and where it goes. */
struct number {
    const char *key;
    double *target;
};

static int decode_numbers(const json_t *doc, const char *path, const struct number *numbers,
                          size_t count, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < count && rc == 0; i++) {
        const json_t *value = json_object_get(doc, numbers[i].key);
        char at[ORL_JSON_PATH_MAX];
        snprintf(at, sizeof at, "%.120s.%s", path, numbers[i].key);
        if (value)
            rc = orl_json_real(value, at, numbers[i].target, err);
    }
    return rc;
}

static int decode_task(const json_t *value, const char *path, struct orl_glare_area *task,
                       struct orl_error *err)
{
    static const char *const allowed[] = {"x", "y", "angle_rad", NULL};
    char at[ORL_JSON_PATH_MAX];
    snprintf(at, sizeof at, "%.120s.task", path);
    if (!value)
        return 0;
    const struct number numbers[] = {
        {"x", &task->x}, {"y", &task->y}, {"angle_rad", &task->angle_rad}};
    int rc = orl_json_object(value, at, allowed, err);
    if (rc == 0)
        rc = decode_numbers(value, at, numbers, 3, err);
    if (rc == 0 && !(task->angle_rad > 0))
        rc = orl_json_fail(err, ORL_ERR_RANGE, at, "a task has an \"angle_rad\" above 0");
    return rc;
}

static int decode_directions(const json_t *value, const char *path, struct orl_glare_settings *s,
                             struct orl_error *err)
{
    static const char *const allowed[] = {"count", "span_deg", NULL};
    char at[ORL_JSON_PATH_MAX];
    uint64_t count = 0;
    if (!value)
        return 0;
    snprintf(at, sizeof at, "%.120s.directions", path);
    int rc = orl_json_object(value, at, allowed, err);
    const struct number span = {"span_deg", &s->directions_deg};
    if (rc == 0)
        rc = decode_numbers(value, at, &span, 1, err);
    snprintf(at, sizeof at, "%.120s.directions.count", path);
    if (rc == 0)
        rc = orl_json_whole(json_object_get(value, "count"), at, 2, 360, &count, err);
    s->directions = (uint32_t)count;
    return rc;
}

static int decode_flag(const json_t *doc, const char *path, const char *key, bool *ret_flag,
                       struct orl_error *err)
{
    const json_t *value = json_object_get(doc, key);
    char at[ORL_JSON_PATH_MAX];
    snprintf(at, sizeof at, "%.120s.%s", path, key);
    return value ? orl_json_bool(value, at, ret_flag, err) : 0;
}

/* One of two words; the second is true. */
static int decode_choice(const json_t *doc, const char *path, const char *key,
                         const char *const words[2], bool *ret_second, struct orl_error *err)
{
    const json_t *value = json_object_get(doc, key);
    const char *word = json_string_value(value);
    char at[ORL_JSON_PATH_MAX];
    if (!value)
        return 0;
    snprintf(at, sizeof at, "%.120s.%s", path, key);
    for (int i = 0; word && i < 2; i++)
        if (strcmp(word, words[i]) == 0) {
            *ret_second = i == 1;
            return 0;
        }
    return orl_json_fail(err, ORL_ERR_INVALID, at, "it is \"%s\" or \"%s\"", words[0], words[1]);
}

static int decode_choices(const json_t *value, const char *path, struct orl_glare_settings *s,
                          struct orl_error *err)
{
    static const char *const formulas[] = {"published", "evalglare"};
    static const char *const positions[] = {"exact", "whole_pixels"};
    bool evalglare = s->constants == ORL_DGP_EVALGLARE, peaks = !s->no_peaks;
    int rc = decode_choice(value, path, "formula", formulas, &evalglare, err);
    if (rc == 0)
        rc = decode_choice(value, path, "position", positions, &s->at_whole_pixels, err);
    if (rc == 0)
        rc = decode_flag(value, path, "smooth", &s->smooth, err);
    if (rc == 0)
        rc = decode_flag(value, path, "low_light_correction", &s->low_light, err);
    if (rc == 0)
        rc = decode_flag(value, path, "peaks", &peaks, err);
    s->constants = evalglare ? ORL_DGP_EVALGLARE : ORL_DGP_PUBLISHED;
    s->no_peaks = !peaks;
    return rc;
}

int orl_glare_settings_from_json(const json_t *value, const char *path,
                                 struct orl_glare_settings *ret_settings, struct orl_error *err)
{
    static const char *const allowed[] = {"threshold",  "task",
                                          "radius_rad", "smooth",
                                          "peak_cd_m2", "peaks",
                                          "formula",    "low_light_correction",
                                          "age_years",  "vertical_illuminance_lx",
                                          "position",   "directions",
                                          NULL};
    struct orl_glare_settings s = *ret_settings;
    if (!value)
        return 0;
    const struct number numbers[] = {{"threshold", &s.threshold},
                                     {"radius_rad", &s.radius_rad},
                                     {"peak_cd_m2", &s.peak_cd_m2},
                                     {"age_years", &s.age_years},
                                     {"vertical_illuminance_lx", &s.eye_lx}};
    int rc = orl_json_object(value, path, allowed, err);
    if (rc == 0)
        rc = decode_numbers(value, path, numbers, sizeof numbers / sizeof *numbers, err);
    if (rc == 0)
        rc = decode_task(json_object_get(value, "task"), path, &s.task, err);
    if (rc == 0)
        rc = decode_directions(json_object_get(value, "directions"), path, &s, err);
    if (rc == 0)
        rc = decode_choices(value, path, &s, err);
    struct orl_error why;
    if (rc == 0 && orl_glare_settings_check(&s, &why) < 0)
        rc = orl_json_fail(err, why.code, path, "%s", why.message);
    if (rc == 0)
        *ret_settings = s;
    return rc;
}

/* ---- What was found -------------------------------------------------------------------------- */

static json_t *pair_to_json(double a, double b)
{
    return json_pack("[o, o]", orl_json_from_real(a), orl_json_from_real(b));
}

static json_t *metrics_to_json(const struct orl_glare *glare, uint32_t metrics)
{
    json_t *doc = json_object();
    for (int m = 0; doc && m < ORL_GLARE_METRICS; m++) {
        const struct orl_glare_value *v = &glare->values[m];
        if ((metrics >> m & 1) == 0)
            continue;
        json_t *value =
            json_pack("{s:o, s:o, s:o}", "value", orl_json_from_real(v->value), "standard_error",
                      orl_json_from_real(v->standard_error), "interval_95",
                      pair_to_json(v->interval_95[0], v->interval_95[1]));
        if (json_object_set_new(doc, orl_glare_metric_name((enum orl_glare_metric)m), value)) {
            json_decref(doc);
            return NULL;
        }
    }
    return doc;
}

static json_t *source_to_json(const struct orl_glare_source *s)
{
    return json_pack("{s:f, s:f, s:f, s:o, s:[f, f, f], s:f, s:f, s:I, s:f}", "luminance_cd_m2",
                     s->luminance_cd_m2, "solid_angle_sr", s->solid_angle_sr, "position_index",
                     s->position_index, "position", pair_to_json(s->x, s->y), "direction",
                     s->direction.x, s->direction.y, s->direction.z, "angle_deg", s->angle_deg,
                     "illuminance_lx", s->illuminance_lx, "pixels", (json_int_t)s->pixels,
                     "brightest_cd_m2", s->most_cd_m2);
}

static json_t *sources_to_json(const struct orl_glare *glare)
{
    json_t *sources = json_array();
    for (size_t i = 0; sources && i < glare->n_sources; i++) {
        json_t *source = source_to_json(&glare->sources[i]);
        if (!source || json_array_append_new(sources, source)) {
            json_decref(sources);
            return NULL;
        }
    }
    return sources;
}

static json_t *part_to_json(const struct orl_glare_part *p)
{
    return p->pixels == 0
               ? NULL
               : json_pack("{s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "pixels",
                           (json_int_t)p->pixels, "solid_angle_sr", p->solid_angle_sr,
                           "illuminance_lx", p->illuminance_lx, "mean_cd_m2", p->mean,
                           "median_cd_m2", p->median, "deviation_cd_m2", p->deviation,
                           "percentile_75_cd_m2", p->percentile_75, "percentile_95_cd_m2",
                           p->percentile_95, "least_cd_m2", p->least, "most_cd_m2", p->most);
}

json_t *orl_glare_to_json(const struct orl_glare *glare, uint32_t metrics)
{
    return json_pack(
        "{s:o, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:o*, s:o}", "metrics",
        metrics_to_json(glare, metrics), "class", orl_glare_class_name(glare->class_of),
        "threshold_cd_m2", glare->threshold_cd_m2, "task_luminance_cd_m2", glare->task_cd_m2,
        "direct_illuminance_lx", glare->direct_lx, "brightest_cd_m2", glare->most_cd_m2, "field_sr",
        glare->field_sr, "turned_deg", glare->turned_deg, "mask", part_to_json(&glare->masked),
        "sources", sources_to_json(glare));
}

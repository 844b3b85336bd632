#include "view/view_json.h"

#include <string.h>

#include <oriel/base/suggest.h>

#include "schemas.h"
#include "json/encode.h"

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_metric(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    uint32_t *metrics = into;
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
    struct orl_suggestion suggestion = {.word = name ? name : ""};
    for (int m = 0; m < ORL_GLARE_METRICS; m++)
        orl_suggestion_add(&suggestion, orl_glare_metric_name((enum orl_glare_metric)m));
    orl_json_fail(err, ORL_ERR_INVALID, path, "this metric does not exist");
    orl_error_hint(
        err,
        "Use \"all\", or some of \"dgp\", \"dgps\", \"dgi\", \"ugr\", \"vcp\", \"cgi\", \"ugp\", "
        "\"vertical_illuminance_lx\", \"average_luminance_cd_m2\", \"background_luminance_cd_m2\"");
    orl_suggestion_hint(&suggestion, err);
    return ORL_ERR_INVALID;
}

int orl_glare_metrics_from_json(const json_t *value, const char *path, void *ret_metrics,
                                struct orl_error *err)
{
    return orl_json_each(value, path, &orl_schema_view_metrics, decode_metric, ret_metrics, err);
}

static int decode_task(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_glare_area *task = into;
    const struct orl_json_member members[] = {{"x", .real = &task->x},
                                              {"y", .real = &task->y},
                                              {"angle_rad", .real = &task->angle_rad},
                                              {0}};
    const int rc = orl_json_members(value, path, &orl_schema_glare_task, members, err);
    return rc;
}

static int decode_mask(const json_t *value, const char *path, void *ret_name, struct orl_error *err)
{
    char *name = NULL;
    const int rc = orl_json_text_of(value, path, &orl_schema_glare_settings_mask, &name, err);
    if (rc == 0)
        memcpy(ret_name, name, strlen(name) + 1);
    free(name);
    return rc;
}

int orl_glare_settings_from_json(const json_t *value, const char *path, void *ret_settings,
                                 struct orl_error *err)
{
    struct orl_glare_settings *s = ret_settings;
    unsigned at_whole_pixels = s->at_whole_pixels;
    bool peaks = !s->no_peaks;
    const struct orl_json_member directions[] = {
        {"count", .whole_32 = &s->directions}, {"span_deg", .real = &s->directions_deg}, {0}};
    const struct orl_json_member members[] = {{"threshold", .real = &s->threshold},
                                              {"task", .decode = decode_task, .into = &s->task},
                                              {"radius_rad", .real = &s->radius_rad},
                                              {"smooth", .flag = &s->smooth},
                                              {"peak_cd_m2", .real = &s->peak_cd_m2},
                                              {"peaks", .flag = &peaks},
                                              {"formula", .word = &s->constants},
                                              {"low_light_correction", .flag = &s->low_light},
                                              {"age_years", .real = &s->age_years},
                                              {"vertical_illuminance_lx", .real = &s->eye_lx},
                                              {"position", .word = &at_whole_pixels},
                                              {"directions", .members = directions},
                                              {"mask", .decode = decode_mask, .into = s->mask},
                                              {"band_rad", .real = &s->band_rad},
                                              {0}};
    struct orl_error why;
    const int rc = orl_json_members(value, path, &orl_schema_glare_settings, members, err);
    s->at_whole_pixels = at_whole_pixels == 1;
    s->no_peaks = !peaks;
    if (rc == 0 && orl_glare_settings_check(s, &why) < 0)
        return orl_json_fail(err, why.code, path, "%s", why.message);
    return rc;
}

/* ---- Result ---------------------------------------------------------------------------------- */

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
        doc = orl_json_checked(
            doc, json_object_set_new(doc, orl_glare_metric_name((enum orl_glare_metric)m), value));
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
        sources = orl_json_append(sources, source);
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
        "{s:o, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:o*, s:o*, s:o}", "metrics",
        metrics_to_json(glare, metrics), "class", orl_glare_class_name(glare->class_of),
        "threshold_cd_m2", glare->threshold_cd_m2, "task_luminance_cd_m2", glare->task_cd_m2,
        "direct_illuminance_lx", glare->direct_lx, "brightest_cd_m2", glare->most_cd_m2, "field_sr",
        glare->field_sr, "turned_deg", glare->turned_deg, "mask", part_to_json(&glare->masked),
        "band", part_to_json(&glare->band), "sources", sources_to_json(glare));
}

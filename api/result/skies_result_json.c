#include "result/skies_result_json.h"

#include <stdio.h>
#include <string.h>

#include "result/result_json.h"

json_t *orl_sky_result_to_json(const struct orl_result *result, const char *sky)
{
    json_t *doc = orl_result_to_json(result, "succeeded");
    if (doc && json_object_set_new(doc, "sky", json_string(sky))) {
        json_decref(doc);
        return NULL;
    }
    return doc;
}

json_t *orl_skies_result_new(uint64_t seed, uint32_t threads)
{
    json_t *timings = json_pack("{s:f}", "total", 0.0);
    for (int stage = 0; stage < ORL_STAGE_COUNT; stage++)
        json_object_set_new(timings, orl_stage_name((enum orl_stage)stage), json_real(0));
    return json_pack("{s:s, s:I, s:I, s:o, s:[], s:[]}", "state", "running", "threads",
                     (json_int_t)threads, "seed", (json_int_t)seed, "timings_s", timings, "skies",
                     "warnings");
}

static int add_timings(json_t *sums, const json_t *timings)
{
    const char *stage;
    json_t *sum;
    void *next;
    int rc = 0;
    json_object_foreach_safe(sums, next, stage, sum)
    {
        const double seconds = json_number_value(json_object_get(timings, stage));
        rc |= json_real_set(sum, json_real_value(sum) + seconds);
    }
    return rc;
}

static int add_warnings(json_t *all, const json_t *warnings)
{
    const json_t *warning, *known;
    size_t i, k;
    int rc = 0;
    json_array_foreach(warnings, i, warning)
    {
        bool is_known = false;
        json_array_foreach(all, k, known)
        {
            is_known = is_known || json_equal(known, warning);
        }
        if (!is_known)
            rc |= json_array_append(all, (json_t *)(uintptr_t)warning);
    }
    return rc;
}

static json_t *illuminances_of(const json_t *result)
{
    json_t *values = json_array();
    const json_t *sensor;
    size_t i;
    json_array_foreach(json_object_get(result, "sensors"), i, sensor)
    {
        json_array_append(values, json_object_get(sensor, "illuminance_lx"));
    }
    return values;
}

int orl_skies_result_add(json_t *results, const json_t *result)
{
    const char *name = json_string_value(json_object_get(result, "sky"));
    const json_t *timings = json_object_get(result, "timings_s");
    const json_t *plan = json_object_get(result, "plan");
    char file[96];
    snprintf(file, sizeof file, "%.80s.json", name ? name : "");
    json_t *entry = json_pack(
        "{s:s?, s:s, s:O, s:O, s:O, s:o, s:O, s:O*}", "name", name, "file", file, "dark",
        json_object_get(result, "dark"), "technique", json_object_get(plan, "technique"), "seconds",
        json_object_get(timings, "total"), "illuminance_lx", illuminances_of(result), "views",
        json_object_get(result, "views"), "accuracy", json_object_get(result, "accuracy"));
    if (!entry || json_array_append_new(json_object_get(results, "skies"), entry))
        return -1;
    return add_timings(json_object_get(results, "timings_s"), timings) |
           add_warnings(json_object_get(results, "warnings"), json_object_get(result, "warnings"));
}

int orl_skies_result_end(json_t *results, const char *state)
{
    return json_object_set_new(results, "state", json_string(state));
}

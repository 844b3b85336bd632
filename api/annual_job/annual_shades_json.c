#include "annual_job/annual_members_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/annual/annual_shades.h>
#include <oriel/base/limits.h>

#include "schemas.h"
#include "json/decode.h"
#include "json/encode.h"

/* ---- States ---------------------------------------------------------------------------------- */

static int decode_name(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_text_of(value, path, &orl_schema_file_name, into, err);
}

static int decode_state(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_shade_state *state = into;
    const struct orl_json_list files = {.items = &state->files,
                                        .count = &state->n_files,
                                        .size = sizeof *state->files,
                                        .each = decode_name};
    const struct orl_json_member members[] = {{"name", .text = &state->name},
                                              {"files", .list = &files},
                                              {"material", .text = &state->material},
                                              {"dark", .flag = &state->dark},
                                              {0}};
    return orl_json_members(value, path, &orl_schema_shade_state, members, err);
}

static int find_state(const struct orl_window_group *group, const char *name, const char *path,
                      uint32_t *ret_state, struct orl_error *err)
{
    for (size_t i = 0; i < group->n_states; i++)
        if (strcasecmp(group->states[i].name, name) == 0) {
            *ret_state = (uint32_t)i;
            return 0;
        }
    return orl_json_fail(err, ORL_ERR_INVALID, path, "'%s' has no state named '%s'", group->name,
                         name);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

static int decode_schedule(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_window_group *group = into;
    uint64_t state = 0;
    if (json_is_object(value)) {
        const struct orl_json_member members[] = {{"file", .text = &group->schedule_file}, {0}};
        return orl_json_members(value, path, &orl_schema_schedule_file, members, err);
    }
    int rc = orl_json_array_of(value, path, &orl_schema_shade_series, err);
    if (rc)
        return rc;
    group->series = calloc(json_array_size(value) + 1, 1);
    if (!group->series)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < json_array_size(value) && rc == 0; i++) {
        char place[ORL_JSON_PATH_MAX];
        snprintf(place, sizeof place, "%.150s[%zu]", path, i);
        rc = orl_json_whole(json_array_get(value, i), place, 0, group->n_states - 1, &state, err);
        group->series[group->n_series++] = (unsigned char)state;
    }
    return rc;
}

static int decode_months(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_shade_span *span = into;
    uint32_t from, to;
    if (!json_is_array(value) || json_array_size(value) != 2)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "two months are expected: [5, 9]");
    const struct orl_json_member first = {.whole_32 = &from}, last = {.whole_32 = &to};
    int rc = orl_json_value(json_array_get(value, 0), path, &orl_schema_month, &first, err);
    if (rc == 0)
        rc = orl_json_value(json_array_get(value, 1), path, &orl_schema_month, &last, err);
    if (rc)
        return rc;
    span->from_month = from;
    span->to_month = to;
    return 0;
}

/* A rule while it is decoded: the state is still a name. */
struct draft {
    struct orl_shade_span span;
    char *state;
};

static int decode_rule(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    draft->span = (struct orl_shade_span){.from_month = 1, .to_month = 12, .from_h = 0, .to_h = 24};
    const struct orl_json_member members[] = {
        {"months", .decode = decode_months, .into = &draft->span},
        {"from", .real = &draft->span.from_h},
        {"to", .real = &draft->span.to_h},
        {"state", .text = &draft->state},
        {0}};
    return orl_json_members(value, path, &orl_schema_shade_rule, members, err);
}

static int decode_rules(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_window_group *group = into;
    struct draft *drafts = NULL;
    size_t n = 0;
    const struct orl_json_list list = {
        .items = &drafts, .count = &n, .size = sizeof *drafts, .each = decode_rule};
    int rc = orl_json_list(value, path, &orl_schema_window_group_rules, &list, err);
    if (rc == 0) {
        group->spans = calloc(n + 1, sizeof *group->spans);
        rc = group->spans ? 0 : orl_error_no_memory(err);
    }
    for (size_t i = 0; group->spans && i < n && rc == 0; i++) {
        rc = find_state(group, drafts[i].state, path, &drafts[i].span.state, err);
        group->spans[group->n_spans++] = drafts[i].span;
    }
    for (size_t i = 0; drafts && i < n; i++)
        free(drafts[i].state);
    free(drafts);
    return rc;
}

static const double lm83_lx = 1000, lm83_share = 2, usual_dgp = 0.4;

static int check_control(const struct orl_window_group *group, bool lm83, const char *path,
                         struct orl_error *err)
{
    const struct orl_shade_control *control = &group->control;
    if (lm83 && (control->above_lx != lm83_lx || control->share_percent != lm83_share))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "LM-83 has fixed bounds: use \"by\": \"sun\" for others");
    if (control->kind == ORL_SHADES_BY_LIGHT && control->share_percent != lm83_share)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "\"share\" is only for control by sun");
    if (control->kind == ORL_SHADES_BY_LIGHT && !control->grid)
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "control by illuminance needs the \"grid\" of its sensors");
    const bool glare = control->kind == ORL_SHADES_BY_GLARE;
    if (glare != (control->viewpoints.n_viewpoints > 0))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "control by dgp needs \"seats\", and other controls must have none");
    if (glare && (control->grid || control->share_percent != lm83_share))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "control by dgp uses \"seats\": leave \"grid\" and \"share\" out");
    return 0;
}

static int decode_control(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_window_group *group = into;
    struct orl_shade_control *control = &group->control;
    unsigned by = 0;
    char *state = NULL;
    double above = 0;
    control->share_percent = lm83_share;
    control->state = 1;
    const struct orl_json_member members[] = {
        {"by", .word = &by},
        {"grid", .text = &control->grid},
        {"above", .real = &above},
        {"seats", .decode = orl_viewpoints_from_json, .into = &control->viewpoints},
        {"share", .real = &control->share_percent},
        {"state", .text = &state},
        {0}};
    int rc = orl_json_members(value, path, &orl_schema_shade_control, members, err);
    control->kind = by == 3   ? ORL_SHADES_BY_GLARE
                    : by == 2 ? ORL_SHADES_BY_LIGHT
                              : ORL_SHADES_BY_SUN;
    control->above_lx = by < 3 && above > 0 ? above : lm83_lx;
    control->above_dgp = by == 3 && above > 0 ? above : usual_dgp;
    if (rc == 0)
        rc = check_control(group, by == 0, path, err);
    if (rc == 0 && state)
        rc = find_state(group, state, path, &control->state, err);
    free(state);
    return rc;
}

/* ---- Groups ---------------------------------------------------------------------------------- */

static int decode_group(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_window_group *group = into;
    const struct orl_json_list windows = {.items = &group->windows,
                                          .count = &group->n_windows,
                                          .size = sizeof *group->windows,
                                          .each = decode_name},
                               states = {.items = &group->states,
                                         .count = &group->n_states,
                                         .size = sizeof *group->states,
                                         .each = decode_state};
    const struct orl_json_member members[] = {
        {"name", .text = &group->name},
        {"windows", .list = &windows},
        {"states", .list = &states},
        {"schedule", .decode = decode_schedule, .into = group},
        {"rules", .decode = decode_rules, .into = group},
        {"control", .decode = decode_control, .into = group},
        {0}};
    return orl_json_members(value, path, &orl_schema_window_group, members, err);
}

int orl_annual_shades_from_json(const json_t *value, const char *path, void *into,
                                struct orl_error *err)
{
    struct orl_annual_request *request = into;
    const struct orl_json_list groups = {.items = &request->groups,
                                         .count = &request->n_groups,
                                         .size = sizeof *request->groups,
                                         .each = decode_group};
    return orl_json_list(value, path, &orl_schema_annual_request_shades, &groups, err);
}

/* ---- The result ------------------------------------------------------------------------------ */

static const char *rule_of(const struct orl_window_group *group)
{
    return group->series                                  ? "schedule"
           : group->n_spans > 0                           ? "rules"
           : group->control.kind == ORL_SHADES_NO_CONTROL ? "none"
                                                          : "control";
}

void orl_annual_state_hours(const struct orl_annual_result *result,
                            const struct orl_annual_report *report, size_t group,
                            struct orl_state_hours ret_hours[ORL_SHADES_MOST_STATES])
{
    const unsigned char *states = result->states + group * result->n_steps;
    const double step_h = 1.0 / report->year.steps.per_hour;
    memset(ret_hours, 0, ORL_SHADES_MOST_STATES * sizeof *ret_hours);
    for (size_t c = 0; c < result->n_columns; c++) {
        struct orl_state_hours *hours = &ret_hours[states[result->step_of_column[c]]];
        hours->lit += step_h;
        if (report->marks[report->year.step_of_column[c]])
            hours->occupied += step_h;
    }
}

static json_t *states_to_json(const struct orl_window_group *group,
                              const struct orl_state_hours *hours)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < group->n_states; i++)
        array = orl_json_append(
            array, json_pack("{s:o, s:f, s:f}", "name", orl_json_from_text(group->states[i].name),
                             "hours", hours[i].lit, "occupied_hours", hours[i].occupied));
    return array;
}

json_t *orl_annual_shades_to_json(const struct orl_annual_request *request,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_report *report)
{
    if (!result->states)
        return json_null();
    json_t *groups = json_array();
    for (size_t g = 0; groups && g < request->n_groups; g++) {
        const struct orl_window_group *group = &request->groups[g];
        struct orl_state_hours hours[ORL_SHADES_MOST_STATES];
        orl_annual_state_hours(result, report, g, hours);
        groups = orl_json_append(
            groups, json_pack("{s:o, s:s, s:o}", "name", orl_json_from_text(group->name), "by",
                              rule_of(group), "states", states_to_json(group, hours)));
    }
    return json_pack("{s:I, s:b, s:o}", "runs", (json_int_t)result->n_runs, "summed",
                     (int)result->summed, "groups", groups);
}

/* ---- Settings -------------------------------------------------------------------------------- */

static json_t *names_to_json(char *const *names, size_t n)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < n; i++)
        array = orl_json_append(array, orl_json_from_text(names[i]));
    return array;
}

static json_t *settings_of_states(const struct orl_window_group *group)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < group->n_states; i++) {
        const struct orl_shade_state *s = &group->states[i];
        array = orl_json_append(
            array, json_pack("{s:o, s:o, s:o, s:b}", "name", orl_json_from_text(s->name), "files",
                             names_to_json(s->files, s->n_files), "material",
                             orl_json_from_text(s->material), "dark", (int)s->dark));
    }
    return array;
}

static json_t *settings_of_rules(const struct orl_window_group *group)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < group->n_spans; i++) {
        const struct orl_shade_span *s = &group->spans[i];
        array = orl_json_append(array, json_pack("{s:[ii], s:f, s:f, s:o}", "months",
                                                 (int)s->from_month, (int)s->to_month, "from",
                                                 s->from_h, "to", s->to_h, "state",
                                                 orl_json_from_text(group->states[s->state].name)));
    }
    return array;
}

static json_t *settings_of_control(const struct orl_window_group *group)
{
    const struct orl_shade_control *c = &group->control;
    if (c->kind == ORL_SHADES_NO_CONTROL)
        return json_null();
    return json_pack("{s:s, s:o, s:f, s:o, s:o}", "by",
                     c->kind == ORL_SHADES_BY_SUN     ? "sun"
                     : c->kind == ORL_SHADES_BY_GLARE ? "dgp"
                                                      : "illuminance",
                     "grid", orl_json_from_text(c->grid), "above",
                     c->kind == ORL_SHADES_BY_GLARE ? c->above_dgp : c->above_lx, "share",
                     c->kind == ORL_SHADES_BY_SUN ? json_real(c->share_percent) : json_null(),
                     "state", orl_json_from_text(group->states[c->state].name));
}

json_t *orl_annual_shades_settings(const struct orl_annual_request *request)
{
    json_t *array = json_array();
    for (size_t g = 0; array && g < request->n_groups; g++) {
        const struct orl_window_group *group = &request->groups[g];
        array = orl_json_append(
            array,
            json_pack("{s:o, s:o, s:o, s:b, s:o, s:o}", "name", orl_json_from_text(group->name),
                      "windows", names_to_json(group->windows, group->n_windows), "states",
                      settings_of_states(group), "schedule", group->series != NULL, "rules",
                      settings_of_rules(group), "control", settings_of_control(group)));
    }
    return array;
}

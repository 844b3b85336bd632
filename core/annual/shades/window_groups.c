/* Window groups of a request: validation and freeing. */
#include <oriel/annual/annual.h>
#include <oriel/annual/annual_glare.h>

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void free_names(char **names, size_t n)
{
    for (size_t i = 0; names && i < n; i++)
        free(names[i]);
    free(names);
}

void orl_window_group_done(struct orl_window_group *group)
{
    if (!group)
        return;
    for (size_t i = 0; group->states && i < group->n_states; i++) {
        free(group->states[i].name);
        free_names(group->states[i].files, group->states[i].n_files);
        free(group->states[i].material);
    }
    free_names(group->windows, group->n_windows);
    free(group->name);
    free(group->states);
    free(group->series);
    free(group->schedule_file);
    free(group->spans);
    free(group->control.grid);
    orl_viewpoint_request_done(&group->control.viewpoints);
    *group = (struct orl_window_group){.name = NULL};
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static int check_states(const struct orl_window_group *group, struct orl_error *err)
{
    if (group->n_states == 0 || group->n_states > ORL_SHADES_MOST_STATES)
        return orl_error_set(err, ORL_ERR_LIMIT, "'%.100s' has %zu states: 1 to %d are wanted",
                             group->name, group->n_states, ORL_SHADES_MOST_STATES);
    for (size_t i = 0; i < group->n_states; i++) {
        const struct orl_shade_state *state = &group->states[i];
        if ((state->material || state->dark) && group->n_windows == 0)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "the state '%.100s' changes the windows of '%.100s', which names "
                                 "none",
                                 state->name, group->name);
        if (state->material && state->dark)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "the state '%.100s' of '%.100s' is dark, and has a material",
                                 state->name, group->name);
        for (size_t k = 0; k < i; k++)
            if (strcasecmp(group->states[k].name, state->name) == 0)
                return orl_error_set(err, ORL_ERR_INVALID,
                                     "two states of '%.100s' are named '%.100s'", group->name,
                                     state->name);
    }
    return 0;
}

static int no_state(const struct orl_window_group *group, uint32_t state, struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_RANGE, "'%.100s' has no state %u: its last one is %zu",
                         group->name, state, group->n_states - 1);
}

static bool has_grid(const struct orl_annual_request *request, const char *name)
{
    for (size_t i = 0; i < request->n_grids; i++)
        if (request->grids[i].name && strcasecmp(request->grids[i].name, name) == 0)
            return true;
    return false;
}

static int check_control(const struct orl_annual_request *request,
                         const struct orl_window_group *group, struct orl_error *err)
{
    const struct orl_shade_control *control = &group->control;
    if (control->kind == ORL_SHADES_NO_CONTROL)
        return 0;
    if (control->state >= group->n_states)
        return no_state(group, control->state, err);
    if (control->kind == ORL_SHADES_BY_GLARE) {
        if (control->viewpoints.n_viewpoints == 0 ||
            !(control->above_dgp > 0 && control->above_dgp < 1))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "the control of '%.100s' wants a seat, and a DGP between 0 and 1",
                                 group->name);
        return orl_viewpoints_validate(&control->viewpoints, request, err);
    }
    if (!(control->above_lx > 0) || !(control->share_percent >= 0 && control->share_percent <= 100))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "the control of '%.100s' wants lux above 0, and 0 to 100 %%",
                             group->name);
    if (control->grid && !has_grid(request, control->grid))
        return orl_error_set(err, ORL_ERR_INVALID,
                             "'%.100s' is controlled by the grid '%.100s', which there is not",
                             group->name, control->grid);
    return 0;
}

static int check_hours(const struct orl_window_group *group, struct orl_error *err)
{
    const bool controlled = group->control.kind != ORL_SHADES_NO_CONTROL;
    const bool listed = group->series || group->schedule_file;
    if (listed + (group->n_spans > 0) + controlled > 1)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "'%.100s' has more than one of schedule, rules and control",
                             group->name);
    for (size_t i = 0; group->series && i < group->n_series; i++)
        if (group->series[i] >= group->n_states)
            return no_state(group, group->series[i], err);
    for (size_t i = 0; i < group->n_spans; i++) {
        const struct orl_shade_span *s = &group->spans[i];
        if (s->state >= group->n_states)
            return no_state(group, s->state, err);
        if (s->from_month < 1 || s->from_month > 12 || s->to_month < 1 || s->to_month > 12 ||
            !(s->from_h >= 0 && s->from_h <= 24 && s->to_h >= 0 && s->to_h <= 24))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "a rule of '%.100s' wants months 1 to 12, and hours 0 to 24",
                                 group->name);
    }
    return 0;
}

int orl_shades_validate(const struct orl_annual_request *request, struct orl_error *err)
{
    int code = 0;
    if (request->n_groups > ORL_SHADES_MOST_GROUPS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu window groups are more than %d",
                             request->n_groups, ORL_SHADES_MOST_GROUPS);
    for (size_t g = 0; g < request->n_groups && code == 0; g++) {
        const struct orl_window_group *group = &request->groups[g];
        for (size_t k = 0; k < g && code == 0; k++)
            if (strcasecmp(request->groups[k].name, group->name) == 0)
                code = orl_error_set(err, ORL_ERR_INVALID, "two window groups are named '%.100s'",
                                     group->name);
        if (code == 0)
            code = check_states(group, err);
        if (code == 0)
            code = check_hours(group, err);
        if (code == 0)
            code = check_control(request, group, err);
    }
    if (code < 0)
        orl_error_at(err, NULL, 0, "shades");
    return code;
}

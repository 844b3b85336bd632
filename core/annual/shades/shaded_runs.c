/*
 * A year with shades: the states of each hour, and the runs that give its light. Each combination
 * of states gets a run. If fewer runs suffice, one run has all groups in their first state, one in
 * their second, and so on. Light is then added up by group.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_glare.h>

#include "annual/matrices/imported_matrices.h"
#include "annual/shades/shaded_year.h"
#include "scene/surfaces.h"

enum { MOST = ORL_SHADES_MOST_COMBINATIONS };

static int check_cancelled(const struct orl_shaded_year *s)
{
    return orl_is_cancelled(s->env->run->cancel) ? orl_year_cancelled(s->err) : 0;
}

/* ---- Runs of all light ----------------------------------------------------------------------- */

/* Runs the year with all groups open. Its arrays become the result's. */
static int run_open(struct orl_shaded_year *s, double share)
{
    const struct orl_sub_run sub = {.states = s->combinations[0], .share = share};
    struct orl_annual_result run = {.n_sensors = 0};
    const int code = orl_shaded_year_run(s, &sub, &run);
    if (code == 0) {
        s->result->total = run.total;
        s->result->direct = run.direct;
        s->result->se = run.se;
        s->result->overcast = run.overcast;
        s->result->overcast_se = run.overcast_se;
        s->result->coherence = run.coherence;
        s->opened = true;
        run.total = run.direct = run.se = run.overcast = run.overcast_se = run.coherence = NULL;
    }
    orl_annual_done(&run);
    return code;
}

/* Raises coherence to the largest of the runs that contribute hours, so that intervals are wide
 * enough for each. */
static void raise_coherence(struct orl_annual_result *all, const struct orl_annual_result *run)
{
    for (size_t i = 0; i < all->n_sensors; i++)
        all->coherence[i] = fmaxf(all->coherence[i], run->coherence[i]);
}

/* Resets the coherence of the open run if no hour of that run remains. */
static void drop_open_coherence(struct orl_shaded_year *s)
{
    size_t c = 0;
    while (c < s->result->n_columns && s->combination_of[c] != 0)
        c++;
    if (s->opened && c == s->result->n_columns && s->result->coherence)
        memset(s->result->coherence, 0, s->result->n_sensors * sizeof *s->result->coherence);
}

/* Runs a combination, and copies total and errors of the hours that have it. */
static int run_combination(struct orl_shaded_year *s, size_t index, double share)
{
    const struct orl_sub_run sub = {
        .states = s->combinations[index], .index = (uint32_t)index, .share = share};
    struct orl_annual_result run = {.n_sensors = 0}, *all = s->result;
    const size_t columns = all->n_columns;
    int code = orl_shaded_year_run(s, &sub, &run);
    for (size_t i = 0; i < all->n_sensors && code == 0; i++) {
        for (size_t c = 0; c < columns; c++) {
            if (s->combination_of[c] != index)
                continue;
            all->total[i * columns + c] = run.total[i * columns + c];
            all->se[i * columns + c] = run.se[i * columns + c];
        }
        code = check_cancelled(s);
    }
    if (code == 0)
        raise_coherence(all, &run);
    orl_annual_done(&run);
    return code;
}

/* ---- Controls -------------------------------------------------------------------------------- */

static void count_sunlit(void *ctx, size_t sensor, uint32_t window_group, const float *lx)
{
    struct orl_shaded_year *s = ctx;
    if (window_group < s->request->n_groups && s->counts[window_group].lit)
        orl_shade_count_add(&s->counts[window_group], s->request,
                            &s->request->groups[window_group].control, sensor, lx);
}

static int begin_count(struct orl_shaded_year *s, size_t g)
{
    return orl_shade_count_init(&s->counts[g], &s->arrays, s->result->n_columns) < 0
               ? orl_year_no_memory(s->err)
               : 0;
}

static size_t count_controls(const struct orl_shaded_year *s, enum orl_shade_control_kind kind)
{
    size_t n = 0;
    for (size_t g = 0; g < s->request->n_groups; g++)
        n += s->request->groups[g].control.kind == kind;
    return n;
}

/* Counts sensors in direct sunlight, by the windows of each group whose control is by sun. */
static int count_direct(struct orl_shaded_year *s, double share)
{
    const size_t groups = s->request->n_groups;
    bool used[ORL_SHADES_MOST_GROUPS] = {false};
    for (size_t g = 0; g < groups; g++) {
        used[g] = s->request->groups[g].control.kind == ORL_SHADES_BY_SUN;
        if (used[g] && begin_count(s, g) < 0)
            return ORL_ERR_NOMEM;
    }
    if (count_controls(s, ORL_SHADES_BY_SUN) == 0)
        return 0;
    const struct orl_year_window_groups window_groups = {
        .n_groups = groups, .used = used, .sunlit = count_sunlit, .ctx = s};
    const struct orl_sub_run sub = {.states = s->combinations[0],
                                    .index = MOST,
                                    .window_groups = &window_groups,
                                    .sun_only = true,
                                    .share = share};
    struct orl_annual_result run = {.n_sensors = 0};
    int code = orl_shaded_year_run(s, &sub, &run);
    orl_annual_done(&run);
    if (code == 0 || code != ORL_ERR_UNSUPPORTED || groups > 1 || !s->opened)
        return code;
    /* Light through openings, or through windows inside a building, belongs to no group. If there
     * is only one group, all direct sunlight counts instead. */
    code = begin_count(s, 0);
    for (size_t i = 0; i < s->result->n_sensors && code == 0; i++) {
        count_sunlit(s, i, 0, orl_annual_row(s->result, s->result->direct, i));
        code = check_cancelled(s);
    }
    return code;
}

/* Finds the columns in which DGP at some viewpoint exceeds the control's limit, with all groups
 * open. */
static int find_glare(struct orl_shaded_year *s, const struct orl_shade_control *control,
                      bool *closed)
{
    const size_t columns = s->result->n_columns;
    struct orl_viewpoint_hours *viewpoints = NULL;
    unsigned char *wanted = malloc(columns + 1);
    if (!wanted)
        return orl_year_no_memory(s->err);
    memset(wanted, 1, columns);
    const int code = orl_annual_glare_compute(&control->viewpoints, s->request, s->result, wanted,
                                              s->env->run, &viewpoints, s->err);
    free(wanted);
    if (code < 0)
        return code;
    for (size_t c = 0; c < columns; c++) {
        closed[c] = false;
        for (size_t i = 0; i < control->viewpoints.n_viewpoints; i++)
            closed[c] = closed[c] || (double)viewpoints[i].dgp[c] > control->above_dgp;
    }
    orl_viewpoint_hours_free(viewpoints, control->viewpoints.n_viewpoints);
    return 0;
}

static int find_light(struct orl_shaded_year *s, size_t g, bool *closed)
{
    const struct orl_shade_control *control = &s->request->groups[g].control;
    const struct orl_annual_result *r = s->result;
    struct orl_shade_count *count = &s->counts[g];
    if (!count->lit) {
        int code = begin_count(s, g);
        for (size_t i = 0; i < r->n_sensors && code == 0; i++) {
            orl_shade_count_add(count, s->request, control, i, orl_annual_row(r, r->total, i));
            code = check_cancelled(s);
        }
        if (code < 0)
            return code;
    }
    orl_shade_count_end(count, s->request, control);
    memcpy(closed, count->closed, r->n_columns * sizeof *closed);
    return 0;
}

static int control_group(struct orl_shaded_year *s, size_t g, bool *closed)
{
    const struct orl_shade_control *control = &s->request->groups[g].control;
    const struct orl_annual_result *r = s->result;
    const int code = control->kind == ORL_SHADES_BY_GLARE ? find_glare(s, control, closed)
                                                          : find_light(s, g, closed);
    if (code < 0)
        return code;
    for (size_t c = 0; c < r->n_columns; c++)
        s->states[g * r->n_steps + r->step_of_column[c]] =
            closed[c] ? (unsigned char)control->state : 0;
    return 0;
}

static int control_groups(struct orl_shaded_year *s, double share)
{
    bool *closed = malloc(s->result->n_columns + 1);
    int code = closed ? count_direct(s, share) : orl_year_no_memory(s->err);
    for (size_t g = 0; g < s->request->n_groups && code == 0; g++)
        if (s->request->groups[g].control.kind != ORL_SHADES_NO_CONTROL)
            code = control_group(s, g, closed);
    free(closed);
    return code;
}

/* ---- By combinations ------------------------------------------------------------------------- */

static void find_combinations(struct orl_shaded_year *s)
{
    const size_t groups = s->request->n_groups, steps = s->result->n_steps;
    for (size_t c = 0; c < s->result->n_columns; c++) {
        unsigned char states[ORL_SHADES_MOST_GROUPS];
        size_t k = 0;
        for (size_t g = 0; g < groups; g++)
            states[g] = s->states[g * steps + s->result->step_of_column[c]];
        while (k < s->n_combinations && memcmp(s->combinations[k], states, groups) != 0)
            k++;
        if (k == s->n_combinations && k < MOST)
            memcpy(s->combinations[s->n_combinations++], states, groups);
        s->combination_of[c] = (unsigned char)k;
    }
}

static bool has_more_than_room(const struct orl_shaded_year *s)
{
    for (size_t c = 0; c < s->result->n_columns; c++)
        if (s->combination_of[c] == MOST)
            return true;
    return false;
}

/* ---- By window groups
 * -------------------------------------------------------------------------------- */

/* A run with all groups in one state. Groups that lack the state are in their first one. */
struct pass {
    size_t state;
    unsigned char states[ORL_SHADES_MOST_GROUPS];
    bool used[ORL_SHADES_MOST_GROUPS];
    unsigned char
        *wanted; /* [window group][column]; the last window group holds windows of no group */
    bool any;    /* true if light of some window group is wanted in some column */
};

/* Returns true if light of a window group in that state counts in a column. A dark group lets no
 * light in. */
static bool is_wanted(const struct orl_shaded_year *s, size_t window_group, size_t state,
                      size_t column)
{
    const struct orl_annual_result *r = s->result;
    if (s->opened && s->combination_of[column] == 0)
        return false; /* the run of all open has filled this column */
    if (window_group == s->request->n_groups)
        return state == 0;
    return s->states[window_group * r->n_steps + r->step_of_column[column]] == state &&
           !s->request->groups[window_group].states[state].dark;
}

static int make_pass(const struct orl_shaded_year *s, size_t state, struct pass *pass)
{
    const size_t groups = s->request->n_groups, columns = s->result->n_columns;
    *pass = (struct pass){.state = state, .wanted = calloc((groups + 1) * columns + 1, 1)};
    if (!pass->wanted)
        return orl_year_no_memory(s->err);
    for (size_t window_group = 0; window_group <= groups; window_group++) {
        bool used = false;
        if (window_group < groups && state >= s->request->groups[window_group].n_states)
            continue;
        for (size_t c = 0; c < columns; c++) {
            const bool wanted = is_wanted(s, window_group, state, c);
            pass->wanted[window_group * columns + c] = wanted;
            used = used || wanted;
        }
        pass->any = pass->any || used;
        if (window_group < groups) {
            pass->used[window_group] = used;
            pass->states[window_group] = (unsigned char)state;
        }
    }
    return 0;
}

/* Adds a run's light to the result. Without a run of all open, the first pass also supplies direct
 * sunlight and the light of the overcast sky. */
static int add_run(struct orl_shaded_year *s, struct orl_annual_result *run, bool first)
{
    struct orl_annual_result *all = s->result;
    const size_t columns = all->n_columns;
    int code = 0;
    for (size_t i = 0; i < all->n_sensors && code == 0; i++) {
        for (size_t at = i * columns; at < (i + 1) * columns; at++) {
            all->total[at] += run->total[at];
            all->se[at] = hypotf(all->se[at], run->se[at]);
        }
        code = check_cancelled(s);
    }
    if (all->coherence)
        raise_coherence(all, run);
    if (!first || code < 0)
        return code;
    all->direct = run->direct;
    all->overcast = run->overcast;
    all->overcast_se = run->overcast_se;
    all->coherence = run->coherence;
    run->direct = run->overcast = run->overcast_se = run->coherence = NULL;
    return 0;
}

static int run_pass(struct orl_shaded_year *s, struct pass *pass, double share)
{
    const bool first = pass->state == 0 && !s->opened;
    const struct orl_year_window_groups window_groups = {.n_groups = s->request->n_groups,
                                                         .used = pass->used,
                                                         .wanted = pass->wanted,
                                                         .direct_as_wanted = !first};
    const struct orl_sub_run sub = {.states = pass->states,
                                    .index = 2 * MOST + (uint32_t)pass->state,
                                    .window_groups = &window_groups,
                                    .share = share};
    struct orl_annual_result run = {.n_sensors = 0};
    if (!pass->any && !first)
        return 0;
    int code = orl_shaded_year_run(s, &sub, &run);
    if (code == 0)
        code = add_run(s, &run, first);
    orl_annual_done(&run);
    return code;
}

/* Clears the hours whose light will be added up. */
static int begin_sums(struct orl_shaded_year *s)
{
    struct orl_annual_result *all = s->result;
    const size_t columns = all->n_columns;
    if (!s->opened) {
        all->total = calloc(all->n_sensors * columns + 1, sizeof *all->total);
        all->se = calloc(all->n_sensors * columns + 1, sizeof *all->se);
        return all->total && all->se ? 0 : orl_year_no_memory(s->err);
    }
    for (size_t c = 0; c < columns; c++)
        for (size_t i = 0; s->combination_of[c] != 0 && i < all->n_sensors; i++)
            all->total[i * columns + c] = all->se[i * columns + c] = 0;
    return 0;
}

static int run_by_window_group(struct orl_shaded_year *s, double share)
{
    const size_t n = orl_shades_most_states(s->request);
    orl_year_warn(s->reader, "window groups have many combinations of states: light was computed "
                             "for each group and added up. Meanwhile the panes of other groups "
                             "reflected as if in the same state as that group");
    int code = begin_sums(s);
    for (size_t state = 0; state < n && code == 0; state++) {
        struct pass pass;
        code = make_pass(s, state, &pass);
        if (code == 0)
            code = run_pass(s, &pass, share / (double)n);
        free(pass.wanted);
    }
    return code;
}

/* ---- Which runs ------------------------------------------------------------------------------ */

/* Cost of a run of direct sunlight, relative to a run of all light. */
static const double cost_of_direct = 0.1;

/* Returns an upper bound of the number of combinations, by schedules and by controls. */
static double most_combinations(struct orl_shaded_year *s)
{
    find_combinations(s);
    const size_t controlled = s->request->n_groups - count_controls(s, ORL_SHADES_NO_CONTROL);
    const double most = ldexp((double)s->n_combinations, (int)controlled);
    s->n_combinations = 1;
    return has_more_than_room(s) ? INFINITY : most;
}

/* Returns the number of states in use, plus one for windows in no group. If there are more
 * combinations than that, light is added up by window groups. */
static size_t count_group_states(const struct orl_shaded_year *s)
{
    size_t n = 1; /* windows in no group */
    for (size_t g = 0; g < s->request->n_groups; g++)
        for (size_t k = 0; k < s->request->groups[g].n_states; k++) {
            bool used = false;
            for (size_t c = 0; c < s->result->n_columns && !used; c++)
                used = s->combination_of[c] != 0 &&
                       s->states[g * s->result->n_steps + s->result->step_of_column[c]] == k;
            n += used;
        }
    return n;
}

/* Returns true if a control needs light that only the run of all open computes. */
static bool needs_open_first(const struct orl_shaded_year *s)
{
    return count_controls(s, ORL_SHADES_BY_LIGHT) > 0 ||
           count_controls(s, ORL_SHADES_BY_GLARE) > 0 || s->request->n_groups == 1;
}

static int run_all(struct orl_shaded_year *s)
{
    const double direct = count_controls(s, ORL_SHADES_BY_SUN) > 0 ? cost_of_direct : 0;
    const double others =
        fmin(most_combinations(s) - 1, (double)orl_shades_most_states(s->request));
    const double all = 1 + direct + others;
    int code = needs_open_first(s) ? run_open(s, 1 / all) : 0;
    if (code == 0)
        code = control_groups(s, direct / all);
    if (code < 0)
        return code;
    find_combinations(s);
    s->summed = has_more_than_room(s) || s->n_combinations - 1 > count_group_states(s);
    if (!s->summed && !s->opened)
        code = run_open(s, (1 - s->reported_progress) / (double)s->n_combinations);
    drop_open_coherence(s);
    const double left = fmax(1 - s->reported_progress, 0);
    if (s->summed)
        return run_by_window_group(s, left);
    for (size_t i = 1; i < s->n_combinations && code == 0; i++)
        code = run_combination(s, i, left / (double)(s->n_combinations - 1));
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int deliver_rows(struct orl_shaded_year *s)
{
    struct orl_annual_result *r = s->result;
    int code = 0;
    for (size_t i = 0; s->env->row && i < r->n_sensors && code == 0; i++)
        code = s->env->row(s->env->ctx, i, orl_annual_row(r, r->total, i),
                           orl_annual_row(r, r->direct, i), orl_annual_row(r, r->se, i), s->err);
    if (!s->env->row)
        return code;
    free(r->total);
    free(r->direct);
    free(r->se);
    r->total = r->direct = r->se = NULL;
    return code;
}

static int run_shaded_year(struct orl_shaded_year *s)
{
    int code = orl_shaded_year_begin(s);
    if (code == 0 && s->env->begins)
        code = s->env->begins(s->env->ctx, s->result, s->err);
    if (code == 0)
        code = run_all(s);
    if (code < 0)
        return code;
    s->result->states = s->states;
    s->states = NULL;
    s->result->n_groups = s->request->n_groups;
    s->result->summed = s->summed;
    s->result->total_s = orl_year_now(s->reader) - s->reader->started_s;
    return deliver_rows(s);
}

static int run_shaded(const struct orl_annual_request *request, const struct orl_annual_env *env,
                      struct orl_annual_result *ret_result, struct orl_error *err)
{
    struct orl_annual_result result = {.seed = request->seed, .n_sensors = request->n_sensors};
    struct orl_shaded_year s = {.request = request, .env = env, .result = &result, .err = err};
    s.reader = calloc(1, sizeof *s.reader);
    const int code = s.reader ? run_shaded_year(&s) : orl_year_no_memory(s.err);
    orl_shaded_year_done(&s);
    if (code < 0)
        orl_annual_done(&result);
    else
        *ret_result = result;
    return code;
}

int orl_annual_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                   struct orl_annual_result *ret_result, struct orl_error *err)
{
    const int code = orl_annual_validate(request, err);
    if (code < 0)
        return code;
    if (request->n_terms > 0)
        return orl_annual_run_matrices(request, env, ret_result, err);
    return request->n_groups > 0 ? run_shaded(request, env, ret_result, err)
                                 : orl_year_run(request, env, NULL, ret_result, err);
}

/*
 * A year with shades: which states there are in which hours; a run of each combination of them, or
 * where that is fewer runs, of each group's states by themselves, whose light is added up.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual_glare.h>

#include "annual/matrices.h"
#include "annual/schedule.h"
#include "annual/shading.h"
#include "scene/swap.h"

enum { MOST = ORL_SHADES_MOST_COMBINATIONS };

/* ---- Runs of all light ----------------------------------------------------------------------- */

/* All open: its arrays are the result's. */
static int run_open(struct orl_shading *s, double share)
{
    const struct orl_sub_run sub = {.states = s->combinations[0], .share = share};
    struct orl_annual_result run = {.n_sensors = 0};
    const int code = orl_shading_run(s, &sub, &run);
    if (code == 0) {
        s->result->total = run.total;
        s->result->direct = run.direct;
        s->result->se = run.se;
        s->result->overcast = run.overcast;
        s->result->overcast_se = run.overcast_se;
        run.total = run.direct = run.se = run.overcast = run.overcast_se = NULL;
    }
    orl_annual_done(&run);
    return code;
}

/* Of the hours that have it, total and errors are the run's. */
static int run_combination(struct orl_shading *s, size_t index, double share)
{
    const struct orl_sub_run sub = {
        .states = s->combinations[index], .index = (uint32_t)index, .share = share};
    struct orl_annual_result run = {.n_sensors = 0}, *all = s->result;
    const size_t columns = all->n_columns;
    const int code = orl_shading_run(s, &sub, &run);
    for (size_t i = 0; i < all->n_sensors && code == 0; i++)
        for (size_t c = 0; c < columns; c++) {
            if (s->which[c] != index)
                continue;
            all->total[i * columns + c] = run.total[i * columns + c];
            all->se[i * columns + c] = run.se[i * columns + c];
        }
    orl_annual_done(&run);
    return code;
}

/* ---- Controls -------------------------------------------------------------------------------- */

/* Direct sunlight by the group's own windows; *ret_owned NULL: all there is of it. */
static int find_direct(struct orl_shading *s, size_t g, float **ret_owned)
{
    const struct orl_sub_run sub = {.states = s->combinations[0],
                                    .index = MOST + (uint32_t)g,
                                    .part = (uint32_t)g + 1,
                                    .sun_only = true,
                                    .share = s->share_of_direct};
    struct orl_annual_result run = {.n_sensors = 0};
    const bool alone = s->request->n_groups == 1;
    *ret_owned = NULL;
    int code = orl_shading_run(s, &sub, &run);
    /* Of openings, and windows inside a building, nothing is told apart. */
    if (code == ORL_ERR_UNSUPPORTED && alone && (s->ports.open || s->ports.of_part[0] == 0))
        code = 0;
    *ret_owned = run.direct;
    run.direct = NULL;
    orl_annual_done(&run);
    return code;
}

/* In which columns a seat is dazzled, all groups being open. */
static int find_glare(struct orl_shading *s, const struct orl_shade_control *control, bool *closed)
{
    const size_t columns = s->result->n_columns;
    struct orl_seat_hours *seats = NULL;
    unsigned char *wanted = malloc(columns + 1);
    if (!wanted)
        return orl_year_no_memory(s->err);
    memset(wanted, 1, columns);
    const int code = orl_annual_glare_find(&control->seats, s->request, s->result, wanted,
                                           s->env->run, &seats, s->err);
    free(wanted);
    if (code < 0)
        return code;
    for (size_t c = 0; c < columns; c++) {
        closed[c] = false;
        for (size_t i = 0; i < control->seats.n_seats; i++)
            closed[c] = closed[c] || (double)seats[i].dgp[c] > control->above_dgp;
    }
    orl_seat_hours_free(seats, control->seats.n_seats);
    return 0;
}

static int find_light(struct orl_shading *s, size_t g, bool *closed)
{
    const struct orl_shade_control *control = &s->request->groups[g].control;
    const struct orl_annual_result *r = s->result;
    const bool by_sun = control->kind == ORL_SHADES_BY_SUN;
    float *own = NULL;
    const int code = by_sun ? find_direct(s, g, &own) : 0;
    if (code < 0)
        return code;
    orl_shades_control(s->request, control,
                       own      ? own
                       : by_sun ? r->direct
                                : r->total,
                       r->n_columns, closed);
    free(own);
    return 0;
}

static int control_group(struct orl_shading *s, size_t g, bool *closed)
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

static int control(struct orl_shading *s)
{
    bool *closed = malloc(s->result->n_columns + 1);
    int code = closed ? 0 : orl_year_no_memory(s->err);
    for (size_t g = 0; g < s->request->n_groups && code == 0; g++)
        if (s->request->groups[g].control.kind != ORL_SHADES_NO_CONTROL)
            code = control_group(s, g, closed);
    free(closed);
    return code;
}

/* ---- By combinations ------------------------------------------------------------------------- */

static void find_combinations(struct orl_shading *s)
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
        s->which[c] = (unsigned char)k;
    }
}

static bool has_more_than_room(const struct orl_shading *s)
{
    for (size_t c = 0; c < s->result->n_columns; c++)
        if (s->which[c] == MOST)
            return true;
    return false;
}

static int run_combinations(struct orl_shading *s, double share)
{
    int code = 0;
    for (size_t i = 1; i < s->n_combinations && code == 0; i++)
        code = run_combination(s, i, share / (double)(s->n_combinations - 1));
    return code;
}

/* ---- By parts -------------------------------------------------------------------------------- */

/* Whether the group is in that state in an hour that is to be added up. */
static bool is_used(const struct orl_shading *s, size_t g, size_t state)
{
    const struct orl_annual_result *r = s->result;
    for (size_t c = 0; c < r->n_columns; c++)
        if (s->which[c] != 0 && s->states[g * r->n_steps + r->step_of_column[c]] == state)
            return true;
    return false;
}

static size_t count_parts(const struct orl_shading *s)
{
    size_t n = 1; /* windows in no group */
    for (size_t g = 0; g < s->request->n_groups; g++)
        for (size_t k = 0; k < s->request->groups[g].n_states; k++)
            n += is_used(s, g, k);
    return n;
}

/* To all hours that are not all open; of a group, to those that have the state. */
static void add_part(struct orl_shading *s, const struct orl_annual_result *run, size_t g,
                     size_t state)
{
    struct orl_annual_result *all = s->result;
    const size_t columns = all->n_columns;
    for (size_t c = 0; c < columns; c++) {
        if (s->which[c] == 0 || (g < s->request->n_groups &&
                                 s->states[g * all->n_steps + all->step_of_column[c]] != state))
            continue;
        for (size_t at = c; at < all->n_sensors * columns; at += columns) {
            all->total[at] += run->total[at];
            all->se[at] = hypotf(all->se[at], run->se[at]);
        }
    }
}

/* A dark group in its state lets nothing in. */
static int run_part(struct orl_shading *s, size_t g, size_t state, double share)
{
    unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    const bool none = g == s->request->n_groups;
    struct orl_annual_result run = {.n_sensors = 0};
    struct orl_sub_run sub = {.states = states,
                              .index = 2 * MOST + (uint32_t)(g * ORL_SHADES_MOST_STATES + state),
                              .part = none ? ORL_PART_OF_NONE : (uint32_t)g + 1,
                              .share = share};
    if (!none && s->request->groups[g].states[state].dark)
        return 0;
    if (!none)
        states[g] = (unsigned char)state;
    int code = orl_shading_run(s, &sub, &run);
    if (code == 0)
        add_part(s, &run, g, state);
    else if (code == ORL_ERR_UNSUPPORTED && none && s->ports.of_none == 0 && !s->ports.open)
        code = 0; /* all windows are in groups */
    orl_annual_done(&run);
    return code;
}

static void begin_sums(struct orl_shading *s)
{
    const size_t columns = s->result->n_columns;
    for (size_t c = 0; c < columns; c++)
        for (size_t i = 0; s->which[c] != 0 && i < s->result->n_sensors; i++)
            s->result->total[i * columns + c] = s->result->se[i * columns + c] = 0;
}

static int run_parts(struct orl_shading *s, double share)
{
    const double each = share / (double)count_parts(s);
    orl_year_warn(
        s->reader,
        "window groups are in many combinations of states: light was computed by group and "
        "added up, the panes of other groups reflecting as in their first state");
    begin_sums(s);
    int code = 0;
    for (size_t g = 0; g < s->request->n_groups; g++)
        for (size_t k = 0; k < s->request->groups[g].n_states && code == 0; k++)
            if (is_used(s, g, k))
                code = run_part(s, g, k, each);
    return code == 0 ? run_part(s, s->request->n_groups, 0, each) : code;
}

/* ---- Which runs ------------------------------------------------------------------------------ */

/* The cost of the runs of direct sun, one for each group, relative to one run of all light. */
static const double cost_of_direct = 0.1;

/* Returns the number of combinations that there may be, by the clock and by controls. */
static double most_combinations(struct orl_shading *s)
{
    find_combinations(s);
    double most = (double)s->n_combinations;
    for (size_t g = 0; g < s->request->n_groups; g++)
        if (s->request->groups[g].control.kind != ORL_SHADES_NO_CONTROL)
            most *= 2;
    return has_more_than_room(s) ? INFINITY : most;
}

/* A run of a part costs its sensors' share, as light of a group reaches some rooms only: one state
 * of every group costs about a run of all light, and so do windows of no group. */
static double cost_of_parts(const struct orl_shading *s)
{
    double states = 0;
    for (size_t g = 0; g < s->request->n_groups; g++)
        states += (double)s->request->groups[g].n_states;
    return 1 + states / (double)s->request->n_groups;
}

/* Predicts the open run's share of the cost of all runs, and that of each run of direct sun. */
static double predict_shares(struct orl_shading *s)
{
    const double others = fmin(most_combinations(s) - 1, cost_of_parts(s));
    const double each = cost_of_direct / (double)s->request->n_groups;
    double all = 1 + others;
    s->n_combinations = 1;
    for (size_t g = 0; g < s->request->n_groups; g++)
        if (s->request->groups[g].control.kind == ORL_SHADES_BY_SUN)
            all += each;
    s->share_of_direct = each / all;
    return 1 / all;
}

static int run_all(struct orl_shading *s)
{
    int code = run_open(s, predict_shares(s));
    if (code == 0)
        code = control(s);
    if (code < 0)
        return code;
    find_combinations(s);
    s->summed = has_more_than_room(s) || s->n_combinations - 1 > count_parts(s);
    const double left = fmax(1 - s->told, 0);
    return s->summed ? run_parts(s, left) : run_combinations(s, left);
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int hand_over(struct orl_shading *s)
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

static int shade(struct orl_shading *s)
{
    int code = orl_shading_begin(s);
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
    return hand_over(s);
}

static int run_shaded(const struct orl_annual_request *request, const struct orl_annual_env *env,
                      struct orl_annual_result *ret_result, struct orl_error *err)
{
    struct orl_annual_result result = {.seed = request->seed, .n_sensors = request->n_sensors};
    struct orl_shading s = {.request = request, .env = env, .result = &result, .err = err};
    s.reader = calloc(1, sizeof *s.reader);
    const int code = s.reader ? shade(&s) : orl_year_no_memory(s.err);
    orl_shading_done(&s);
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

/* A year with shades: the schedules of its window groups, by clock or by light, and single runs. */
#include "annual/shades/shaded_year.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- By the clock ---------------------------------------------------------------------------- */

static bool is_within(double x, double from, double to, bool to_counts)
{
    const bool before = to_counts ? x <= to : x < to;
    return from <= to ? x >= from && before : x >= from || before;
}

static unsigned char state_by_spans(const struct orl_window_group *group,
                                    const struct orl_annual_step *step)
{
    for (size_t i = 0; i < group->n_spans; i++) {
        const struct orl_shade_span *s = &group->spans[i];
        if (is_within(step->month, s->from_month, s->to_month, true) &&
            is_within(step->hour, s->from_h, s->to_h, false))
            return (unsigned char)s->state;
    }
    return 0;
}

int orl_shades_schedule(const struct orl_annual_request *request,
                        const struct orl_annual_result *result, unsigned char *ret_states,
                        struct orl_error *err)
{
    const size_t n = result->n_steps;
    for (size_t g = 0; g < request->n_groups; g++) {
        const struct orl_window_group *group = &request->groups[g];
        unsigned char *states = ret_states + g * n;
        if (group->series && group->n_series != n)
            return orl_error_set(
                err, ORL_ERR_RANGE,
                "the schedule of '%.100s' has %zu states, but the weather file has %zu rows",
                group->name, group->n_series, n);
        for (size_t i = 0; i < n; i++)
            states[i] = group->series ? group->series[orl_annual_row_of_step(result, i)]
                                      : state_by_spans(group, &result->steps[i]);
    }
    return 0;
}

/* ---- By light -------------------------------------------------------------------------------- */

static size_t count_grids(const struct orl_annual_request *request)
{
    return request->n_grids > 0 ? request->n_grids : 1;
}

static struct orl_annual_grid grid_of(const struct orl_annual_request *request, size_t g)
{
    const struct orl_annual_grid all = {.first = 0, .count = request->n_sensors};
    return request->n_grids > 0 ? request->grids[g] : all;
}

static bool uses_grid(const struct orl_shade_control *control, const struct orl_annual_grid *grid)
{
    return !control->grid || (grid->name && strcasecmp(grid->name, control->grid) == 0);
}

static bool grid_closes(const struct orl_shade_control *control, uint32_t lit, size_t sensors)
{
    return control->kind == ORL_SHADES_BY_LIGHT
               ? lit > 0
               : 100.0 * lit > control->share_percent * (double)sensors;
}

int orl_shade_count_init(struct orl_shade_count *count, struct orl_arrays *arrays, size_t columns)
{
    *count =
        (struct orl_shade_count){.lit = orl_arrays_new(arrays, columns, sizeof *count->lit),
                                 .closed = orl_arrays_new(arrays, columns, sizeof *count->closed),
                                 .columns = columns};
    return arrays->failed ? ORL_ERR_NOMEM : 0;
}

/* Records the decision of the current grid, and advances to the next one. */
static void end_grid(struct orl_shade_count *count, const struct orl_annual_request *request,
                     const struct orl_shade_control *control)
{
    const struct orl_annual_grid grid = grid_of(request, count->grid++);
    if (!uses_grid(control, &grid))
        return;
    for (size_t c = 0; c < count->columns; c++) {
        count->closed[c] = count->closed[c] || grid_closes(control, count->lit[c], grid.count);
        count->lit[c] = 0;
    }
}

void orl_shade_count_add(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control, size_t sensor, const float *lx)
{
    struct orl_annual_grid grid;
    for (;;) {
        if (count->grid >= count_grids(request))
            return;
        grid = grid_of(request, count->grid);
        if (sensor < grid.first + grid.count)
            break;
        end_grid(count, request, control);
    }
    if (sensor < grid.first || !uses_grid(control, &grid))
        return;
    for (size_t c = 0; c < count->columns; c++)
        count->lit[c] += (double)lx[c] >= control->above_lx;
}

void orl_shade_count_end(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control)
{
    while (count->grid < count_grids(request))
        end_grid(count, request, control);
}

enum { ROUNDS = 4096 }; /* most runs per round of refinement */

/* ---- Hours ----------------------------------------------------------------------------------- */

int orl_shaded_year_begin(struct orl_shaded_year *s)
{
    struct orl_thread_pool *pool = s->env->run->pool;
    s->reader->request = s->request;
    s->reader->env = s->env;
    s->reader->result = s->result;
    s->reader->started_s = orl_year_now(s->reader);
    double since = s->reader->started_s;
    orl_year_report_progress(s->reader, ORL_STAGE_LOAD, 0);
    orl_bins_init(&s->reader->bins);
    orl_thread_pool_set_cancel(pool, s->env->run->cancel);
    const int code = orl_year_read_hours(s->reader, s->err);
    orl_thread_pool_set_cancel(pool, NULL);
    if (code < 0)
        return code;
    orl_year_move_hours(s->reader);
    orl_year_add_timing(s->reader, ORL_ANNUAL_SKIES, &since);
    s->states = calloc(s->request->n_groups * s->result->n_steps + 1, 1);
    s->combination_of = orl_arrays_new(&s->arrays, s->result->n_columns, 1);
    s->combinations =
        orl_arrays_new(&s->arrays, ORL_SHADES_MOST_COMBINATIONS, sizeof *s->combinations);
    s->n_combinations = 1;
    s->counts = orl_arrays_new(&s->arrays, s->request->n_groups, sizeof *s->counts);
    if (!s->states || s->arrays.failed)
        return orl_year_no_memory(s->err);
    return orl_shades_schedule(s->request, s->result, s->states, s->err);
}

/* ---- A run ----------------------------------------------------------------------------------- */

/* Copies texts that are new into a list of the result. */
static int add_texts(struct orl_shaded_year *s, char ***list, size_t *count, char *const *texts,
                     size_t n_texts)
{
    for (size_t i = 0; i < n_texts; i++) {
        if (orl_year_has_text(*list, *count, texts[i]))
            continue;
        if (orl_year_add_text(list, count, texts[i]) < 0)
            return orl_year_no_memory(s->err);
        if (list == &s->result->warnings && s->env->run->warned)
            s->env->run->warned(s->env->run->ctx, texts[i]);
    }
    return 0;
}

static int add_statistics(struct orl_shaded_year *s, const struct orl_annual_result *run)
{
    struct orl_annual_result *all = s->result;
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        all->timings_s[i] += run->timings_s[i];
    orl_health_add(&all->health, &run->health);
    all->reuse.asked = run->reuse.asked;
    for (int i = 0; i < ORL_ANNUAL_CACHE_KINDS; i++)
        orl_annual_cache_stats_add(&all->reuse.of[i], &run->reuse.of[i]);
    all->threads = run->threads;
    all->samples = run->samples;
    all->n_nodes = run->n_nodes;
    all->n_runs++;
    const int code =
        add_texts(s, &all->scene_read, &all->n_scene_read, run->scene_read, run->n_scene_read);
    return code < 0
               ? code
               : add_texts(s, &all->warnings, &all->n_warnings, run->warnings, run->n_warnings);
}

int orl_shaded_year_run(struct orl_shaded_year *s, const struct orl_sub_run *sub,
                        struct orl_annual_result *ret_run)
{
    struct orl_shaded_scene shaded_scene;
    struct orl_run_env run = *s->env->run;
    struct orl_annual_env env = *s->env;
    const double whole = run.part > 0 ? run.part : 1;
    const bool by_window_group = sub->window_groups != NULL;
    run.part_from += whole * s->reported_progress;
    run.part = whole * sub->share;
    run.warned = NULL;
    env.run = &run;
    env.begins = NULL;
    env.row = NULL;
    env.restored = sub->sun_only ? NULL : s->env->restored;
    env.done = sub->sun_only ? NULL : s->env->done;
    env.round = s->env->round * ROUNDS + sub->index;
    int code =
        orl_shaded_scene_init(&shaded_scene, s->request, sub->states, by_window_group, s->err);
    const struct orl_year_overrides overrides = {.hours_of = s->reader,
                                                 .material_overrides =
                                                     &shaded_scene.material_overrides,
                                                 .window_groups = sub->window_groups,
                                                 .sun_only = sub->sun_only,
                                                 .sensors_checked = s->sensors_checked};
    /* Runs whose light is added up use different seeds, so that their errors are independent. */
    if (by_window_group)
        shaded_scene.request.seed += (uint64_t)sub->index << 32;
    if (code == 0)
        code = orl_year_run(&shaded_scene.request, &env, &overrides, ret_run, s->err);
    orl_shaded_scene_done(&shaded_scene);
    s->sensors_checked = s->sensors_checked || code == 0;
    s->reported_progress += sub->share;
    return code == 0 ? add_statistics(s, ret_run) : code;
}

void orl_shaded_year_done(struct orl_shaded_year *s)
{
    if (s->reader)
        orl_hours_done(&s->reader->hours);
    free(s->reader);
    free(s->states);
    orl_arrays_free(&s->arrays);
}

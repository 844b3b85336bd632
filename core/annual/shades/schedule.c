#include "annual/shades/schedule.h"

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
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "the schedule of '%.100s' has %zu states, and the weather file "
                                 "%zu rows",
                                 group->name, group->n_series, n);
        for (size_t i = 0; i < n; i++)
            states[i] = group->series ? group->series[orl_annual_row_of_step(result, i)]
                                      : state_by_spans(group, &result->steps[i]);
    }
    return 0;
}

/* ---- By light -------------------------------------------------------------------------------- */

bool orl_shades_controlled(const struct orl_annual_request *request)
{
    for (size_t g = 0; g < request->n_groups; g++)
        if (request->groups[g].control.kind != ORL_SHADES_NO_CONTROL)
            return true;
    return false;
}

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

int orl_shade_count_init(struct orl_shade_count *count, size_t columns)
{
    *count = (struct orl_shade_count){.lit = calloc(columns + 1, sizeof *count->lit),
                                      .closed = calloc(columns + 1, sizeof *count->closed),
                                      .columns = columns};
    return count->lit && count->closed ? 0 : ORL_ERR_NOMEM;
}

void orl_shade_count_done(struct orl_shade_count *count)
{
    free(count->lit);
    free(count->closed);
    *count = (struct orl_shade_count){.lit = NULL};
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

#include "scene/material/function_brdf/function_brdf.h"

#include <stddef.h>

#include "scene/material/patterns/pattern.h"

enum { LANES = ORL_FUNCTION_LANES };

static struct orl_vec3 to_world(const struct orl_pattern *pattern, const double v[3])
{
    return orl_add(orl_scale(pattern->row[0], v[0]),
                   orl_add(orl_scale(pattern->row[1], v[1]), orl_scale(pattern->row[2], v[2])));
}

int orl_function_brdf_prism_rays(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                 struct orl_vec3 ray, struct orl_prism_ray ret_rays[ORL_PRISM_RAYS])
{
    double inputs[ORL_RAY_INPUTS], values[4 * ORL_PRISM_RAYS];
    int n = 0;
    orl_pattern_inputs(pattern, hit, orl_neg(ray), inputs);
    if (orl_pattern_run(pattern->program.function, inputs, values) != ORL_PATTERN_VALID)
        return 0;
    for (int i = 0; i < (int)orl_prism_functions_of(pattern)->n_rays; i++) {
        const double *const values_of_ray = values + (ptrdiff_t)4 * i;
        const struct orl_vec3 towards = to_world(pattern, values_of_ray + 1);
        const double length = orl_length(towards);
        if (isfinite(values_of_ray[0]) && isfinite(length) && length > 0)
            ret_rays[n++] =
                (struct orl_prism_ray){values_of_ray[0], orl_scale(towards, 1 / length), i};
    }
    return n;
}

/* The functions take the eye's side of the surface as the front, except those of BRTDfunc. */
static void fill_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_rgb color, const struct orl_lobe_pair *pair,
                        double inputs[ORL_RAY_INPUTS])
{
    struct orl_hit seen = *hit;
    const struct orl_vec3 side =
        orl_dot(pair->eye, hit->normal) < 0 ? orl_neg(hit->normal) : hit->normal;
    if (!orl_lobe_functions_of(pattern)->sided)
        seen.normal = side;
    orl_pattern_inputs(pattern, &seen, pair->eye, inputs);
    orl_pattern_set_direction(pattern, inputs, ORL_RAY_NXP, side);
    orl_pattern_set_direction(pattern, inputs, ORL_RAY_LIGHT_X, pair->light);
    inputs[ORL_RAY_RDOTP] = orl_dot(pair->eye, side);
    inputs[ORL_RAY_CRP] = color.r;
    inputs[ORL_RAY_CGP] = color.g;
    inputs[ORL_RAY_CBP] = color.b;
}

/* Returns the lanes in which every function has a value; values: rows of the last program. */
static unsigned evaluate(const struct orl_pattern *pattern, struct orl_function_lanes *columns,
                         unsigned lanes, struct orl_function_lanes *values)
{
    struct orl_function_scratch *const scratch = orl_function_scratch_of_thread();
    struct orl_function_outcome outcome =
        orl_function_evaluate(pattern->program.function, scratch, columns, lanes, values);
    if (outcome.exceeded)
        return 0;
    lanes &= ~outcome.undefined;
    if (!pattern->program.values)
        return lanes;
    for (unsigned l = 0; l < LANES; l++) {
        double place[ORL_GRID_AXES], held[ORL_GRID_CHANNELS];
        if (!(lanes >> l & 1))
            continue;
        for (uint32_t i = 0; i < pattern->program.grids[0]->n_axes; i++)
            place[i] = values[i].at[l];
        orl_grid_at(pattern->program.grids[0], place, held);
        columns[ORL_RAY_DATA].at[l] = held[0];
    }
    outcome = orl_function_evaluate(pattern->program.values, scratch, columns, lanes, values);
    return outcome.exceeded ? 0 : lanes & ~outcome.undefined;
}

void orl_function_brdf_eval(const struct orl_pattern *pattern, const struct orl_hit *hit,
                            struct orl_rgb color, const struct orl_lobe_pair *pairs, size_t n,
                            struct orl_rgb *ret_values)
{
    struct orl_function_lanes columns[ORL_RAY_INPUTS], values[ORL_GRID_AXES];
    const unsigned all = (1U << n) - 1;
    for (size_t l = 0; l < n; l++) {
        double inputs[ORL_RAY_INPUTS] = {0};
        fill_inputs(pattern, hit, color, &pairs[l], inputs);
        for (int i = 0; i < ORL_RAY_INPUTS; i++)
            columns[i].at[l] = inputs[i];
    }
    const unsigned valued = evaluate(pattern, columns, all, values);
    for (size_t l = 0; l < n; l++) {
        double v[3] = {0, 0, 0};
        for (int c = 0; c < 3 && valued >> l & 1; c++) {
            const double value = values[pattern->is_rgb ? c : 0].at[l];
            v[c] = isfinite(value) ? orl_larger(value, 0) : 0;
        }
        ret_values[l] = (struct orl_rgb){v[0], v[1], v[2]};
    }
}

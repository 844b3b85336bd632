#include "run/goals/findings.h"

#include <stdlib.h>
#include <string.h>

static int part_init(struct orl_finding_part *part, size_t count, uint32_t groups, double floor,
                     struct orl_error *err)
{
    part->floor = floor;
    part->errors = malloc((count + 1) * sizeof(double));
    if (!part->errors)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return orl_pooled_init(&part->pool, count, groups, err);
}

int orl_findings_init(struct orl_findings *findings, struct orl_run_state *state, bool shared,
                      struct orl_error *err)
{
    const size_t sensors = state->n_sensors > 0, views = state->job->n_views;
    int code = 0;
    *findings = (struct orl_findings){.n_parts = sensors + views, .first_view = sensors};
    findings->parts = calloc(sensors + views + 1, sizeof *findings->parts);
    findings->estimates = calloc(sensors + views + 1, sizeof *findings->estimates);
    state->result->views = calloc(views + 1, sizeof *state->result->views);
    if (!findings->parts || !findings->estimates || !state->result->views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    state->result->n_views = views;
    if (sensors)
        code = part_init(&findings->parts[0], state->n_sensors, shared ? ORL_MAP_BATCHES : 0,
                         orl_floor_of_sensors, err);
    if (sensors && code == 0 && shared) {
        findings->parts[0].noise = calloc(state->n_sensors, sizeof(double));
        if (!findings->parts[0].noise)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (sensors && code == 0) {
        findings->parts[0].rays = calloc(state->n_sensors, sizeof *findings->parts[0].rays);
        if (!findings->parts[0].rays)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    for (size_t i = 0; i < views && code == 0; i++) {
        const struct orl_view_request *v = &state->job->views[i];
        struct orl_finding_part *part = &findings->parts[sensors + i];
        part->rated = v->metrics != 0;
        code = part_init(part, (size_t)v->width * v->height, 0, orl_floor_of_pixels, err);
        if (code == 0)
            code = orl_film_init(&part->film, v->width, v->height, err);
    }
    return code;
}

void orl_findings_done(struct orl_findings *findings)
{
    for (size_t i = 0; findings->parts && i < findings->n_parts; i++) {
        orl_pooled_done(&findings->parts[i].pool);
        orl_film_done(&findings->parts[i].film);
        orl_view_batches_done(&findings->parts[i].batches);
        free(findings->parts[i].errors);
        free(findings->parts[i].noise);
        free(findings->parts[i].rays);
    }
    free(findings->parts);
    free(findings->estimates);
    *findings = (struct orl_findings){0};
}

/* Adds a round's picture: the luma of every pixel, its error if known, and the colours. */
int orl_findings_add_film(struct orl_findings *findings, size_t view, const struct orl_film *film,
                          double effort, struct orl_error *err)
{
    struct orl_finding_part *part = &findings->parts[findings->first_view + view];
    const size_t count = part->pool.count;
    const double share = effort / (part->pool.effort + effort);
    const bool knows = orl_film_knows_errors(film);
    double *value = malloc((2 * count + 1) * sizeof(double)), *error = value + count;
    if (!value)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a round's pixels");
    for (size_t i = 0; i < count; i++) {
        const float *p = film->pixels[i];
        value[i] = orl_luma((struct orl_rgb){p[0], p[1], p[2]});
        error[i] = knows ? film->errors[i] : 0;
        for (int c = 0; c < 3; c++)
            part->film.pixels[i][c] =
                (float)(part->film.pixels[i][c] + share * (p[c] - part->film.pixels[i][c]));
    }
    const struct orl_round_findings found = {.value = value,
                                             .error = knows ? error : NULL,
                                             .degrees = ORL_MAP_BATCHES - 1,
                                             .effort = effort};
    orl_pooled_add(&part->pool, &found);
    free(value);
    return part->rated ? orl_view_batches_add(&part->batches, film, effort, err) : 0;
}

void orl_findings_add_sensors(struct orl_findings *findings, const struct orl_run_state *round,
                              double effort, const double *samples, const double *groups)
{
    struct orl_finding_part *part = &findings->parts[0];
    const struct orl_result *result = round->result;
    const struct orl_round_findings found = {.value = result->illuminance_lx,
                                             .error = result->standard_error_lx,
                                             .bias = result->bias_estimate_lx,
                                             .groups = groups,
                                             .degrees = ORL_MAP_BATCHES - 1,
                                             .effort = effort};
    if (result->n_sensors == 0)
        return;
    orl_pooled_add(&part->pool, &found);
    const double share = effort / part->pool.effort;
    for (size_t i = 0; i < part->pool.count; i++)
        part->rays[i] = orl_rays_mix(part->rays[i], 1 - share, round->rays[i], share);
    for (size_t i = 0; samples && i < part->pool.count; i++) {
        const double error = found.error[i], noise = samples[i] * error * error;
        part->noise[i] += share * (noise - part->noise[i]);
    }
}

void orl_findings_judge(struct orl_findings *findings)
{
    for (size_t i = 0; i < findings->n_parts; i++) {
        struct orl_finding_part *part = &findings->parts[i];
        orl_pooled_errors(&part->pool, part->floor, part->errors);
        findings->estimates[i] = (struct orl_estimates){
            .value = part->pool.mean,
            .error = part->errors,
            .bias = part->pool.knows_bias && !part->film.pixels ? part->pool.bias : NULL,
            .noise = part->noise,
            .samples = part->pool.effort,
            .count = part->pool.count,
            .floor = part->floor,
            .degrees = orl_pooled_degrees(&part->pool)};
    }
}

static double *copy_values(double **array, const double *values, size_t count)
{
    if (!*array)
        *array = malloc((count + 1) * sizeof(double));
    if (*array)
        memcpy(*array, values, count * sizeof(double));
    return *array;
}

static void book_interval(const struct orl_finding_part *part, size_t i, double ret_interval[2])
{
    const struct orl_estimate pooled = {.standard_error = part->errors[i],
                                        .degrees = orl_pooled_degrees(&part->pool),
                                        .bias = part->pool.knows_bias ? part->pool.bias[i] : 0,
                                        .third = orl_pooled_third(&part->pool, i)};
    const struct orl_margins margins = orl_estimate_margins(&pooled);
    ret_interval[0] = fmax(part->pool.mean[i] - margins.below, 0);
    ret_interval[1] = part->pool.mean[i] + margins.above;
}

static int show_sensors(const struct orl_finding_part *part, const struct orl_sensor *sensors,
                        struct orl_result *result, struct orl_error *err)
{
    const size_t n = part->pool.count;
    bool held = copy_values(&result->illuminance_lx, part->pool.mean, n);
    held = held && copy_values(&result->standard_error_lx, part->errors, n);
    if (part->pool.knows_bias)
        held = held && copy_values(&result->bias_estimate_lx, part->pool.bias, n);
    if (!result->interval_95_lx)
        result->interval_95_lx = calloc(n, sizeof *result->interval_95_lx);
    held = held && result->interval_95_lx;
    for (size_t i = 0; held && i < n; i++)
        book_interval(part, i, result->interval_95_lx[i]);
    result->n_sensors = held ? n : 0;
    orl_run_mind_rare_light(result, sensors, part->rays);
    return held ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
}

int orl_findings_show(struct orl_findings *findings, struct orl_run_state *state,
                      struct orl_error *err)
{
    int code = findings->first_view > 0
                   ? show_sensors(&findings->parts[0], state->sensors, state->result, err)
                   : 0;
    for (size_t i = 0; i < state->job->n_views && code == 0; i++) {
        struct orl_finding_part *part = &findings->parts[findings->first_view + i];
        for (size_t k = 0; k < part->pool.count; k++)
            part->film.errors[k] = (float)part->errors[k];
        code = orl_run_write_view(state, i, &part->film, err);
        if (code == 0 && part->rated)
            code = orl_run_rate_errors(state, i, &part->film, &part->batches, err);
    }
    return code;
}

/*
 * Glare over a year: builds the images of viewpoints, runs their sensors as a year, and rates each
 * viewpoint.
 *
 * Images are large, and there may be many viewpoints: at most ORL_GLARE_VIEWPOINTS_AT_ONCE images
 * are in memory. If there are more viewpoints, each image is built twice, for the sensors and for
 * the rating. Both are equal, because random numbers are keyed by viewpoint.
 */
#include <oriel/annual/annual_glare.h>

#include <stdlib.h>
#include <string.h>

#include "annual/shades/shaded_year.h"
#include "annual/viewpoints/viewpoints.h"
#include "annual/year/annual_year.h"

/* ---- Viewpoints as a year's sensors
 * --------------------------------------------------------------- */

/* State of all viewpoints while a year of their sensors runs. */
struct viewpoint_run {
    const struct orl_viewpoint_request *viewpoint_request;
    const struct orl_annual_result *result; /* result of the year to which the viewpoints belong */
    struct orl_arrays arrays;               /* all arrays below but the sensors and `hours` */
    unsigned char *wanted; /* by column: columns still to be rated, and columns of this run */
    unsigned char *current;
    struct orl_annual_request request; /* with the viewpoints' sensors, which are owned */
    struct orl_viewpoint_image *views; /* by viewpoint of the chunk */
    struct orl_error *errors;          /* by viewpoint of the chunk */
    size_t chunk, n_chunk;             /* first viewpoint of the chunk, and number of viewpoints */
    size_t *n_visible_points;          /* by viewpoint */
    struct orl_viewpoint_hours *hours; /* by viewpoint */
    struct orl_year *year;
    /* Indices of the next row; visible point 0 is the viewpoint's eye, then follow its visible
     * points. */
    size_t viewpoint, visible_point;
    float *eye, *eye_direct, *eye_error, *visible_points; /* rows of one viewpoint */
};

static void build_view(void *arg, size_t index, uint32_t member)
{
    struct viewpoint_run *s = arg;
    const size_t viewpoint = s->chunk + index;
    (void)member;
    orl_viewpoint_image_init(
        &s->views[index], &s->year->scene, &s->viewpoint_request->viewpoints[viewpoint],
        s->request.seed + viewpoint, s->year->env->run->pool, &s->errors[index]);
}

static void free_chunk(struct viewpoint_run *s)
{
    for (size_t i = 0; i < s->n_chunk; i++) {
        orl_viewpoint_image_done(&s->views[i]);
        s->views[i] = (struct orl_viewpoint_image){.n_spots = 0};
    }
    s->n_chunk = 0;
}

/* Builds the images of a chunk that starts at the given viewpoint. */
static int build_views(struct viewpoint_run *s, size_t first, struct orl_error *err)
{
    const size_t left = s->viewpoint_request->n_viewpoints - first;
    struct orl_thread_pool *pool = s->year->env->run->pool;
    free_chunk(s);
    memset(s->errors, 0, ORL_GLARE_VIEWPOINTS_AT_ONCE * sizeof *s->errors);
    s->chunk = first;
    s->n_chunk = left < ORL_GLARE_VIEWPOINTS_AT_ONCE ? left : ORL_GLARE_VIEWPOINTS_AT_ONCE;
    const int code = orl_parallel_try(pool, s->n_chunk, build_view, s);
    if (code < 0)
        return orl_year_failed(s->year, code, err);
    for (size_t i = 0; i < s->n_chunk; i++)
        if (s->errors[i].code < 0) {
            *err = s->errors[i];
            return err->code;
        }
    return 0;
}

/* Appends the sensors of the chunk: the eye and the visible points of each viewpoint. */
static int add_sensors(struct viewpoint_run *s)
{
    const struct orl_vec3 center = s->year->lit_scene->geometry->center;
    size_t n = s->request.n_sensors;
    for (size_t i = 0; i < s->n_chunk; i++)
        n += 1 + s->views[i].visible_points.n_selected;
    struct orl_sensor *sensors = realloc(s->request.sensors, n * sizeof *sensors);
    if (!sensors)
        return ORL_ERR_NOMEM;
    s->request.sensors = sensors;
    sensors += s->request.n_sensors;
    s->request.n_sensors = n;
    for (size_t i = 0; i < s->n_chunk; i++) {
        const struct orl_visible_points *p = &s->views[i].visible_points;
        const struct orl_viewpoint *viewpoint = &s->viewpoint_request->viewpoints[s->chunk + i];
        s->n_visible_points[s->chunk + i] = p->n_selected;
        *sensors++ = (struct orl_sensor){viewpoint->at, viewpoint->towards};
        for (size_t k = 0; k < p->n_selected; k++)
            *sensors++ =
                (struct orl_sensor){orl_add(p->sensors[k].point, center), p->sensors[k].facing};
    }
    return 0;
}

static int allocate_rows(struct viewpoint_run *s)
{
    const size_t n = s->result->n_columns + 1, n_viewpoints = s->viewpoint_request->n_viewpoints;
    struct orl_arrays *a = &s->arrays;
    s->eye = orl_arrays_new(a, n, sizeof *s->eye);
    s->eye_direct = orl_arrays_new(a, n, sizeof *s->eye_direct);
    s->eye_error = orl_arrays_new(a, n, sizeof *s->eye_error);
    s->visible_points =
        orl_arrays_new(a, n * ORL_VISIBLE_POINTS_MOST * 2, sizeof *s->visible_points);
    s->wanted = orl_arrays_new(a, n, 1);
    s->current = orl_arrays_new(a, n, 1);
    s->views = orl_arrays_new(a, ORL_GLARE_VIEWPOINTS_AT_ONCE, sizeof *s->views);
    s->errors = orl_arrays_new(a, ORL_GLARE_VIEWPOINTS_AT_ONCE, sizeof *s->errors);
    s->n_visible_points = orl_arrays_new(a, n_viewpoints, sizeof *s->n_visible_points);
    s->hours = calloc(n_viewpoints + 1, sizeof *s->hours);
    for (size_t i = 0; s->hours && i < n_viewpoints; i++) {
        struct orl_viewpoint_hours *h = &s->hours[i];
        h->dgp = malloc(n * sizeof *h->dgp);
        h->low = malloc(n * sizeof *h->low);
        h->high = malloc(n * sizeof *h->high);
        h->eye_lx = malloc(n * sizeof *h->eye_lx);
        if (!h->dgp || !h->low || !h->high || !h->eye_lx)
            return ORL_ERR_NOMEM;
        for (size_t c = 0; c < n; c++)
            h->dgp[c] = h->low[c] = h->high[c] = h->eye_lx[c] = NAN;
    }
    return s->hours && !a->failed ? 0 : ORL_ERR_NOMEM;
}

/* Sets the sensors of a prepared year: those of all viewpoints. */
static int place_viewpoints(void *ctx, struct orl_year *y, struct orl_error *err)
{
    struct viewpoint_run *s = ctx;
    s->year = y;
    int code = orl_year_ensure_scene(y, err);
    if (code < 0)
        return code;
    if (y->hours.n_columns != s->result->n_columns)
        return orl_error_set(err, ORL_ERR_INVALID, "the weather file changed during the job");
    for (size_t i = 0; i < s->viewpoint_request->n_viewpoints && code == 0;
         i += ORL_GLARE_VIEWPOINTS_AT_ONCE) {
        code = build_views(s, i, err);
        if (code == 0 && add_sensors(s) < 0)
            code = orl_year_no_memory(err);
    }
    y->request = &s->request;
    y->result->n_sensors = s->request.n_sensors;
    return code;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static int rate_viewpoint(struct viewpoint_run *s, struct orl_error *err)
{
    const size_t in_chunk = s->viewpoint % ORL_GLARE_VIEWPOINTS_AT_ONCE;
    int code = s->chunk + in_chunk == s->viewpoint ? 0 : build_views(s, s->viewpoint, err);
    if (code < 0)
        return code;
    const struct orl_viewpoint_light light = {.year = s->year,
                                              .wanted = s->current,
                                              .eye = s->eye,
                                              .eye_direct = s->eye_direct,
                                              .eye_error = s->eye_error,
                                              .visible_points = s->visible_points};
    code = orl_viewpoint_glare_compute(&s->views[in_chunk], &light, &s->hours[s->viewpoint]);
    s->viewpoint++;
    s->visible_point = 0;
    return code < 0 ? orl_year_failed(s->year, code, err) : 0;
}

/* Stores the row of an eye or a visible point. After the last visible point of a viewpoint, rates
 * the viewpoint. */
static int store_row(void *ctx, size_t sensor, const float *total, const float *direct,
                     const float *se, struct orl_error *err)
{
    struct viewpoint_run *s = ctx;
    const size_t n = s->result->n_columns;
    (void)sensor;
    if (s->visible_point == 0) {
        memcpy(s->eye, total, n * sizeof *total);
        memcpy(s->eye_direct, direct, n * sizeof *direct);
        memcpy(s->eye_error, se, n * sizeof *se);
    } else {
        float *without = s->visible_points + (s->visible_point - 1) * 2 * n, *all = without + n;
        for (size_t c = 0; c < n; c++) {
            without[c] = total[c] - direct[c];
            all[c] = total[c];
        }
    }
    return s->visible_point++ == s->n_visible_points[s->viewpoint] ? rate_viewpoint(s, err) : 0;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

/* Returns the states of the groups at a column; all are 0 in years without shades. */
static void states_at(const struct viewpoint_run *s, size_t column,
                      unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
{
    const struct orl_annual_result *r = s->result;
    memset(ret_states, 0, ORL_SHADES_MOST_GROUPS);
    for (size_t g = 0; r->states && g < r->n_groups; g++)
        ret_states[g] = r->states[g * r->n_steps + r->step_of_column[column]];
}

/* Moves the first wanted column, and all with the same states, from wanted to now; returns their
 * number. */
static size_t select_alike(struct viewpoint_run *s,
                           unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
{
    unsigned char states[ORL_SHADES_MOST_GROUPS];
    size_t n = 0;
    for (size_t c = 0; c < s->result->n_columns; c++) {
        s->current[c] = 0;
        if (!s->wanted[c])
            continue;
        states_at(s, c, n == 0 ? ret_states : states);
        s->current[c] = n == 0 || memcmp(states, ret_states, sizeof states) == 0;
        s->wanted[c] = !s->current[c];
        n += s->current[c];
    }
    return n;
}

/* Runs a year of the viewpoints in these states, and rates the hours that have them. */
static int run_states(struct viewpoint_run *s, const struct orl_annual_request *request,
                      const struct orl_run_env *run, const unsigned char *states,
                      struct orl_error *err)
{
    struct orl_shaded_scene shaded_scene;
    const struct orl_annual_env env = {.run = run, .row = store_row, .ctx = s};
    struct orl_annual_result result = {.n_steps = 0};
    int code = orl_shaded_scene_init(&shaded_scene, request, states, false, err);
    const struct orl_year_overrides overrides = {
        .material_overrides = request->n_groups > 0 ? &shaded_scene.material_overrides : NULL,
        .prepared = place_viewpoints,
        .ctx = s};
    s->request = shaded_scene.request;
    s->request.sensors = NULL;
    s->request.n_sensors = 0;
    s->request.grids = NULL;
    s->request.n_grids = 0;
    s->request.coefficients = false;
    s->viewpoint = 0;
    if (code == 0)
        code = orl_year_run(&s->request, &env, &overrides, &result, err);
    free_chunk(s);
    free(s->request.sensors);
    orl_annual_done(&result);
    orl_shaded_scene_done(&shaded_scene);
    return code;
}

/* Runs each combination of states that occurs in hours of use. */
static int run_all(struct viewpoint_run *s, const struct orl_annual_request *request,
                   const struct orl_run_env *given, struct orl_error *err)
{
    struct orl_run_env run = *given;
    unsigned char states[ORL_SHADES_MOST_GROUPS];
    const double whole = given->part > 0 ? given->part : 1;
    size_t all = 0, n, runs = 0;
    int code = 0;
    for (size_t c = 0; c < s->result->n_columns; c++)
        all += s->wanted[c];
    run.warned = NULL; /* the year's own runs have issued the warnings */
    while (code == 0 && (n = select_alike(s, states)) > 0) {
        if (runs++ == ORL_SHADES_MOST_COMBINATIONS)
            return orl_error_set(err, ORL_ERR_LIMIT,
                                 "the shades have more than %d combinations of states while seats "
                                 "are in use: glare needs a run for each",
                                 ORL_SHADES_MOST_COMBINATIONS);
        run.part = whole * (double)n / (double)all;
        code = run_states(s, request, &run, states, err);
        run.part_from += run.part;
    }
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

int orl_annual_glare_compute(const struct orl_viewpoint_request *viewpoint_request,
                             const struct orl_annual_request *request,
                             const struct orl_annual_result *result, const unsigned char *wanted,
                             const struct orl_run_env *run, struct orl_viewpoint_hours **ret_hours,
                             struct orl_error *err)
{
    struct viewpoint_run s = {.viewpoint_request = viewpoint_request, .result = result};
    int code = orl_viewpoints_validate(viewpoint_request, request, err);
    if (code < 0)
        return code;
    if (allocate_rows(&s) < 0) {
        code = orl_year_no_memory(err);
    } else {
        memcpy(s.wanted, wanted, result->n_columns);
        code = run_all(&s, request, run, err);
    }
    orl_arrays_free(&s.arrays);
    if (code < 0)
        orl_viewpoint_hours_free(s.hours, viewpoint_request->n_viewpoints);
    else
        *ret_hours = s.hours;
    return code;
}

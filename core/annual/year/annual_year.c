#include "annual/year/annual_year.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light/daylight/weather.h"
#include "run/estimate/progress.h"

void orl_year_warn(struct orl_year *y, const char *format, ...)
{
    struct orl_annual_result *r = y->result;
    char text[1024];
    va_list args;
    if (y->warnings_emitted)
        return;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (y->env->run->warned)
        y->env->run->warned(y->env->run->ctx, text);
    orl_year_add_text(&r->warnings, &r->n_warnings, text); /* without memory it is not listed */
}

bool orl_year_has_text(char *const *list, size_t count, const char *text)
{
    size_t i = 0;
    while (i < count && strcmp(list[i], text) != 0)
        i++;
    return i < count;
}

int orl_year_add_text(char ***list, size_t *count, const char *text)
{
    char **grown = realloc(*list, (*count + 1) * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    *list = grown;
    grown[*count] = strdup(text);
    if (!grown[*count])
        return ORL_ERR_NOMEM;
    ++*count;
    return 0;
}

struct orl_shading_point orl_year_place_of(const struct orl_year *y,
                                           const struct orl_sensor *sensor)
{
    const struct orl_geometry *geometry = y->lit_scene->geometry;
    const struct orl_vec3 normal = orl_normalize(sensor->direction);
    const struct orl_vec3 at = orl_sub(sensor->position, geometry->center);
    return (struct orl_shading_point){.point = orl_offset_from_surface(geometry, at, normal),
                                      .normal = normal};
}

double orl_year_now(const struct orl_year *y)
{
    return y->env->run->now_s(y->env->run->ctx);
}

void orl_year_add_timing(struct orl_year *y, enum orl_annual_stage stage, double *since)
{
    const double t = orl_year_now(y);
    y->result->timings_s[stage] += t - *since;
    *since = t;
}

/* Estimated seconds of the whole run. The share w of the sensors to compute took the time from
 * chunks_s to now; the rest is assumed to take as long per sensor. NaN if unknown. */
static double total_time_s(const struct orl_year *y, double sensors)
{
    const double now = orl_year_now(y), before = y->chunks_s - y->started_s;
    const double n = (double)(y->request->n_sensors - y->restored);
    const double w = n > 0 ? (sensors - (double)y->restored) / n : 1;
    return w > 0 && y->chunks_s > 0 ? before + (now - y->chunks_s) / w : (double)NAN;
}

void orl_year_report_progress(struct orl_year *y, enum orl_stage stage, double sensors)
{
    if (!y->env->run->progress)
        return; /* returns without reading the clock */
    const double elapsed = orl_year_now(y) - y->started_s;
    const double left =
        stage == ORL_STAGE_RENDER ? total_time_s(y, sensors) - elapsed : (double)NAN;
    if (elapsed + left > 0)
        y->reported_progress = fmax(y->reported_progress, fmin(elapsed / (elapsed + left), 1));
    orl_progress_report(y->env->run, stage, sensors / (double)y->request->n_sensors,
                        &(struct orl_progress_report){y->reported_progress, elapsed, left});
}

int orl_year_no_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a year");
}

int orl_year_cancelled(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
}

int orl_year_failed(const struct orl_year *y, int code, struct orl_error *err)
{
    return code == ORL_ERR_CANCELLED || orl_thread_pool_cancelled(y->env->run->pool)
               ? orl_year_cancelled(err)
               : orl_year_no_memory(err);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Warns of light measured while the sun is down, which no hour receives, and of a shift of times
 * that may explain it. */
static void warn_of_times(struct orl_year *y, const struct orl_weather *weather)
{
    const struct orl_time_shift shift = orl_time_shift_find(weather);
    struct orl_night_light night = orl_night_light_find(weather);
    char text[640];
    if (orl_time_shift_describe(&shift, text, sizeof text)) {
        orl_year_warn(y, "%s", text);
        if (shift.shift_h != 0 && !shift.doubtful)
            night.cause = ORL_NIGHT_SHIFT;
        night.shift_h = shift.shift_h;
    }
    if (orl_night_light_describe(&night, text, sizeof text))
        orl_year_warn(y, "%s", text);
}

int orl_year_read_hours(struct orl_year *y, struct orl_error *err)
{
    const struct orl_annual_request *request = y->request;
    const struct orl_files *files = y->env->run->files;
    struct orl_weather weather = {0};
    struct orl_file file;
    int code = files->open(files->ctx, request->weather_file, &file, err);
    if (code < 0)
        return code;
    code = orl_weather_parse(request->weather_file, file.data, file.size, request->weather_year,
                             &weather, err);
    files->close(files->ctx, &file);
    if (code < 0)
        return code;
    weather.sun_method = request->sun_method;
    y->result->site =
        (struct orl_annual_site){weather.latitude_deg, weather.longitude_deg, weather.time_zone_h};
    y->result->first_weekday = weather.first_weekday;
    y->result->n_moved = weather.n_moved;
    code = orl_hours_init(&y->hours, &y->bins, &weather, request->weather_file, request->north_deg,
                          request->ground_reflectance, y->env->run->pool, err);
    if (code == 0)
        warn_of_times(y, &weather);
    orl_weather_done(&weather);
    if (code < 0)
        return code;
    if (y->hours.n_missing > 0)
        orl_year_warn(y,
                      "in the weather file %zu %s not measured: the results have no values there",
                      y->hours.n_missing, y->hours.n_missing == 1 ? "row was" : "rows were");
    if (y->hours.n_warned > 0)
        orl_year_warn(y, "sky, in %zu %s with light: %s", y->hours.n_warned,
                      y->hours.n_warned == 1 ? "row" : "rows", y->hours.warning);
    return 0;
}

/* Copies the steps, because each result owns its own. */
int orl_year_borrow_hours(struct orl_year *y, const struct orl_year *from, struct orl_error *err)
{
    const struct orl_annual_result *r = from->result;
    const size_t steps = r->n_steps * sizeof *r->steps;
    const size_t columns = r->n_columns * sizeof *r->step_of_column;
    y->hours = from->hours;
    y->result->site = r->site;
    y->result->first_weekday = r->first_weekday;
    y->result->n_moved = r->n_moved;
    y->hours.steps = malloc(steps + 1);
    y->hours.step_of_column = malloc(columns + 1);
    if (!y->hours.steps || !y->hours.step_of_column)
        return orl_year_no_memory(err); /* the caller frees both */
    memcpy(y->hours.steps, r->steps, steps);
    memcpy(y->hours.step_of_column, r->step_of_column, columns);
    return 0;
}

void orl_year_move_hours(struct orl_year *y)
{
    y->result->n_columns = y->hours.n_columns;
    y->result->n_steps = y->hours.n_steps;
    y->result->steps = y->hours.steps;
    y->result->step_of_column = y->hours.step_of_column;
    y->hours.steps = NULL;
    y->hours.step_of_column = NULL;
}

/* Loads the sky that the job requests: opens its weather file and adds its lights to the scene. */
#include <string.h>

#include "light/daylight/daylight.h"
#include "light/daylight/weather.h"
#include "run/diagnostics/diagnostics.h"
#include "run/request/job_inputs.h"
#include "run/run_state.h"

void orl_weather_cache_done(struct orl_weather_cache *weather)
{
    orl_weather_done(&weather->rows);
    *weather = (struct orl_weather_cache){0};
}

/* Reads the weather file unless it was read last. */
static int ensure_weather(const struct orl_files *files, const struct orl_sky_request *request,
                          struct orl_weather_cache *weather, struct orl_error *err)
{
    const char *name = request->weather_file;
    struct orl_file file;
    if (weather->file && strcmp(weather->file, name) == 0 && weather->year == request->weather_year)
        return 0;
    orl_weather_cache_done(weather);
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0) {
        orl_error_at(err, NULL, 0, "sky");
        return code;
    }
    code =
        orl_weather_parse(name, file.data, file.size, request->weather_year, &weather->rows, err);
    files->close(files->ctx, &file);
    weather->file = code == 0 ? name : NULL;
    weather->year = request->weather_year;
    return code;
}

int orl_run_find_sky(const struct orl_files *files, const struct orl_sky_request *request,
                     struct orl_weather_cache *weather, struct orl_daylight *ret_daylight,
                     struct orl_error *err)
{
    if (request->model != ORL_SKY_BY_WEATHER)
        return orl_daylight_from_request(request, NULL, ret_daylight, err);
    int code = ensure_weather(files, request, weather, err);
    if (code < 0)
        return code;
    code = orl_daylight_from_request(request, &weather->rows, ret_daylight, err);
    if (code < 0)
        orl_error_at(err, request->weather_file, err ? err->line : 0, NULL);
    return code;
}

static void warn_of_times(struct orl_run_state *state, const struct orl_weather *weather)
{
    const struct orl_time_shift shift = orl_time_shift_find(weather);
    char text[640];
    if (orl_time_shift_describe(&shift, text, sizeof text))
        orl_run_warn(state, "sky: %s", text);
}

int orl_run_load_sky(struct orl_run_state *state, const struct orl_parsed_scene *parsed_scene,
                     struct orl_daylight *ret_daylight, struct orl_error *err)
{
    const struct orl_sky_request *request = &state->job->sky;
    struct orl_weather_cache weather = {0};
    if (request->model == ORL_SKY_OF_SCENE)
        return 0;
    int code = orl_run_find_sky(state->env->files, request, &weather, ret_daylight, err);
    if (code == 0 && weather.file)
        warn_of_times(state, &weather.rows);
    orl_weather_cache_done(&weather);
    if (code == 0)
        code = orl_lights_check_sky(parsed_scene, err);
    if (code < 0)
        return code;
    state->result->sky_given = true;
    state->result->sky_dark = ret_daylight->black;
    if (ret_daylight->warnings[0])
        orl_run_warn(state, "sky: %s", ret_daylight->warnings);
    return 0;
}

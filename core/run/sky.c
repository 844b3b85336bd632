/* The sky that the job asks for: its weather file opened, its lights put into the scene. */
#include <sodium.h>
#include <string.h>

#include "light/daylight.h"
#include "run/stages.h"

static int find_by_weather(const struct orl_run_state *state, struct orl_daylight *ret_daylight,
                           struct orl_error *err)
{
    const struct orl_sky_request *request = &state->job->sky;
    const struct orl_files *files = state->env->files;
    struct orl_weather weather = {0};
    struct orl_file file;
    int code = files->open(files->ctx, request->weather_file, &file, err);
    if (code < 0) {
        orl_error_at(err, NULL, 0, "sky");
        return code;
    }
    code = orl_weather_parse(request->weather_file, file.data, file.size, &weather, err);
    files->close(files->ctx, &file);
    if (code == 0)
        code = orl_daylight_find(request, &weather, ret_daylight, err);
    if (code < 0)
        orl_error_at(err, request->weather_file, err ? err->line : 0, NULL);
    orl_weather_done(&weather);
    return code;
}

/* Over the numbers that light depends on, so that two ways to ask for one sky share their maps. */
static void hash_daylight(const struct orl_daylight *daylight, unsigned char ret_digest[32])
{
    double numbers[17] = {(double)daylight->pattern.kind,
                          (double)daylight->pattern.n_args,
                          daylight->sun_radiance,
                          daylight->sun_angle_deg,
                          daylight->sun.x,
                          daylight->sun.y,
                          daylight->sun.z};
    if (daylight->black)
        memset(numbers, 0, sizeof numbers);
    else
        memcpy(numbers + 7, daylight->pattern.a, sizeof daylight->pattern.a);
    crypto_hash_sha256(ret_digest, (const unsigned char *)numbers, sizeof numbers);
}

int orl_run_sky(struct orl_run_state *state, struct orl_description *description,
                struct orl_error *err)
{
    const struct orl_sky_request *request = &state->job->sky;
    struct orl_daylight daylight = {0};
    int code;
    if (request->model == ORL_SKY_OF_SCENE)
        return 0;
    code = request->model == ORL_SKY_BY_WEATHER ? find_by_weather(state, &daylight, err)
                                                : orl_daylight_find(request, NULL, &daylight, err);
    if (code == 0)
        code = orl_daylight_add(&daylight, description, err);
    if (code < 0)
        return code;
    hash_daylight(&daylight, state->sky_digest);
    if (daylight.warnings[0])
        orl_run_warn(state, "sky: %s", daylight.warnings);
    return 0;
}

/* Exposure to sunlight: minutes per day in which the sun is visible from points at windows. The
 * loading of the unshaded scene comes first. */
#include <stdlib.h>

#include <oriel/annual/sun_exposure.h>

#include "annual/shades/shaded_year.h"
#include "annual/sky/hours.h"
#include "report/report_internal.h"
#include "run/cache/scene_cache.h"
#include "run/run_state.h"
#include "scene/generate/sky/sun.h"

int orl_unshaded_scene_load(const struct orl_annual_request *request,
                            const struct orl_run_env *given, struct orl_scene **ret_scene,
                            struct orl_error *err)
{
    struct orl_run_env env = *given;
    struct orl_result result = {.threads = 0};
    struct orl_job job;
    struct orl_shaded_scene open;
    const unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_progress progress = {0};
    orl_job_init(&job);
    int code = orl_shaded_scene_init(&open, request, states, false, err);
    job.scene_files = open.request.scene_files; /* borrowed */
    job.n_scene_files = open.request.n_scene_files;
    env.progress = NULL;
    struct orl_run_state state = {.job = &job,
                                  .env = &env,
                                  .result = &result,
                                  .progress = &progress,
                                  .material_overrides = &open.material_overrides};
    if (code == 0)
        code = orl_run_load_scene(&state, err);
    orl_lights_release(state.lights);
    orl_result_done(&result);
    orl_shaded_scene_done(&open);
    if (code < 0)
        orl_scene_release(state.scene);
    else
        *ret_scene = state.scene;
    return code;
}

enum { MOST_PANES = 64, MOST_DAYS = 53, MINUTES = 24 * 60 };

void orl_exposure_request_done(struct orl_exposure_request *exposure_request)
{
    orl_named_points_free(exposure_request->points, exposure_request->n_points);
    *exposure_request = (struct orl_exposure_request){.points = NULL};
}

const char *orl_exposure_level_name(enum orl_exposure_level level)
{
    static const char *const names[] = {"none", "minimum", "medium", "high"};
    return names[level];
}

/* ---- Days ------------------------------------------------------------------------------------ */

struct date {
    int month, day;
};

/* Lists the days of two months: all days of the first, and the second up to its 21st. */
static size_t list_days(double latitude_deg, struct date ret_days[MOST_DAYS])
{
    const bool south = latitude_deg < 0;
    const int first = south ? 8 : 2, length = south ? 31 : 28;
    size_t n = 0;
    for (int day = 1; day <= length; day++)
        ret_days[n++] = (struct date){first, day};
    for (int day = 1; day <= 21; day++)
        ret_days[n++] = (struct date){first + 1, day};
    return n;
}

/* ---- One point ------------------------------------------------------------------------------- */

struct exposure_finder {
    const struct orl_exposure_request *exposure_request;
    const struct orl_scene *scene;
    struct orl_location site;
    enum orl_sun_method sun_method;
    struct orl_sky_rotation north;
    struct date days[MOST_DAYS];
    size_t n_days;
    uint32_t *minutes; /* [point][day] */
};

static bool is_window(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_material_is_window(material);
    return material->kind == ORL_MATERIAL_GLASS || material->kind == ORL_MATERIAL_GLAZING ||
           orl_material_deviates(material) || material->kind == ORL_MATERIAL_BSDF ||
           material->kind == ORL_MATERIAL_ILLUM;
}

static bool is_sun_visible(const struct orl_scene *scene, struct orl_vec3 origin,
                           struct orl_vec3 towards)
{
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(scene->geometry, origin, towards, INFINITY, &hit))
            return true;
        if (!is_window(orl_scene_material(scene, hit.facet)))
            return false;
        origin = orl_hit_ray_origin(scene->geometry, &hit, towards);
    }
    return false;
}

static struct orl_sun_position sun_at(const struct exposure_finder *f,
                                      const struct orl_moment *moment)
{
    double declination, hour;
    if (f->sun_method == ORL_SUN_ACCURATE)
        return orl_sun_accurate(&f->site, moment);
    orl_sun_clock(&f->site, moment, &declination, &hour);
    return orl_sun_at(&f->site, declination, hour);
}

static void count_minutes(void *arg, size_t index, uint32_t member)
{
    const struct exposure_finder *f = arg;
    const struct date date = f->days[index % f->n_days];
    const struct orl_vec3 at =
        orl_sub(f->exposure_request->points[index / f->n_days].at, f->scene->geometry->center);
    uint32_t minutes = 0;
    (void)member;
    for (int i = 0; i < MINUTES; i++) {
        const struct orl_moment moment = {
            .month = date.month, .day = date.day, .hour = (i + 0.5) / 60};
        const struct orl_sun_position sun = sun_at(f, &moment);
        if (sun.altitude_rad <= 0 ||
            sun.altitude_rad < f->exposure_request->least_altitude_deg * ORL_DEG_TO_RAD)
            continue;
        minutes += is_sun_visible(f->scene, at,
                                  orl_sky_rotation_to_scene(f->north, orl_sun_direction(&sun)));
    }
    f->minutes[index] = minutes;
}

static enum orl_exposure_level level_of(uint32_t minutes)
{
    return minutes >= 240   ? ORL_EXPOSED_HIGH
           : minutes >= 180 ? ORL_EXPOSED_MEDIUM
           : minutes >= 90  ? ORL_EXPOSED_MINIMUM
                            : ORL_EXPOSED_NONE;
}

static struct orl_exposure exposure_of(const struct exposure_finder *f, size_t point)
{
    const uint32_t *minutes = f->minutes + point * f->n_days;
    size_t best = 0;
    for (size_t d = 1; d < f->n_days; d++)
        if (minutes[d] > minutes[best])
            best = d;
    return (struct orl_exposure){.month = f->days[best].month,
                                 .day = f->days[best].day,
                                 .hours = minutes[best] / 60.0,
                                 .last_day_hours = minutes[f->n_days - 1] / 60.0,
                                 .level = level_of(minutes[best])};
}

/* ---- All points ------------------------------------------------------------------------------ */

static int find_all(struct exposure_finder *f, const struct orl_run_env *env,
                    struct orl_exposure *ret_exposures, struct orl_error *err)
{
    const size_t n = f->exposure_request->n_points;
    f->minutes = calloc(n * f->n_days + 1, sizeof *f->minutes);
    if (!f->minutes)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    const int code = orl_parallel_try(env->pool, n * f->n_days, count_minutes, f);
    orl_thread_pool_set_cancel(env->pool, NULL);
    for (size_t i = 0; i < n && code == 0; i++)
        ret_exposures[i] = exposure_of(f, i);
    free(f->minutes);
    return code < 0 ? orl_error_set(err, code, "cancelled") : 0;
}

int orl_exposure_compute(const struct orl_exposure_request *exposure_request,
                         const struct orl_annual_site *site,
                         const struct orl_annual_request *request, const struct orl_run_env *env,
                         struct orl_exposure *ret_exposures, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    struct exposure_finder exposure_finder = {
        .exposure_request = exposure_request,
        .site = {.latitude_rad = site->latitude_deg * ORL_DEG_TO_RAD,
                 .longitude_rad = -site->longitude_deg * ORL_DEG_TO_RAD,
                 .meridian_rad = -15 * site->time_zone_h * ORL_DEG_TO_RAD},
        .sun_method = request->sun_method,
        .north = orl_sky_rotation_by_north(request->north_deg)};
    int code = orl_unshaded_scene_load(request, env, &scene, err);
    if (code < 0)
        return code;
    exposure_finder.scene = scene;
    exposure_finder.n_days = list_days(site->latitude_deg, exposure_finder.days);
    code = find_all(&exposure_finder, env, ret_exposures, err);
    orl_scene_release(scene);
    return code;
}

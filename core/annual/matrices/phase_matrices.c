/* Matrices of the three- and five-phase methods, computed by a year's scene and paths. */
#include <oriel/annual/annual_phases.h>

#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/units.h>

#include "annual/matrices/phase_windows.h"
#include "annual/shades/shaded_scene.h"
#include "annual/sun/sunlight.h"
#include "scene/geometry/surface_offset.h"

enum { CELLS = ORL_PHASES_CELLS, PATCHES = ORL_ANNUAL_PATCHES };

/* State of the computation while its year runs. */
struct matrices {
    struct orl_annual_request request; /* the request without its sensors, which are below */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_phase_windows windows;
    struct orl_phase_matrices *result;
    struct orl_year *year;
    struct orl_year_suns suns;
    struct orl_bsdf_panes bsdf_panes;
    struct orl_health *healths; /* by member */
    atomic_bool failed;         /* true after an allocation failure */
};

void orl_phase_matrices_done(struct orl_phase_matrices *matrices)
{
    for (size_t i = 0; matrices->windows && i < matrices->n_windows; i++) {
        free(matrices->windows[i].name);
        free(matrices->windows[i].transmission);
        free(matrices->windows[i].daylight);
        free(matrices->windows[i].direct_daylight);
        free(matrices->windows[i].view);
        free(matrices->windows[i].direct_view);
    }
    free(matrices->windows);
    free(matrices->suns);
    *matrices = (struct orl_phase_matrices){.windows = NULL};
}

/* ---- Views ----------------------------------------------------------------------------------- */

static struct orl_shading_point place_of(const struct matrices *p, size_t sensor)
{
    const struct orl_geometry *geometry = p->year->lit_scene->geometry;
    const struct orl_sensor *s = &p->sensors[sensor];
    const struct orl_vec3 normal = orl_normalize(s->direction);
    return (struct orl_shading_point){
        .point = orl_offset_from_surface(geometry, orl_sub(s->position, geometry->center), normal),
        .normal = normal};
}

static void compute_view(void *arg, size_t sensor, uint32_t member)
{
    struct matrices *p = arg;
    const size_t n = p->result->n_windows * CELLS;
    const struct orl_shading_point place = place_of(p, sensor);
    float *room = calloc(2 * n + ORL_BINS, sizeof *room);
    if (!room) {
        atomic_store(&p->failed, true);
        return;
    }
    struct orl_annual_exits exits = {.window_of_port = p->windows.of_port,
                                     .frames = p->windows.frames,
                                     .basis = &p->windows.basis,
                                     .all = room,
                                     .straight = room + n};
    struct orl_path_sums sums = {.bins = room + 2 * n, .exits = &exits};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_annual_batch batch = {.seed = p->request.seed,
                                               .sensor = sensor,
                                               .batch = b,
                                               .samples = p->year->batch_samples,
                                               .pool = p->year->env->run->pool};
        orl_annual_trace(&p->year->scene, &place, &batch, &sums, &p->healths[member]);
    }
    const float share = 1.0F / ((float)p->year->batch_samples * ORL_ANNUAL_BATCHES);
    for (size_t w = 0; w < p->result->n_windows; w++)
        for (size_t c = 0; c < CELLS; c++) {
            struct orl_phase_window *window = &p->result->windows[w];
            window->view[sensor * CELLS + c] = exits.all[w * CELLS + c] * share;
            window->direct_view[sensor * CELLS + c] = exits.straight[w * CELLS + c] * share;
        }
    free(room);
}

/* ---- Suns ------------------------------------------------------------------------------------ */

/* Reinhart's sky MF:6: rows of equal height. The zenith patch extends half a row's height from the
 * zenith. */
static int place_suns(struct matrices *p)
{
    enum { FINE = 6, ROWS = 7 };
    static const int tregenza[ROWS] = {30, 30, 24, 24, 18, 12, 6};
    const double height = ORL_PI / 2 / (ROWS * FINE + 0.5);
    struct orl_year_suns *suns = &p->suns;
    suns->at = calloc(ORL_PHASES_SUNS, sizeof *suns->at);
    suns->in_sky = calloc(ORL_PHASES_SUNS, sizeof *suns->in_sky);
    if (!suns->at || !suns->in_sky)
        return ORL_ERR_NOMEM;
    for (int row = 0; row <= ROWS * FINE; row++) {
        const bool zenith = row == ROWS * FINE;
        const int columns = zenith ? 1 : FINE * tregenza[row / FINE];
        const double altitude = zenith ? ORL_PI / 2 : (row + 0.5) * height;
        for (int k = 0; k < columns; k++) {
            const double turn = 2 * ORL_PI * k / columns;
            const struct orl_vec3 sun = orl_normalize(
                orl_v3(cos(altitude) * sin(turn), cos(altitude) * cos(turn), sin(altitude)));
            suns->in_sky[suns->count] = sun;
            suns->at[suns->count++] = (struct orl_hour_sun){
                .towards = orl_sky_rotation_to_scene(p->year->scene.north, sun),
                .angle_rad = ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD,
                .wanted = true};
        }
    }
    return 0;
}

static void compute_sun_coefficients(void *arg, size_t sensor, uint32_t member)
{
    struct matrices *p = arg;
    const size_t n = p->suns.count;
    const struct orl_shading_point place = place_of(p, sensor);
    const uint64_t name = p->request.seed + sensor;
    const float solid_sr =
        (float)(2 * ORL_PI * (1 - cos(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD)));
    unsigned char lit = 1;
    const struct orl_sensor_sunlight sunlight = {
        .at = calloc(ORL_SUNLIGHT_ROWS * n + 1, sizeof *sunlight.at),
        .n_suns = n,
        .lit = &lit,
        .direct_only = true,
        .disc_points = ORL_DISC_LEAST_POINTS};
    (void)member;
    if (!sunlight.at) {
        atomic_store(&p->failed, true);
        return;
    }
    float *to = p->result->suns + sensor * ORL_PHASES_SUNS;
    orl_sunlight_find_hours(&p->year->scene, &p->suns, &place, name, p->year->env->run->pool,
                            &sunlight);
    orl_bsdf_panes_add(&p->bsdf_panes, &place, name, p->year->env->run->pool, &sunlight);
    to[0] = 0;
    for (size_t i = 0; i < n; i++)
        to[i + 1] = solid_sr * orl_sensor_sunlight_row(&sunlight, 0, ORL_SUNLIGHT_DIRECT)[i];
    free(sunlight.at);
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int check_sensors_inside(const struct matrices *p, struct orl_error *err)
{
    const struct orl_lit_scene *lit_scene = p->year->lit_scene;
    if (lit_scene->open || lit_scene->n_ports == 0)
        return orl_error_set(
            err, ORL_ERR_UNSUPPORTED,
            "matrices of phases are of windows of a closed building, and light has "
            "other ways in: close it, or leave \"phases\" out");
    for (size_t i = 0; i < p->n_sensors; i++)
        if (orl_lit_scene_is_outside(lit_scene, place_of(p, i).point))
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "sensor %zu stands outdoors: no window is between it and the sky",
                                 i + 1);
    return 0;
}

static int allocate_matrices(struct matrices *p)
{
    struct orl_phase_matrices *r = p->result;
    bool room = true;
    r->suns = calloc(p->n_sensors * ORL_PHASES_SUNS + 1, sizeof *r->suns);
    p->healths = calloc(orl_thread_pool_size(p->year->env->run->pool), sizeof *p->healths);
    for (size_t i = 0; i < r->n_windows; i++) {
        struct orl_phase_window *w = &r->windows[i];
        w->transmission = calloc((size_t)CELLS * CELLS, sizeof *w->transmission);
        w->daylight = calloc((size_t)CELLS * PATCHES, sizeof *w->daylight);
        w->direct_daylight = calloc((size_t)CELLS * PATCHES, sizeof *w->direct_daylight);
        w->view = calloc(p->n_sensors * CELLS + 1, sizeof *w->view);
        w->direct_view = calloc(p->n_sensors * CELLS + 1, sizeof *w->direct_view);
        room = room && w->transmission && w->daylight && w->direct_daylight && w->view &&
               w->direct_view;
    }
    return room && r->suns && p->healths ? 0 : ORL_ERR_NOMEM;
}

static int make_all(struct matrices *p)
{
    struct orl_year *y = p->year;
    struct orl_thread_pool *pool = y->env->run->pool;
    int code = allocate_matrices(p);
    if (code == 0)
        code = orl_phase_windows_compute(&p->windows, y, p->result, p->healths);
    if (code == 0)
        code = orl_parallel_try(pool, p->n_sensors, compute_view, p);
    if (code == 0)
        code = place_suns(p);
    if (code == 0)
        code = orl_bsdf_panes_init(&p->bsdf_panes, &y->scene, &p->suns, p->n_sensors,
                                   p->request.seed, pool);
    if (code == 0)
        code = orl_parallel_try(pool, p->n_sensors, compute_sun_coefficients, p);
    return code == 0 && atomic_load(&p->failed) ? ORL_ERR_NOMEM : code;
}

/* Computes all matrices; called when the year is prepared. */
static int compute_all(void *ctx, struct orl_year *y, struct orl_error *err)
{
    struct matrices *p = ctx;
    p->year = y;
    int code = orl_year_ensure_scene(y, err);
    if (code == 0)
        code = check_sensors_inside(p, err);
    if (code == 0)
        code = orl_phase_windows_init(&p->windows, y->lit_scene, p->result, err);
    if (code < 0)
        return code;
    code = make_all(p);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code, "too many kinds of BSDF panes for matrices of phases");
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

int orl_phase_matrices_compute(const struct orl_annual_request *request,
                               const struct orl_run_env *given,
                               struct orl_phase_matrices *ret_phases, struct orl_error *err)
{
    const unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_phase_matrices matrices = {.windows = NULL};
    struct matrices p = {
        .sensors = request->sensors, .n_sensors = request->n_sensors, .result = &matrices};
    struct orl_run_env run = *given;
    const struct orl_annual_env env = {.run = &run};
    struct orl_annual_result year = {.n_steps = 0};
    struct orl_shaded_scene open;
    if (request->n_sensors > ORL_PHASES_MOST_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "matrices of phases are of at most %d sensors, and there are %zu",
                             ORL_PHASES_MOST_SENSORS, request->n_sensors);
    int code = orl_shaded_scene_init(&open, request, states, false, err);
    const struct orl_year_overrides overrides = {
        .material_overrides = request->n_groups > 0 ? &open.material_overrides : NULL,
        .sun_only = true,
        .prepared = compute_all,
        .ctx = &p};
    run.warned = NULL; /* the year itself has issued the warnings */
    run.progress = NULL;
    p.request = open.request;
    p.request.sensors = NULL;
    p.request.n_sensors = 0;
    p.request.grids = NULL;
    p.request.n_grids = 0;
    p.request.coefficients = false;
    if (code == 0)
        code = orl_year_run(&p.request, &env, &overrides, &year, err);
    orl_annual_done(&year);
    orl_shaded_scene_done(&open);
    orl_phase_windows_done(&p.windows);
    orl_bsdf_panes_done(&p.bsdf_panes);
    free(p.suns.at);
    free(p.suns.in_sky);
    free(p.healths);
    if (code < 0)
        orl_phase_matrices_done(&matrices);
    else
        *ret_phases = matrices;
    return code;
}

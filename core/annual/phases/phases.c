/* Matrices of the three- and five-phase methods, computed by a year's scene and paths. */
#include <oriel/annual_phases.h>

#include <stdio.h>
#include <stdlib.h>

#include <oriel/units.h>

#include "annual/phases/phase_windows.h"
#include "annual/shades/variant.h"
#include "annual/sun/sunlight.h"
#include "scene/geometry/stand.h"

enum { CELLS = ORL_PHASES_CELLS, PATCHES = ORL_ANNUAL_PATCHES };

/* State of the computation while its year runs. */
struct phases {
    struct orl_annual_request request; /* the request without its sensors, which are below */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_phase_windows windows;
    struct orl_annual_phases *result;
    struct orl_year *year;
    struct orl_year_suns suns;
    struct orl_panels panels;
    struct orl_health *healths; /* by member */
    atomic_bool failed;         /* true after an allocation failure */
};

void orl_annual_phases_done(struct orl_annual_phases *phases)
{
    for (size_t i = 0; phases->windows && i < phases->n_windows; i++) {
        free(phases->windows[i].name);
        free(phases->windows[i].transmission);
        free(phases->windows[i].daylight);
        free(phases->windows[i].straight_daylight);
        free(phases->windows[i].view);
        free(phases->windows[i].straight_view);
    }
    free(phases->windows);
    free(phases->suns);
    *phases = (struct orl_annual_phases){.windows = NULL};
}

/* ---- Views ----------------------------------------------------------------------------------- */

static struct orl_place place_of(const struct phases *p, size_t sensor)
{
    const struct orl_geometry *geometry = p->year->world->geometry;
    const struct orl_sensor *s = &p->sensors[sensor];
    const struct orl_vec3 normal = orl_normalize(s->direction);
    return (struct orl_place){
        .point = orl_stand(geometry, orl_sub(s->position, geometry->center), normal),
        .normal = normal};
}

static void find_view(void *arg, size_t sensor, uint32_t member)
{
    struct phases *p = arg;
    const size_t n = p->result->n_windows * CELLS;
    const struct orl_place place = place_of(p, sensor);
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
    struct orl_annual_sums sums = {.bins = room + 2 * n, .exits = &exits};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_annual_batch batch = {.seed = p->request.seed,
                                               .sensor = sensor,
                                               .batch = b,
                                               .samples = p->year->batch_samples,
                                               .crew = p->year->env->run->crew};
        orl_annual_trace(&p->year->scene, &place, &batch, &sums, &p->healths[member]);
    }
    const float share = 1.0F / ((float)p->year->batch_samples * ORL_ANNUAL_BATCHES);
    for (size_t w = 0; w < p->result->n_windows; w++)
        for (size_t c = 0; c < CELLS; c++) {
            struct orl_phase_window *window = &p->result->windows[w];
            window->view[sensor * CELLS + c] = exits.all[w * CELLS + c] * share;
            window->straight_view[sensor * CELLS + c] = exits.straight[w * CELLS + c] * share;
        }
    free(room);
}

/* ---- Suns ------------------------------------------------------------------------------------ */

/* Reinhart's sky MF:6: rows of equal height. The zenith patch extends half a row's height from the
 * zenith. */
static int place_suns(struct phases *p)
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
            suns->at[suns->count++] =
                (struct orl_hour_sun){.towards = orl_turn_to_scene(p->year->scene.north, sun),
                                      .angle_rad = ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD,
                                      .wanted = true};
        }
    }
    return 0;
}

static void find_suns(void *arg, size_t sensor, uint32_t member)
{
    struct phases *p = arg;
    const size_t n = p->suns.count;
    const struct orl_place place = place_of(p, sensor);
    const uint64_t name = p->request.seed + sensor;
    const float solid_sr =
        (float)(2 * ORL_PI * (1 - cos(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD)));
    unsigned char lit = 1;
    const struct orl_sun_rows rows = {.at = calloc(ORL_SUN_ROWS * n + 1, sizeof *rows.at),
                                      .n_suns = n,
                                      .lit = &lit,
                                      .direct_only = true,
                                      .disc_points = ORL_DISC_LEAST_POINTS};
    (void)member;
    if (!rows.at) {
        atomic_store(&p->failed, true);
        return;
    }
    float *to = p->result->suns + sensor * ORL_PHASES_SUNS;
    orl_sunlit_hours_find(&p->year->scene, &p->suns, &place, name, p->year->env->run->crew, &rows);
    orl_panels_add(&p->panels, &place, name, p->year->env->run->crew, &rows);
    to[0] = 0;
    for (size_t i = 0; i < n; i++)
        to[i + 1] = solid_sr * orl_sun_row_of(&rows, 0, ORL_SUN_DIRECT)[i];
    free(rows.at);
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int check_sensors_inside(const struct phases *p, struct orl_error *err)
{
    const struct orl_world *world = p->year->world;
    if (world->open || world->n_ports == 0)
        return orl_error_set(
            err, ORL_ERR_UNSUPPORTED,
            "matrices of phases are of windows of a closed building, and light has "
            "other ways in: close it, or leave \"phases\" out");
    for (size_t i = 0; i < p->n_sensors; i++)
        if (orl_world_is_outside(world, place_of(p, i).point))
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "sensor %zu stands outdoors: no window is between it and the sky",
                                 i + 1);
    return 0;
}

static int make_room(struct phases *p)
{
    struct orl_annual_phases *r = p->result;
    bool room = true;
    r->suns = calloc(p->n_sensors * ORL_PHASES_SUNS + 1, sizeof *r->suns);
    p->healths = calloc(orl_crew_size(p->year->env->run->crew), sizeof *p->healths);
    for (size_t i = 0; i < r->n_windows; i++) {
        struct orl_phase_window *w = &r->windows[i];
        w->transmission = calloc((size_t)CELLS * CELLS, sizeof *w->transmission);
        w->daylight = calloc((size_t)CELLS * PATCHES, sizeof *w->daylight);
        w->straight_daylight = calloc((size_t)CELLS * PATCHES, sizeof *w->straight_daylight);
        w->view = calloc(p->n_sensors * CELLS + 1, sizeof *w->view);
        w->straight_view = calloc(p->n_sensors * CELLS + 1, sizeof *w->straight_view);
        room = room && w->transmission && w->daylight && w->straight_daylight && w->view &&
               w->straight_view;
    }
    return room && r->suns && p->healths ? 0 : ORL_ERR_NOMEM;
}

static int make_all(struct phases *p)
{
    struct orl_year *y = p->year;
    struct orl_crew *crew = y->env->run->crew;
    int code = make_room(p);
    if (code == 0)
        code = orl_phase_windows_look(&p->windows, y, p->result, p->healths);
    if (code == 0)
        code = orl_crew_try(crew, p->n_sensors, find_view, p);
    if (code == 0)
        code = place_suns(p);
    if (code == 0)
        code =
            orl_panels_init(&p->panels, &y->scene, &p->suns, p->n_sensors, p->request.seed, crew);
    if (code == 0)
        code = orl_crew_try(crew, p->n_sensors, find_suns, p);
    return code == 0 && atomic_load(&p->failed) ? ORL_ERR_NOMEM : code;
}

/* Computes all matrices; called when the year is prepared. */
static int find_all(void *ctx, struct orl_year *y, struct orl_error *err)
{
    struct phases *p = ctx;
    p->year = y;
    int code = orl_year_need_scene(y, err);
    if (code == 0)
        code = check_sensors_inside(p, err);
    if (code == 0)
        code = orl_phase_windows_init(&p->windows, y->world, p->result, err);
    if (code < 0)
        return code;
    code = make_all(p);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code, "too many kinds of BSDF panes for matrices of phases");
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

int orl_annual_phases_find(const struct orl_annual_request *request,
                           const struct orl_run_env *given, struct orl_annual_phases *ret_phases,
                           struct orl_error *err)
{
    const unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_annual_phases phases = {.windows = NULL};
    struct phases p = {
        .sensors = request->sensors, .n_sensors = request->n_sensors, .result = &phases};
    struct orl_run_env run = *given;
    const struct orl_annual_env env = {.run = &run};
    struct orl_annual_result year = {.n_steps = 0};
    struct orl_annual_variant open;
    if (request->n_sensors > ORL_PHASES_MOST_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "matrices of phases are of at most %d sensors, and there are %zu",
                             ORL_PHASES_MOST_SENSORS, request->n_sensors);
    int code = orl_annual_variant_init(&open, request, states, false, err);
    const struct orl_year_variant how = {.swaps = request->n_groups > 0 ? &open.swaps : NULL,
                                         .sun_only = true,
                                         .prepared = find_all,
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
        code = orl_year_run(&p.request, &env, &how, &year, err);
    orl_annual_done(&year);
    orl_annual_variant_done(&open);
    orl_phase_windows_done(&p.windows);
    orl_panels_done(&p.panels);
    free(p.suns.at);
    free(p.suns.in_sky);
    free(p.healths);
    if (code < 0)
        orl_annual_phases_done(&phases);
    else
        *ret_phases = phases;
    return code;
}

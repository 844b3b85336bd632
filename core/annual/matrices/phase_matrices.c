/*
 * Matrices of the three- and five-phase methods, computed by a year's scene and paths. First
 * come the windows with their transmission and daylight, then the views.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_phases.h>
#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/shades/shaded_year.h"
#include "annual/sun/sunlight.h"
#include "annual/year/annual_year.h"
#include "scene/geometry/geometry.h"

/*
 * Windows of the three-phase method: the ports of a closed building, grouped by material and
 * direction. Computes their transmission, and the sky that they see, by cells of directions.
 */

/* Per cell: DRAWS_SIDE^2 samples of transmission, and RAYS_SIDE^2 rays outdoors. */
enum { CELLS = ORL_PHASES_CELLS, PATCHES = ORL_ANNUAL_PATCHES, DRAWS_SIDE = 64, RAYS_SIDE = 32 };

struct orl_phase_windows {
    struct orl_arrays arrays; /* the three below, and those of struct matrices */
    struct orl_basis basis;
    uint32_t *of_port;        /* window of each port of the lit scene */
    struct orl_frame *frames; /* by window: n points inwards */
    uint32_t *panes;          /* one port of each window */
};

/* ---- Grouping -------------------------------------------------------------------------------- */

static const struct orl_material *material_of(const struct orl_lit_scene *lit_scene, uint32_t port)
{
    return orl_lit_scene_material_of(lit_scene, lit_scene->ports[port].facet);
}

/* Returns the frame of a BSDF; for other materials, up is the scene's. */
static struct orl_frame frame_of(const struct orl_material *material, struct orl_vec3 inward)
{
    static const double upright = 0.999;
    if (material->kind == ORL_MATERIAL_BSDF)
        return orl_bsdf_frame(material, inward);
    const struct orl_vec3 up = fabs(inward.z) < upright ? orl_v3(0, 0, 1) : orl_v3(0, 1, 0);
    struct orl_frame frame = {.n = inward};
    frame.v = orl_normalize(orl_madd(up, inward, -orl_dot(up, inward)));
    frame.u = orl_cross(frame.v, frame.n);
    return frame;
}

static bool belongs_to(const struct orl_phase_windows *w, const struct orl_lit_scene *lit_scene,
                       uint32_t window, uint32_t port)
{
    static const double alike = 1 - 1e-6;
    return material_of(lit_scene, w->panes[window]) == material_of(lit_scene, port) &&
           orl_dot(w->frames[window].n, orl_neg(lit_scene->ports[port].outward)) >= alike;
}

static char *name_of(const struct orl_phase_windows *w, const struct orl_lit_scene *lit_scene,
                     uint32_t window)
{
    const struct orl_material *material = material_of(lit_scene, w->panes[window]);
    const char *name =
        lit_scene->scene->parsed_scene.materials[material - lit_scene->materials].name;
    uint32_t nth = 1;
    char *text = NULL;
    for (uint32_t i = 0; i < window; i++)
        nth += material_of(lit_scene, w->panes[i]) == material;
    if ((nth > 1 ? asprintf(&text, "%s-%u", name, nth) : asprintf(&text, "%s", name)) < 0)
        return NULL;
    return text;
}

/* Groups the ports, and creates the result's windows with names. Returns 0, ORL_ERR_NOMEM or
 * _LIMIT. */
static int orl_phase_windows_init(struct orl_phase_windows *w,
                                  const struct orl_lit_scene *lit_scene,
                                  struct orl_phase_matrices *result, struct orl_error *err)
{
    orl_basis_standard("LBNL/Klems Full", &w->basis);
    w->of_port = orl_arrays_new(&w->arrays, lit_scene->n_ports, sizeof *w->of_port);
    w->frames = orl_arrays_new(&w->arrays, ORL_PHASES_MOST_WINDOWS, sizeof *w->frames);
    w->panes = orl_arrays_new(&w->arrays, ORL_PHASES_MOST_WINDOWS, sizeof *w->panes);
    result->windows = calloc(ORL_PHASES_MOST_WINDOWS, sizeof *result->windows);
    if (w->arrays.failed || !result->windows)
        return orl_year_no_memory(err);
    for (uint32_t port = 0; port < lit_scene->n_ports; port++) {
        uint32_t window = 0;
        while (window < result->n_windows && !belongs_to(w, lit_scene, window, port))
            window++;
        if (window == ORL_PHASES_MOST_WINDOWS)
            return orl_error_set(err, ORL_ERR_LIMIT,
                                 "the windows have more than %d combinations of material and "
                                 "direction, too many for phase matrices",
                                 ORL_PHASES_MOST_WINDOWS);
        if (window == result->n_windows) {
            w->panes[window] = port;
            w->frames[window] =
                frame_of(material_of(lit_scene, port), orl_neg(lit_scene->ports[port].outward));
            result->windows[window].name = name_of(w, lit_scene, window);
            result->n_windows++;
            if (!result->windows[window].name)
                return orl_year_no_memory(err);
        }
        w->of_port[port] = window;
        result->windows[window].n_panes++;
    }
    return 0;
}

/* ---- Cells ----------------------------------------------------------------------------------- */

/* State of the computation while its year runs. */
struct matrices {
    struct orl_annual_request request; /* the request without its sensors, which are below */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_phase_windows windows;
    bool exact[ORL_PHASES_MOST_WINDOWS]; /* windows whose transmission is the BSDF's own matrix */
    struct orl_phase_matrices *result;
    struct orl_year *year;
    struct orl_year_suns suns;
    struct orl_bsdf_panes bsdf_panes;
    struct orl_health *healths; /* one per thread */
    atomic_bool failed;         /* true after an allocation failure */
};

static struct orl_random random_of(const struct matrices *p, size_t cell, uint64_t kind)
{
    return orl_random_stream(p->year->request->seed, ORL_PURPOSE_ANNUAL,
                             ~(uint64_t)0 - 4 * cell - kind);
}

/* Returns a jittered point in one of side x side strata of the unit square. */
static void jitter_in_part(uint32_t i, uint32_t side, struct orl_random *random, double u[2])
{
    const uint32_t column = i % side, row = i / side;
    u[0] = (column + orl_random_uniform(random)) / side;
    u[1] = (row + orl_random_uniform(random)) / side;
}

/* Estimates a row of the transmission as means over cells, by sampling the material with rays from
 * inside. */
static void draw_row(const struct matrices *p, size_t window, size_t cell, float *row)
{
    const struct orl_lit_scene *lit_scene = p->year->lit_scene;
    const struct orl_port *port = &lit_scene->ports[p->windows.panes[window]];
    const struct orl_material *material = material_of(lit_scene, p->windows.panes[window]);
    const struct orl_frame *frame = &p->windows.frames[window];
    const struct orl_basis *basis = &p->windows.basis;
    const struct orl_hit hit = orl_hit_surface_mean(
        port->outside_is_front ? port->outward : frame->n, !port->outside_is_front);
    struct orl_random random = random_of(p, window * CELLS + cell, 0);
    const float share = 1.0F / (DRAWS_SIDE * DRAWS_SIDE);
    for (uint32_t i = 0; i < DRAWS_SIDE * DRAWS_SIDE; i++) {
        double u[2];
        jitter_in_part(i, DRAWS_SIDE, &random, u);
        const struct orl_vec3 eye =
            orl_to_world(frame, orl_basis_direction(basis, (int)cell, u[0], u[1]));
        const struct orl_surface_sample s = orl_material_sample(
            material, &hit, eye, ORL_TRANSPORT_EYE, ORL_LOBE_TRANSMITTED, &random);
        const struct orl_vec3 travels = orl_to_local(frame, orl_neg(s.direction));
        if (s.event == ORL_EVENT_ABSORBED || !(travels.z > 0))
            continue;
        const int from = orl_basis_cell(basis, orl_polar_of(travels), 0);
        if (from >= 0)
            row[from] += share * (float)orl_luma(s.weight);
    }
}

/* Copies the BSDF's own matrix, and returns true, if it has this basis and its front is inside. */
static bool copy_matrix(const struct matrices *p, size_t window)
{
    const struct orl_lit_scene *lit_scene = p->year->lit_scene;
    const struct orl_port *port = &lit_scene->ports[p->windows.panes[window]];
    const struct orl_material *material = material_of(lit_scene, p->windows.panes[window]);
    struct orl_error err = {0};
    size_t rows, columns;
    float *values;
    if (material->kind != ORL_MATERIAL_BSDF || port->outside_is_front || material->pattern ||
        orl_rgb_max(orl_bsdf_surface_of(material)->diffuse.through) > 0 ||
        orl_bsdf_transmission(orl_material_bsdf(material), &rows, &columns, &values, &err) < 0)
        return false;
    const bool fits = rows == CELLS && columns == CELLS;
    for (size_t i = 0; fits && i < (size_t)CELLS * CELLS; i++)
        p->result->windows[window].transmission[i] = (float)orl_luma((struct orl_rgb){
            (double)values[3 * i], (double)values[3 * i + 1], (double)values[3 * i + 2]});
    free(values);
    return fits;
}

static void draw_cell(void *arg, size_t index, uint32_t member)
{
    const struct matrices *p = arg;
    const size_t window = index / CELLS, cell = index % CELLS;
    (void)member;
    if (!p->exact[window])
        draw_row(p, window, cell, p->result->windows[window].transmission + cell * CELLS);
}

/* ---- The sky --------------------------------------------------------------------------------- */

/* Returns a port of the window, sampled by area. */
static uint32_t port_by_area(const struct matrices *p, uint32_t window, double u)
{
    const struct orl_lit_scene *lit_scene = p->year->lit_scene;
    double all = 0;
    uint32_t last = 0;
    for (uint32_t i = 0; i < lit_scene->n_ports; i++)
        all += p->windows.of_port[i] == window ? lit_scene->ports[i].area : 0;
    for (uint32_t i = 0; i < lit_scene->n_ports; i++) {
        if (p->windows.of_port[i] != window)
            continue;
        last = i;
        u -= lit_scene->ports[i].area / all;
        if (u < 0)
            break;
    }
    return last;
}

static void fill_patches(const float *bins, float *ret_patches)
{
    static const float share = 1.0F / (RAYS_SIDE * RAYS_SIDE);
    double ground = 0;
    for (uint32_t bin = ORL_BINS_ABOVE; bin < ORL_BINS; bin++)
        ground += (double)bins[bin];
    ret_patches[0] = (float)ground * share;
    for (uint32_t bin = 0; bin < ORL_BINS_ABOVE; bin++)
        ret_patches[bin + 1] = bins[bin] * share;
}

static void trace_rays_out(struct matrices *p, uint32_t window, size_t cell, bool straight,
                           float *bins, struct orl_health *health)
{
    const struct orl_lit_scene *lit_scene = p->year->lit_scene;
    const struct orl_frame *frame = &p->windows.frames[window];
    struct orl_random random = random_of(p, (size_t)window * CELLS + cell, straight ? 2 : 1);
    struct orl_path_sums sums = {.bins = bins};
    memset(bins, 0, ORL_BINS * sizeof *bins);
    for (uint32_t i = 0; i < RAYS_SIDE * RAYS_SIDE; i++) {
        double u[2], at[2];
        jitter_in_part(i, RAYS_SIDE, &random, u);
        at[0] = orl_random_uniform(&random);
        at[1] = orl_random_uniform(&random);
        const uint32_t which = port_by_area(p, window, orl_random_uniform(&random));
        const struct orl_port *port = &lit_scene->ports[which];
        struct orl_vec3 point, normal;
        orl_facet_sample(lit_scene->geometry, port->facet, at, &point, &normal);
        const struct orl_vec3 towards = orl_neg(
            orl_to_world(frame, orl_basis_direction(&p->windows.basis, (int)cell, u[0], u[1])));
        orl_annual_trace_outdoors(
            &p->year->scene, orl_offset_from_surface(lit_scene->geometry, point, port->outward),
            towards,
            orl_random_stream(p->year->request->seed, ORL_PURPOSE_ANNUAL,
                              orl_mix64(orl_random_bits(&random))),
            straight, &sums, health);
    }
}

static void trace_cell(void *arg, size_t index, uint32_t member)
{
    struct matrices *p = arg;
    const size_t window = index / CELLS, cell = index % CELLS;
    struct orl_phase_window *of = &p->result->windows[window];
    float *bins = malloc(ORL_BINS * sizeof *bins);
    if (!bins) {
        atomic_store(&p->failed, true);
        return;
    }
    trace_rays_out(p, (uint32_t)window, cell, false, bins, &p->healths[member]);
    fill_patches(bins, of->daylight + cell * PATCHES);
    trace_rays_out(p, (uint32_t)window, cell, true, bins, &p->healths[member]);
    fill_patches(bins, of->direct_daylight + cell * PATCHES);
    free(bins);
}

/* Fills transmission and daylight, which are allocated. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
static int compute_windows(struct matrices *p)
{
    const size_t cells = p->result->n_windows * CELLS;
    struct orl_thread_pool *pool = p->year->env->run->pool;
    int code = orl_parallel_try(pool, cells, trace_cell, p);
    for (size_t w = 0; w < p->result->n_windows; w++)
        p->exact[w] = copy_matrix(p, w);
    return code == 0 ? orl_parallel_try(pool, cells, draw_cell, p) : code;
}

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

static void compute_view(void *arg, size_t sensor, uint32_t member)
{
    struct matrices *p = arg;
    const size_t n = p->result->n_windows * CELLS;
    const struct orl_shading_point place = orl_year_place_of(p->year, &p->sensors[sensor]);
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
    suns->at = orl_arrays_new(&p->windows.arrays, ORL_PHASES_SUNS, sizeof *suns->at);
    suns->in_sky = orl_arrays_new(&p->windows.arrays, ORL_PHASES_SUNS, sizeof *suns->in_sky);
    if (p->windows.arrays.failed)
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
    const struct orl_shading_point place = orl_year_place_of(p->year, &p->sensors[sensor]);
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
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "phase matrices need a closed building, but light enters other than "
                             "through windows: close it, or leave \"phases\" out");
    for (size_t i = 0; i < p->n_sensors; i++)
        if (orl_lit_scene_is_outside(lit_scene, orl_year_place_of(p->year, &p->sensors[i]).point))
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "sensor %zu is outdoors: no window is between it and the sky",
                                 i + 1);
    return 0;
}

static int allocate_matrices(struct matrices *p)
{
    struct orl_phase_matrices *r = p->result;
    bool room = true;
    r->suns = calloc(p->n_sensors * ORL_PHASES_SUNS + 1, sizeof *r->suns);
    p->healths = orl_arrays_new(&p->windows.arrays, orl_thread_pool_size(p->year->env->run->pool),
                                sizeof *p->healths);
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
        code = compute_windows(p);
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
        return orl_error_set(err, code, "too many kinds of BSDF panes for phase matrices");
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
                             "phase matrices are limited to %d sensors, but there are %zu",
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
    orl_arrays_free(&p.windows.arrays);
    orl_bsdf_panes_done(&p.bsdf_panes);
    if (code < 0)
        orl_phase_matrices_done(&matrices);
    else
        *ret_phases = matrices;
    return code;
}

/* View out: what is visible from places through openings, how wide and how far. Computed
 * with rays. */
#include <oriel/annual/view_out.h>

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <oriel/annual/annual.h>
#include <oriel/base/vec.h>

#include "base/statistics/numeric.h"
#include "report/report_internal.h"

enum { COLUMNS = 1440, ROWS = 180, MOST_PANES = 64 };
#define COLUMN_DEG (360.0 / COLUMNS)
static const double own = 1; /* m from the pane: nearer surfaces belong to the window itself */
/* Least horizontal component of the pane's normal; else the pane is a roof light. */
static const double least_slanting = 0.1;

void orl_view_out_request_init(struct orl_view_out_request *view_out_request)
{
    *view_out_request = (struct orl_view_out_request){.above_sensors = NAN};
}

bool orl_view_out_is_requested(const struct orl_view_out_request *view_out_request)
{
    return view_out_request->n_points > 0 || !isnan(view_out_request->above_sensors);
}

static void free_names(char **names, size_t n)
{
    for (size_t i = 0; names && i < n; i++)
        free(names[i]);
    free(names);
}

void orl_view_out_request_done(struct orl_view_out_request *view_out_request)
{
    orl_named_points_free(view_out_request->points, view_out_request->n_points);
    free_names(view_out_request->openings, view_out_request->n_openings);
    free_names(view_out_request->ground, view_out_request->n_ground);
    orl_view_out_request_init(view_out_request);
}

const char *orl_view_level_name(enum orl_view_level level)
{
    static const char *const names[] = {"none", "minimum", "medium", "high"};
    return names[level];
}

/* ---- Levels ---------------------------------------------------------------------------------- */

static enum orl_view_level level_by_layers(unsigned layers)
{
    if (!(layers & ORL_VIEW_LANDSCAPE))
        return ORL_VIEW_NONE;
    return ORL_VIEW_MINIMUM + ((layers & ORL_VIEW_SKY) != 0) + ((layers & ORL_VIEW_GROUND) != 0);
}

static enum orl_view_level level_by_number(double value, const double least[3])
{
    return (value >= least[0]) + (value >= least[1]) + (value >= least[2]);
}

enum orl_view_level orl_view_out_level(const struct orl_view_out *view)
{
    static const double angles[3] = {14, 28, 54}, distances[3] = {6, 20, 50};
    const enum orl_view_level of[3] = {level_by_number(view->sight_angle_deg, angles),
                                       level_by_number(view->distance_m, distances),
                                       level_by_layers(view->layers)};
    const enum orl_view_level lower = of[0] < of[1] ? of[0] : of[1];
    return lower < of[2] ? lower : of[2];
}

/* ---- A ray ----------------------------------------------------------------------------------- */

struct ray_result {
    unsigned char layer; /* 0: no view */
    uint32_t opening;
    float distance_m; /* horizontal distance; INFINITY for sky and ground */
};

/* Returns the horizontal distance along the pane's normal; for roof lights the horizontal distance
 * in any direction. */
static double level_distance(struct orl_vec3 way, struct orl_vec3 outward)
{
    const double slant = hypot(outward.x, outward.y);
    return slant < least_slanting ? hypot(way.x, way.y)
                                  : (way.x * outward.x + way.y * outward.y) / slant;
}

/* State of a ray. */
struct ray_state {
    struct ray_result ray_result;
    bool outside;
    /* Where it passed the opening, and the opening's outward normal. */
    struct orl_vec3 pane, outward;
};

static void pass_opening(struct ray_state *ray_state, const struct orl_openings *o,
                         const struct orl_hit *hit)
{
    const int32_t port = o->scene->port_of_facet[hit->facet];
    ray_state->outside = true;
    ray_state->pane = hit->point;
    ray_state->outward = o->scene->ports[port].outward;
    ray_state->ray_result.opening = o->of_port[port];
}

/* Records an opaque surface that the ray hits outside. */
static void record_surface(struct ray_state *ray_state, const struct orl_openings *o,
                           const struct orl_hit *hit)
{
    const struct orl_vec3 way = orl_sub(hit->point, ray_state->pane);
    if (orl_length(way) < own)
        return;
    const bool ground = orl_openings_is_ground(o, hit->facet) && orl_hit_facing(hit).z > 0;
    ray_state->ray_result.layer = ground ? ORL_VIEW_GROUND : ORL_VIEW_LANDSCAPE;
    ray_state->ray_result.distance_m =
        ground ? INFINITY : (float)fmax(0, level_distance(way, ray_state->outward));
}

/* Handles a surface on the ray; returns false if the ray ends there. */
static bool pass_surface(struct ray_state *ray_state, const struct orl_openings *o,
                         const struct orl_hit *hit)
{
    const bool clear =
        !orl_facet_is_instanced(o->scene->geometry, hit->facet) && o->clear[hit->facet];
    const enum orl_port_crossing crossing =
        clear ? orl_scene_crossing(o->scene, hit) : ORL_CROSSING_NONE;
    if (clear && crossing != ORL_CROSSING_INWARDS) {
        if (crossing == ORL_CROSSING_OUTWARDS && !ray_state->outside)
            pass_opening(ray_state, o, hit);
        return true;
    }
    if (ray_state->outside)
        record_surface(ray_state, o, hit);
    return false;
}

static struct ray_result trace_view_ray(const struct orl_openings *o, struct orl_vec3 origin,
                                        struct orl_vec3 direction)
{
    const struct orl_geometry *geometry = o->scene->geometry;
    struct ray_state ray_state = {.ray_result = {.distance_m = INFINITY}};
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(geometry, origin, direction, INFINITY, &hit)) {
            if (ray_state.outside)
                ray_state.ray_result.layer = direction.z > 0 ? ORL_VIEW_SKY : ORL_VIEW_GROUND;
            return ray_state.ray_result;
        }
        if (!pass_surface(&ray_state, o, &hit))
            return ray_state.ray_result;
        origin = orl_hit_ray_origin(geometry, &hit, direction);
    }
    return ray_state.ray_result;
}

/* ---- Extent of openings ---------------------------------------------------------------------- */

/* Rows of each column that may contain an opening; first > last: none. */
struct extent {
    short first[COLUMNS], last[COLUMNS];
};

static double distance_to_edge(struct orl_vec3 a, struct orl_vec3 b)
{
    const double x = b.x - a.x, y = b.y - a.y, square = x * x + y * y;
    double t = square > 0 ? -(a.x * x + a.y * y) / square : 0;
    t = fmin(1, fmax(0, t));
    return hypot(a.x + t * x, a.y + t * y);
}

static double cross_product_z(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x * b.y - a.y * b.x;
}

static bool is_overhead(const struct orl_vec3 c[3])
{
    const double t[3] = {cross_product_z(c[0], c[1]), cross_product_z(c[1], c[2]),
                         cross_product_z(c[2], c[0])};
    return (t[0] >= 0 && t[1] >= 0 && t[2] >= 0) || (t[0] <= 0 && t[1] <= 0 && t[2] <= 0);
}

static int row_at(double height, double nearest, double farthest, bool upper)
{
    const double distance = (height > 0) == upper ? nearest : farthest;
    const double altitude = atan2(height, distance) / ORL_DEG_TO_RAD;
    return (int)fmin(ROWS - 1, fmax(0, floor(altitude + 90)));
}

static void mark_columns(struct extent *extent, double from, double to, int first, int last)
{
    const int low = (int)floor(from / COLUMN_DEG), high = (int)floor(to / COLUMN_DEG);
    for (int i = low; i <= high && i < low + COLUMNS; i++) {
        const int c = (i % COLUMNS + COLUMNS) % COLUMNS;
        extent->first[c] = (short)(first < extent->first[c] ? first : extent->first[c]);
        extent->last[c] = (short)(last > extent->last[c] ? last : extent->last[c]);
    }
}

/* Marks the columns and rows of a triangle; corners are relative to the eye. A triangle that is not
 * overhead spans less than half of the horizon. */
static void mark_triangle(struct extent *extent, const struct orl_vec3 c[3])
{
    const double nearest = fmin(distance_to_edge(c[0], c[1]),
                                fmin(distance_to_edge(c[1], c[2]), distance_to_edge(c[2], c[0])));
    const double farthest =
        fmax(hypot(c[0].x, c[0].y), fmax(hypot(c[1].x, c[1].y), hypot(c[2].x, c[2].y)));
    const double low = fmin(c[0].z, fmin(c[1].z, c[2].z)),
                 high = fmax(c[0].z, fmax(c[1].z, c[2].z));
    if (is_overhead(c)) {
        mark_columns(extent, 0, 360 - COLUMN_DEG / 2, row_at(low, 0, farthest, false),
                     row_at(high, 0, farthest, true));
        return;
    }
    const double middle = atan2(c[0].y, c[0].x) / ORL_DEG_TO_RAD;
    double from = 0, to = 0;
    for (int i = 1; i < 3; i++) {
        const double beside = remainder(atan2(c[i].y, c[i].x) / ORL_DEG_TO_RAD - middle, 360);
        from = fmin(from, beside);
        to = fmax(to, beside);
    }
    mark_columns(extent, middle + from, middle + to, row_at(low, nearest, farthest, false),
                 row_at(high, nearest, farthest, true));
}

static void find_extent(const struct orl_openings *o, struct orl_vec3 eye, struct extent *extent)
{
    const struct orl_geometry *g = o->scene->geometry;
    for (int c = 0; c < COLUMNS; c++) {
        extent->first[c] = ROWS;
        extent->last[c] = -1;
    }
    for (size_t p = 0; p < o->scene->n_ports; p++) {
        const uint32_t facet = o->scene->ports[p].facet;
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_get_own(g, facet, &room);
        for (uint32_t t = 0; o->clear[facet] && t < f->n_triangles; t++) {
            const struct orl_triangle at = orl_triangle_get(g, orl_facet_triangle(f, t));
            const struct orl_vec3 corners[3] = {orl_sub(at.a, eye), orl_sub(at.b, eye),
                                                orl_sub(at.c, eye)};
            mark_triangle(extent, corners);
        }
    }
}

/* ---- A place --------------------------------------------------------------------------------- */

struct view_out_finder {
    const struct orl_view_out_request *view_out_request;
    const struct orl_sensor *sensors;
    struct orl_openings openings;
    struct scratch *scratch; /* by thread of the pool */
    struct orl_view_out *views;
};

struct scratch {
    struct ray_result ray_result[COLUMNS][ROWS];
    struct extent extent;
    unsigned char *layers; /* by opening; owned */
    double distances[COLUMNS];
};

static void trace_all_directions(const struct orl_openings *o, struct orl_vec3 eye,
                                 struct scratch *s)
{
    find_extent(o, eye, &s->extent);
    for (int c = 0; c < COLUMNS; c++) {
        const double azimuth = (c + 0.5) * COLUMN_DEG * ORL_DEG_TO_RAD;
        for (int r = s->extent.first[c]; r <= s->extent.last[c]; r++) {
            const double altitude = (r + 0.5 - 90) * ORL_DEG_TO_RAD;
            s->ray_result[c][r] = trace_view_ray(
                o, eye,
                orl_v3(cos(altitude) * cos(azimuth), cos(altitude) * sin(azimuth), sin(altitude)));
        }
    }
}

/* Finds the layers of each opening. Where sky adjoins ground, the horizon counts as landscape. */
static void gather_layers(const struct orl_openings *o, struct scratch *s)
{
    memset(s->layers, 0, o->count);
    for (int c = 0; c < COLUMNS; c++)
        for (int r = s->extent.first[c]; r <= s->extent.last[c]; r++) {
            const struct ray_result *ray_result = &s->ray_result[c][r];
            if (ray_result->layer == 0)
                continue;
            s->layers[ray_result->opening] |= ray_result->layer;
            if (ray_result->layer == ORL_VIEW_GROUND && r < s->extent.last[c] &&
                ray_result[1].layer == ORL_VIEW_SKY && ray_result[1].opening == ray_result->opening)
                s->layers[ray_result->opening] |= ORL_VIEW_LANDSCAPE;
        }
}

/* Returns the ray of a column that is nearest to the horizontal and has a view. Of two equally near
 * rays the upper one comes first. */
static const struct ray_result *find_level(const struct scratch *s, int c)
{
    for (int k = 0; k < ROWS; k++) {
        const int r = k % 2 == 0 ? ROWS / 2 + k / 2 : ROWS / 2 - 1 - k / 2;
        const struct ray_result *ray_result = &s->ray_result[c][r];
        if (r >= s->extent.first[c] && r <= s->extent.last[c] && ray_result->layer != 0 &&
            s->layers[ray_result->opening] & ORL_VIEW_LANDSCAPE)
            return ray_result;
    }
    return NULL;
}

static struct orl_view_out measure_view(const struct orl_openings *o, struct scratch *s)
{
    struct orl_view_out view = {0};
    size_t n = 0;
    for (int c = 0; c < COLUMNS; c++) {
        const struct ray_result *ray_result = find_level(s, c);
        if (ray_result)
            s->distances[n++] = ray_result->distance_m;
    }
    for (size_t i = 0; i < o->count; i++)
        if (level_by_layers(s->layers[i]) > level_by_layers(view.layers) || view.layers == 0)
            view.layers = s->layers[i];
    view.sight_angle_deg = (double)n * COLUMN_DEG;
    view.distance_m = n > 0 ? orl_nth_element(s->distances, n, n / 2) : 0;
    view.level = orl_view_out_level(&view);
    return view;
}

static void view_from(void *arg, size_t index, uint32_t member)
{
    const struct view_out_finder *f = arg;
    struct scratch *s = &f->scratch[member];
    struct orl_vec3 at;
    if (index < f->view_out_request->n_points)
        at = f->view_out_request->points[index].at;
    else {
        at = f->sensors[index - f->view_out_request->n_points].position;
        at.z += f->view_out_request->above_sensors;
    }
    trace_all_directions(&f->openings, orl_sub(at, f->openings.scene->geometry->center), s);
    gather_layers(&f->openings, s);
    f->views[index] = measure_view(&f->openings, s);
}

/* ---- All of them ----------------------------------------------------------------------------- */

static int find_all(struct view_out_finder *f, size_t n, const struct orl_run_env *env,
                    struct orl_error *err)
{
    const uint32_t members = orl_thread_pool_size(env->pool);
    int code = 0;
    f->scratch = calloc(members, sizeof *f->scratch);
    for (uint32_t i = 0; f->scratch && i < members && code == 0; i++) {
        f->scratch[i].layers = calloc(f->openings.count + 1, 1);
        code = f->scratch[i].layers ? 0 : ORL_ERR_NOMEM;
    }
    if (!f->scratch || code < 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    if (code == 0 && orl_parallel_try(env->pool, n, view_from, f) < 0)
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    orl_thread_pool_set_cancel(env->pool, NULL);
    for (uint32_t i = 0; f->scratch && i < members; i++)
        free(f->scratch[i].layers);
    free(f->scratch);
    return code;
}

size_t orl_view_out_count(const struct orl_view_out_request *view_out_request,
                          const struct orl_annual_request *request)
{
    return view_out_request->n_points +
           (isnan(view_out_request->above_sensors) ? 0 : request->n_sensors);
}

int orl_view_out_compute(const struct orl_view_out_request *view_out_request,
                         const struct orl_annual_request *request, const struct orl_run_env *env,
                         struct orl_view_out *ret_views, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    struct view_out_finder view_out_finder = {
        .view_out_request = view_out_request, .sensors = request->sensors, .views = ret_views};
    const size_t n = orl_view_out_count(view_out_request, request);
    if (n > ORL_VIEW_OUT_MOST_POINTS)
        return orl_error_set(err, ORL_ERR_LIMIT, "the view out has %zu points, but the limit is %d",
                             n, ORL_VIEW_OUT_MOST_POINTS);
    int code = orl_unshaded_scene_load(request, env, &scene, err);
    if (code == 0)
        code =
            orl_openings_find(view_out_request, scene, env->cancel, &view_out_finder.openings, err);
    if (code == 0)
        code = find_all(&view_out_finder, n, env, err);
    orl_openings_done(&view_out_finder.openings);
    orl_scene_release(scene);
    return code;
}

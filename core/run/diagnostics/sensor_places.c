/*
 * Checks of the places of sensors: in the plane of a surface, in a solid, outdoors, in another
 * room, or below a floor.
 */
#include "run/diagnostics/diagnostics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "light/enclosures.h"
#include "scene/built/scene.h"
#include "scene/geometry/geometry.h"
#include "scene/geometry/instances.h"

/* Finds sensors in the plane of a surface that they do not face, such as a wall for a sensor that
 * looks up: rounding decides on which side of it they lie. */

/* Distance from a surface at which a sensor is clear of it, in units of the geometry's
 * resolution. */
static const double clear_of_surfaces = 10;
/* A sensor that faces a surface by more than this cosine is moved off it (orl_offset_from_surface).
 */
static const double faces_from = 0.25;

/* Tests for a surface along a direction, from one resolution behind the point to one ahead of
 * it. */
static bool touches_along(const struct orl_geometry *g, struct orl_vec3 point,
                          struct orl_vec3 normal, struct orl_vec3 direction,
                          struct orl_surface_contact *ret_touch)
{
    const double span = orl_geometry_resolution(g);
    struct orl_hit hit;
    if (!orl_geometry_intersect(g, orl_madd(point, direction, -span), direction, 2 * span, &hit) ||
        fabs(orl_dot(hit.normal, normal)) > faces_from)
        return false;
    const double height = fabs(orl_dot(orl_sub(hit.point, point), hit.normal));
    *ret_touch = (struct orl_surface_contact){hit.facet, height};
    return height <= span;
}

/* Returns true if a surface contains the sensor. Two orthogonal directions suffice for planes of
 * any orientation. */
static bool lies_in_plane(const struct orl_geometry *g, const struct orl_sensor *sensor,
                          struct orl_surface_contact *ret_touch)
{
    const struct orl_vec3 normal = orl_normalize(sensor->direction);
    const struct orl_vec3 point =
        orl_offset_from_surface(g, orl_sub(sensor->position, g->center), normal);
    const struct orl_frame frame = orl_frame_about(normal);
    return touches_along(g, point, normal, frame.u, ret_touch) ||
           touches_along(g, point, normal, frame.v, ret_touch);
}

static bool orl_run_lies_in_plane(const struct orl_scene *scene, const struct orl_sensor *sensor)
{
    struct orl_surface_contact touch;
    return lies_in_plane(scene->geometry, sensor, &touch);
}

bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_thread_pool *pool, char *ret_text,
                                        size_t size)
{
    enum { POLL = 1024 };
    const struct orl_geometry *g = scene->geometry;
    struct orl_surface_contact touch = {0}, first = {0};
    size_t count = 0, first_index = 0;
    for (size_t i = 0; i < n; i++) {
        if (i % POLL == 0 && orl_thread_pool_cancelled(pool))
            return false;
        if (!lies_in_plane(g, &sensors[i], &touch) || count++ > 0)
            continue;
        first = touch;
        first_index = i;
    }
    if (count == 0)
        return false;
    const struct orl_surface_label label = orl_scene_label_of(scene, first.facet);
    const struct orl_vec3 at = sensors[first_index].position;
    snprintf(ret_text, size,
             "%zu of %zu sensors: the sensor lies in the plane of a surface; the first, number %zu "
             "at (%.6g, %.6g, %.6g), %.2g m from '%.100s' (%.100s:%d): the side it measures is "
             "random; move it at least %.1g m away from the surface",
             count, n, first_index + 1, at.x, at.y, at.z, first.distance, label.name, label.file,
             label.line, clear_of_surfaces * orl_geometry_resolution(g));
    return true;
}

/* Finds sensors in another space than most of their grid: outdoors, in a solid, a wall or another
 * room. Also finds sensors below the floor of a room, even if their whole grid is. */

enum { LEAST_SENSORS = 3, CHUNK = 256 };
/* Divisors of a range's sensors: up to a tenth in a space without windows, and a twentieth in
 * another room, are taken as mistakes. */
enum { SHARE_IN_SOLIDS = 10, SHARE_IN_ROOMS = 20 };
/* Ratio of the ceiling's distance to that of a floor overhead. */
static const double much_nearer = 4;

/* Limits of rays for a job's searches, and additional ones for each range and sensor. The
 * additional rays suffice to check ranges within one room, whatever others have used. */
enum { RAYS_OF_A_JOB = 4000000, RAYS_OF_A_RANGE = 4096, RAYS_OF_A_SENSOR = 16 };

/* A facet may be the floor of a closed room with windows. */
enum floor { FLOOR_UNKNOWN, IS_FLOOR, IS_NO_FLOOR };

enum misplacement {
    IN_PLACE,
    OUTDOORS,
    IN_SOLID,
    IN_OTHER_ROOM,
    BELOW_FLOOR,
    MISPLACEMENTS,
};

struct check {
    struct orl_sensor_check *job;
    const struct orl_scene *scene;
    struct orl_ray_budget budget;
    uint8_t *floors; /* by facet, including placed ones: enum floor; NULL until needed */
    bool *unchecked; /* by range: true if its check has reached the limit of rays */
    size_t n_warned;
    /* The fields below belong to the range that is checked now. */
    const struct orl_sensor_range *range;
    const struct orl_sensor *sensors;
    struct orl_query_point *places;
    struct orl_enclosures *enclosures;
    uint8_t *kinds; /* by sensor: enum misplacement */
};

/* ---- Warnings -------------------------------------------------------------------------------- */

/* Adds "3, 7-12 and 5 more" to the text: sensors of one kind, numbered from 1. */
static void list_numbers(const struct check *c, enum misplacement kind, char *text, size_t size)
{
    enum { MOST_RANGES = 8 };
    size_t at = 0, ranges = 0, more = 0;
    for (size_t i = 0; i < c->range->count; i++) {
        if (c->kinds[i] != kind)
            continue;
        size_t end = i;
        while (end + 1 < c->range->count && c->kinds[end + 1] == kind)
            end++;
        if (ranges++ < MOST_RANGES && at < size)
            at += (size_t)snprintf(text + at, size - at, end > i ? "%s%zu-%zu" : "%s%zu",
                                   ranges > 1 ? ", " : "", i + 1, end + 1);
        else
            more += end + 1 - i;
        i = end;
    }
    if (more > 0 && at < size)
        snprintf(text + at, size - at, " and %zu more", more);
}

/* Finds the surface between a sensor and those in place, or the one above a sensor. */
static bool find_surface(const struct check *c, enum misplacement kind, size_t index,
                         struct orl_hit *ret_hit)
{
    const struct orl_geometry *g = c->scene->geometry;
    const struct orl_enclosures *e = c->enclosures;
    const struct orl_vec3 point = c->places[index].point;
    if (kind == BELOW_FLOOR)
        return orl_geometry_intersect(g, point, orl_v3(0, 0, 1), INFINITY, ret_hit);
    return orl_enclosures_separator(c->scene, c->places[e->at[e->largest].first].point, point,
                                    ret_hit);
}

static void describe_surface(const struct check *c, enum misplacement kind, size_t index,
                             char *text, size_t size)
{
    struct orl_hit hit;
    text[0] = '\0';
    if (!find_surface(c, kind, index, &hit))
        return;
    const struct orl_surface_label label = orl_scene_label_of(c->scene, hit.facet);
    snprintf(text, size, " behind '%.80s' (%.80s:%d)", label.name, label.file, label.line);
}

static void emit_warning(struct check *c, const char *text)
{
    enum { MOST = 20 };
    if (c->n_warned++ < MOST)
        c->job->warn(c->job->ctx, text);
    else if (c->n_warned == MOST + 1)
        c->job->warn(c->job->ctx,
                     "more grids have sensors outdoors, in solids, in other rooms or below "
                     "floors: they are not listed");
}

static void describe_misplaced(struct check *c, enum misplacement kind)
{
    static const char in_solid[] =
        "in closed spaces without windows, such as a solid or a wall, and the others do not";
    static const char *const where[MISPLACEMENTS] = {
        [OUTDOORS] = "outdoors, and the others in a closed space",
        [IN_SOLID] = in_solid,
        [IN_OTHER_ROOM] = "in a different closed space from the others",
        [BELOW_FLOOR] = "just below the floor of a room"};
    char numbers[160] = "", surface[224], text[800];
    size_t count = 0, first = 0;
    for (size_t i = 0; i < c->range->count; i++)
        if (c->kinds[i] == kind && count++ == 0)
            first = i;
    if (count == 0)
        return;
    const struct orl_vec3 at = c->sensors[first].position;
    list_numbers(c, kind, numbers, sizeof numbers);
    describe_surface(c, kind, first, surface, sizeof surface);
    snprintf(text, sizeof text,
             "%s%.100s%s%zu of %zu sensors %s %s: number%s %s (from 1), the first at (%.6g, %.6g, "
             "%.6g)%s: move them%s",
             c->range->name ? "grid '" : "", c->range->name ? c->range->name : "",
             c->range->name ? "': " : "", count, c->range->count, count > 1 ? "lie" : "lies",
             where[kind], count > 1 ? "s" : "", numbers, at.x, at.y, at.z, surface,
             kind == BELOW_FLOOR ? " above it" : ", or give them a grid of their own");
    emit_warning(c, text);
}

/* Issues one warning for all ranges whose check has reached the limit of rays. */
static void describe_unchecked(const struct check *c)
{
    enum { MOST_NAMES = 5 };
    char names[640] = "", text[960];
    size_t at = 0, count = 0;
    for (size_t i = 0; i < c->job->n_ranges; i++) {
        const char *const name = c->job->ranges[i].name;
        if (c->unchecked[i] && count++ < MOST_NAMES && name)
            at += (size_t)snprintf(names + at, sizeof names - at, "%s'%.100s'",
                                   count > 1 ? ", " : "", name);
    }
    if (count == 0)
        return;
    if (count > MOST_NAMES)
        snprintf(names + at, sizeof names - at, " and %zu more", count - MOST_NAMES);
    snprintf(text, sizeof text,
             "not all sensors are checked for positions outdoors, in solids, in other rooms or "
             "below floors%s%s: many closed spaces used up the ray limit of this check; split the "
             "job to check them",
             at > 0 ? " in the grids " : "", names);
    c->job->warn(c->job->ctx, text);
}

/* ---- Sensors apart from their grid ----------------------------------------------------------- */

/* Classifies a space. In an open building being outdoors is no mistake. */
static enum misplacement kind_of(const struct orl_enclosure *e, const struct orl_enclosure *most,
                                 size_t n)
{
    if (e->escaped > 0)
        return orl_enclosure_is_open(most) ? IN_PLACE : OUTDOORS;
    if (e->windows == 0)
        return e->count == 1 || SHARE_IN_SOLIDS * e->count <= n ? IN_SOLID : IN_PLACE;
    return e->count == 1 || SHARE_IN_ROOMS * e->count <= n ? IN_OTHER_ROOM : IN_PLACE;
}

static void classify_spaces(const struct check *c)
{
    const struct orl_enclosures *e = c->enclosures;
    const struct orl_enclosure *most = &e->at[e->largest];
    const size_t n = c->range->count;
    if (n < LEAST_SENSORS || 2 * most->count < n)
        return;
    for (size_t i = 0; i < n; i++) {
        const uint8_t of = e->of[i];
        if (of != ORL_ENCLOSURE_UNKNOWN && of != e->largest)
            c->kinds[i] = (uint8_t)kind_of(&e->at[of], most, n);
    }
}

/* ---- Grids below a floor --------------------------------------------------------------------- */

static size_t count_facets(const struct orl_geometry *g)
{
    const struct orl_instance *const last =
        g->n_instances > 0 ? &g->instance[g->n_instances - 1] : NULL;
    return last ? last->first_facet + last->prototype->n_facets : g->n_facets;
}

/* Sets *ret_floor if the facet, met from above, is the floor of a closed room with windows. The
 * space above a facet is explored once. */
static int look_up_floor(struct check *c, const struct orl_hit *hit,
                         const struct orl_query_point *above, bool *ret_floor)
{
    if (!c->floors)
        c->floors = calloc(count_facets(c->scene->geometry) + 1, sizeof *c->floors);
    if (!c->floors)
        return ORL_ERR_NOMEM;
    uint8_t *const floor = &c->floors[hit->facet];
    if (*floor == FLOOR_UNKNOWN) {
        struct orl_enclosure space;
        const int code = orl_enclosure_explore(c->scene, above, &c->budget, &space);
        if (code < 0)
            return code;
        *floor = space.windows > 0 && !orl_enclosure_is_open(&space) ? IS_FLOOR : IS_NO_FLOOR;
    }
    *ret_floor = *floor == IS_FLOOR;
    return 0;
}

/* Sets *ret_below if the surface overhead is a floor, and much nearer than the ceiling above it. */
static int is_below_floor(struct check *c, const struct orl_query_point *place, bool *ret_below)
{
    const struct orl_geometry *g = c->scene->geometry;
    const struct orl_vec3 up = orl_v3(0, 0, 1);
    struct orl_hit hit, ceiling;
    *ret_below = false;
    if (!orl_geometry_intersect(g, place->point, up, INFINITY, &hit) ||
        orl_material_is_window(orl_scene_material(c->scene, hit.facet)))
        return 0;
    const struct orl_query_point above = {orl_hit_ray_origin(g, &hit, up), up};
    if (!orl_geometry_intersect(g, above.point, up, INFINITY, &ceiling) ||
        !(much_nearer * hit.distance < ceiling.distance))
        return 0;
    return look_up_floor(c, &hit, &above, ret_below);
}

/* Classifies the sensors of a range whose largest space is outdoors as below a floor or not. */
static int classify_below(struct check *c)
{
    const struct orl_enclosures *e = c->enclosures;
    if (e->at[e->largest].escaped == 0)
        return 0;
    for (size_t i = 0; i < c->range->count; i++) {
        bool below;
        if (i % CHUNK == 0 && orl_thread_pool_cancelled(c->job->pool))
            return ORL_ERR_CANCELLED;
        if (c->kinds[i] != IN_PLACE || e->of[i] == ORL_ENCLOSURE_UNKNOWN ||
            e->at[e->of[i]].escaped == 0)
            continue;
        const int code = is_below_floor(c, &c->places[i], &below);
        if (code < 0)
            return code;
        if (below)
            c->kinds[i] = BELOW_FLOOR;
    }
    return 0;
}

/* ---- A range --------------------------------------------------------------------------------- */

/* Finds the places of a chunk of sensors. A sensor in the plane of a surface is on neither side of
 * it, so it belongs to no space. */
static void list_places(void *arg, size_t chunk, uint32_t member)
{
    struct check *const c = arg;
    const struct orl_geometry *g = c->scene->geometry;
    const size_t first = chunk * CHUNK, left = c->range->count - first;
    (void)member;
    for (size_t i = first; i < first + (left < CHUNK ? left : CHUNK); i++) {
        const struct orl_vec3 normal = orl_normalize(c->sensors[i].direction);
        const struct orl_vec3 point = orl_sub(c->sensors[i].position, g->center);
        c->places[i] = (struct orl_query_point){orl_offset_from_surface(g, point, normal), normal};
        if (orl_run_lies_in_plane(c->scene, &c->sensors[i]))
            c->places[i].normal = orl_v3(0, 0, 0);
    }
}

static int classify_range(struct check *c)
{
    const size_t n = c->range->count;
    int code = orl_parallel_try(c->job->pool, (n + CHUNK - 1) / CHUNK, list_places, c);
    if (code == 0)
        code = orl_enclosures_new(c->scene, c->places, n, &c->budget, &c->enclosures);
    if (code < 0)
        return code;
    classify_spaces(c);
    code = classify_below(c);
    for (int kind = IN_PLACE + 1; kind < MISPLACEMENTS && (code == 0 || code == ORL_ERR_LIMIT);
         kind++)
        describe_misplaced(c, (enum misplacement)kind);
    return code;
}

static int check_range(struct check *c, size_t index)
{
    const size_t n = c->job->ranges[index].count;
    int code = ORL_ERR_NOMEM;
    c->range = &c->job->ranges[index];
    c->sensors = c->job->sensors + c->range->first;
    c->places = malloc((n + 1) * sizeof *c->places);
    c->kinds = calloc(n + 1, sizeof *c->kinds);
    c->budget.left += RAYS_OF_A_RANGE + RAYS_OF_A_SENSOR * (uint64_t)n;
    if (c->places && c->kinds)
        code = n > 0 ? classify_range(c) : 0;
    orl_enclosures_free(c->enclosures);
    free(c->places);
    free(c->kinds);
    c->enclosures = NULL;
    c->unchecked[index] = code == ORL_ERR_LIMIT;
    return code == ORL_ERR_LIMIT ? 0 : code;
}

int orl_run_check_sensor_spaces(struct orl_sensor_check *check)
{
    struct check c = {.job = check,
                      .scene = check->scene,
                      .budget = {.pool = check->pool,
                                 .left = check->most_rays > 0 ? check->most_rays : RAYS_OF_A_JOB},
                      .unchecked = calloc(check->n_ranges + 1, sizeof *c.unchecked)};
    int code = c.unchecked ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < check->n_ranges && code == 0; i++)
        code = check_range(&c, i);
    if (code == 0)
        describe_unchecked(&c);
    check->rays = c.budget.traced;
    free(c.unchecked);
    free(c.floors);
    return code;
}

/* Sensors in another space than most of their grid: outdoors, in a solid, a wall or another room;
 * and sensors that lie below the floor of a room, though their whole grid may. */
#include <stdio.h>
#include <stdlib.h>

#include "light/enclosures.h"
#include "run/stages.h"
#include "scene/geometry/stand.h"

enum { LEAST_SENSORS = 3 };
/* A tenth of the sensors in a space without windows, a twentieth in a room: more are on purpose. */
enum { SHARE_IN_SOLIDS = 10, SHARE_IN_ROOMS = 20 };
/* A floor so many times nearer overhead than the ceiling above it. */
static const double much_nearer = 4;

enum misplacement {
    IN_PLACE,
    OUTDOORS,
    IN_SOLID,
    IN_OTHER_ROOM,
    BELOW_FLOOR,
    MISPLACEMENTS,
};

struct check {
    const struct orl_scene *scene;
    const struct orl_sensor_range *range;
    const struct orl_sensor *sensors; /* of the range */
    struct orl_outlook *places;
    struct orl_enclosures *enclosures;
    uint8_t *kinds; /* of each sensor: enum misplacement */
    struct orl_sensor_warnings *out;
};

/* ---- Words ----------------------------------------------------------------------------------- */

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

/* The surface between a sensor and those in place, or the one above a sensor. */
static bool find_surface(const struct check *c, enum misplacement kind, size_t index,
                         struct orl_hit *ret_hit)
{
    const struct orl_geometry *g = c->scene->geometry;
    const struct orl_enclosures *e = c->enclosures;
    const struct orl_vec3 point = c->places[index].point;
    if (kind == BELOW_FLOOR)
        return orl_geometry_intersect(g, point, orl_v3(0, 0, 1), INFINITY, ret_hit);
    return orl_enclosures_between(c->scene, c->places[e->at[e->largest].first].point, point,
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

static void emit(struct orl_sensor_warnings *out, const char *text)
{
    enum { MOST = 20 };
    if (out->count++ < MOST)
        out->warn(out->ctx, text);
    else if (out->count == MOST + 1)
        out->warn(out->ctx, "more grids have sensors outdoors, in solids, in other rooms or below "
                            "floors: they are not listed");
}

static void describe(const struct check *c, enum misplacement kind)
{
    static const char in_solid[] = "in closed spaces without windows, as within a solid or a wall, "
                                   "and the others do not";
    static const char *const where[MISPLACEMENTS] = {
        [OUTDOORS] = "outdoors, and the others in a closed space",
        [IN_SOLID] = in_solid,
        [IN_OTHER_ROOM] = "in another closed space than the others",
        [BELOW_FLOOR] = "closely below the floor of a room"};
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
    emit(c->out, text);
}

/* ---- Sensors apart from their grid ----------------------------------------------------------- */

/* Open buildings tell nothing of who is outdoors. */
static enum misplacement kind_of(const struct orl_enclosure *e, const struct orl_enclosure *most,
                                 size_t n)
{
    if (e->escaped > 0)
        return orl_enclosure_is_open(most) ? IN_PLACE : OUTDOORS;
    if (e->windows == 0)
        return e->count == 1 || SHARE_IN_SOLIDS * e->count <= n ? IN_SOLID : IN_PLACE;
    return e->count == 1 || SHARE_IN_ROOMS * e->count <= n ? IN_OTHER_ROOM : IN_PLACE;
}

static void sort_apart(const struct check *c)
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

/* Whether the surface that is met overhead is the floor of a closed room with windows, and how far
 * its ceiling is. */
static bool is_floor(const struct orl_scene *scene, const struct orl_hit *hit, double *ret_height)
{
    const struct orl_vec3 up = orl_v3(0, 0, 1);
    const struct orl_outlook above = {orl_hit_leave(scene->geometry, hit, up), up};
    struct orl_enclosure space;
    struct orl_hit ceiling;
    if (orl_material_is_window(orl_scene_material(scene, hit->facet)) ||
        !orl_geometry_intersect(scene->geometry, above.point, up, INFINITY, &ceiling))
        return false;
    *ret_height = ceiling.distance;
    orl_enclosure_explore(scene, &above, &space);
    return space.windows > 0 && !orl_enclosure_is_open(&space);
}

/* A grid that is outdoors as a whole. */
static void sort_below(const struct check *c)
{
    const struct orl_enclosures *e = c->enclosures;
    uint32_t known = UINT32_MAX;
    bool floor = false;
    double height = 0;
    if (e->at[e->largest].escaped == 0)
        return;
    for (size_t i = 0; i < c->range->count; i++) {
        struct orl_hit hit;
        if (c->kinds[i] != IN_PLACE || e->of[i] == ORL_ENCLOSURE_UNKNOWN ||
            e->at[e->of[i]].escaped == 0 ||
            !orl_geometry_intersect(c->scene->geometry, c->places[i].point, orl_v3(0, 0, 1),
                                    INFINITY, &hit))
            continue;
        if (hit.facet != known) {
            known = hit.facet;
            floor = is_floor(c->scene, &hit, &height);
        }
        if (floor && much_nearer * hit.distance < height)
            c->kinds[i] = BELOW_FLOOR;
    }
}

/* ---- A range --------------------------------------------------------------------------------- */

/* Those in the plane of a surface are on no side of it, and count for no space. */
static void list_places(const struct check *c)
{
    const struct orl_geometry *g = c->scene->geometry;
    for (size_t i = 0; i < c->range->count; i++) {
        const struct orl_vec3 normal = orl_normalize(c->sensors[i].direction);
        const struct orl_vec3 point = orl_sub(c->sensors[i].position, g->center);
        c->places[i] = (struct orl_outlook){orl_stand(g, point, normal), normal};
        if (orl_run_lies_in_plane(c->scene, &c->sensors[i]))
            c->places[i].normal = orl_v3(0, 0, 0);
    }
}

void orl_run_check_sensor_spaces(const struct orl_scene *scene, const struct orl_sensor *sensors,
                                 const struct orl_sensor_range *range, const struct orl_crew *crew,
                                 struct orl_sensor_warnings *warnings)
{
    const size_t n = range->count;
    struct orl_outlook *const places = malloc((n + 1) * sizeof *places);
    uint8_t *const kinds = calloc(n + 1, sizeof *kinds);
    struct check c = {.scene = scene,
                      .range = range,
                      .sensors = sensors + range->first,
                      .places = places,
                      .kinds = kinds,
                      .out = warnings};
    if (places && kinds && n > 0) {
        list_places(&c);
        if (orl_enclosures_new(scene, c.places, n, crew, &c.enclosures) == 0) {
            sort_apart(&c);
            sort_below(&c);
            for (int kind = IN_PLACE + 1; kind < MISPLACEMENTS; kind++)
                describe(&c, (enum misplacement)kind);
        }
    }
    orl_enclosures_free(c.enclosures);
    free(places);
    free(kinds);
}

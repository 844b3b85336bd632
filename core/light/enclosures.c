#include "light/enclosures.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/material/scatter.h"

enum { BOUNCES = 16, PATHS_OF_A_PLACE = 4, PATHS_OF_A_SPACE = 32, MOST_PANES = 8 };

struct search {
    const struct orl_scene *scene;
    struct orl_enclosures *found;
    struct orl_ray_budget *budget;
    struct orl_random random;
};

static int budget_error(const struct orl_ray_budget *budget)
{
    if (budget->cancelled)
        return ORL_ERR_CANCELLED;
    return budget->left == 0 ? ORL_ERR_LIMIT : 0;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

/* Returns true if a hit does not separate spaces: it is an indoor pane. */
static bool is_indoor_pane(const struct orl_scene *scene, const struct orl_hit *hit)
{
    return orl_material_is_window(orl_scene_material(scene, hit->facet)) &&
           orl_scene_crossing(scene, hit) == ORL_CROSSING_NONE;
}

bool orl_enclosures_separator(const struct orl_scene *scene, struct orl_vec3 from,
                              struct orl_vec3 to, struct orl_hit *ret_hit)
{
    const struct orl_geometry *g = scene->geometry;
    for (int pane = 0; pane < MOST_PANES; pane++) {
        const struct orl_vec3 line = orl_sub(to, from);
        const double length = orl_length(line);
        if (!(length > 0))
            return false;
        const struct orl_vec3 direction = orl_scale(line, 1 / length);
        if (!orl_geometry_intersect(g, from, direction, length, ret_hit))
            return false;
        if (!is_indoor_pane(scene, ret_hit))
            return true;
        from = orl_hit_ray_origin(g, ret_hit, direction);
        if (!(orl_dot(orl_sub(to, from), direction) > 0))
            return false;
    }
    return true;
}

static bool is_connected(struct search *s, struct orl_vec3 from, struct orl_vec3 to)
{
    struct orl_hit hit;
    return orl_ray_budget_take(s->budget) && !orl_enclosures_separator(s->scene, from, to, &hit);
}

/* ---- Paths ----------------------------------------------------------------------------------- */

struct path {
    struct orl_vec3 point, direction;
};

static struct path path_from(const struct orl_query_point *place, struct orl_random *random)
{
    const double u = orl_random_uniform(random), v = orl_random_uniform(random);
    return (struct path){place->point, orl_hemisphere_about(place->normal, u, v)};
}

/* Traces one ray of a diffuse path, and counts it in the enclosure. Returns false if the path
 * leaves the scene, or no ray is left. */
static bool advance_path(struct search *s, struct path *path, struct orl_enclosure *enclosure)
{
    const struct orl_scene *scene = s->scene;
    struct orl_hit hit;
    if (!orl_ray_budget_take(s->budget))
        return false;
    enclosure->rays++;
    if (!orl_geometry_intersect(scene->geometry, path->point, path->direction, INFINITY, &hit)) {
        enclosure->escaped++;
        return false;
    }
    enclosure->windows += orl_scene_crossing(scene, &hit) == ORL_CROSSING_OUTWARDS;
    if (!is_indoor_pane(scene, &hit)) {
        const double u = orl_random_uniform(&s->random), v = orl_random_uniform(&s->random);
        path->direction = orl_hemisphere_about(orl_hit_facing(&hit), u, v);
    }
    path->point = orl_hit_ray_origin(scene->geometry, &hit, path->direction);
    return true;
}

/* Adds a point. If the list is full, it replaces a random one of the second half. */
static void add_point(struct orl_enclosure *e, struct orl_vec3 point, struct orl_random *random)
{
    const size_t half = ORL_ENCLOSURE_POINTS / 2;
    if (e->n_points < ORL_ENCLOSURE_POINTS)
        e->points[e->n_points++] = point;
    else
        e->points[half + (size_t)(orl_random_uniform(random) * (double)half)] = point;
}

static void explore_space(struct search *s, const struct orl_query_point *place,
                          struct orl_enclosure *enclosure)
{
    for (int i = 0; i < PATHS_OF_A_SPACE; i++) {
        struct path path = path_from(place, &s->random);
        for (int bounce = 0; bounce < BOUNCES; bounce++) {
            if (!advance_path(s, &path, enclosure))
                break;
            add_point(enclosure, path.point, &s->random);
        }
    }
}

int orl_enclosure_explore(const struct orl_scene *scene, const struct orl_query_point *place,
                          struct orl_ray_budget *budget, struct orl_enclosure *ret_enclosure)
{
    struct search s = {
        .scene = scene, .budget = budget, .random = orl_random_stream(3, ORL_PURPOSE_PILOT, 0)};
    *ret_enclosure = (struct orl_enclosure){.count = 0};
    explore_space(&s, place, ret_enclosure);
    return budget_error(budget);
}

/* ---- Places ---------------------------------------------------------------------------------- */

static bool is_in_sight(struct search *s, const struct orl_enclosure *e, struct orl_vec3 point)
{
    if (is_connected(s, point, e->last))
        return true;
    for (size_t i = 0; i < e->n_points; i++)
        if (is_connected(s, point, e->points[i]))
            return true;
    return false;
}

/* Returns true if the point is connected to the space's last place, or to one of a few random
 * points of it. */
static bool is_near(struct search *s, const struct orl_enclosure *e, struct orl_vec3 point)
{
    enum { TRIES = 3 };
    if (is_connected(s, point, e->last))
        return true;
    for (int i = 0; i < TRIES && e->n_points > 0; i++) {
        const double u = orl_random_uniform(&s->random);
        if (is_connected(s, point, e->points[(size_t)(u * (double)e->n_points)]))
            return true;
    }
    return false;
}

/* Follows paths from the place until a point on one is connected to a known space with an index
 * from `first` up to `end`. Returns the index, or `end`. */
static size_t search_by_paths(struct search *s, const struct orl_query_point *place, int n_paths,
                              size_t first, size_t end)
{
    struct orl_enclosure unused = {.count = 0};
    for (int i = 0; i < n_paths; i++) {
        struct path path = path_from(place, &s->random);
        for (int bounce = 0; bounce < BOUNCES; bounce++) {
            if (!advance_path(s, &path, &unused))
                break;
            for (size_t k = first; k < end; k++)
                if (is_near(s, &s->found->at[k], path.point)) {
                    add_point(&s->found->at[k], path.point, &s->random);
                    return k;
                }
        }
    }
    return end;
}

static size_t find_space(struct search *s, const struct orl_query_point *place, size_t before)
{
    struct orl_enclosures *found = s->found;
    if (before < found->n && is_in_sight(s, &found->at[before], place->point))
        return before;
    for (size_t k = 0; k < found->n; k++)
        if (k != before && is_in_sight(s, &found->at[k], place->point))
            return k;
    return search_by_paths(s, place, PATHS_OF_A_PLACE, 0, found->n);
}

static size_t add_space(struct search *s, const struct orl_query_point *place, size_t index)
{
    struct orl_enclosure *e = &s->found->at[s->found->n];
    *e = (struct orl_enclosure){.first = index, .last = place->point};
    explore_space(s, place, e);
    return s->found->n++;
}

static int sort_places(struct search *s, const struct orl_query_point *places, size_t n)
{
    size_t before = 0;
    for (size_t i = 0; i < n && s->budget->left > 0; i++) {
        s->found->of[i] = ORL_ENCLOSURE_UNKNOWN;
        if (!(orl_dot(places[i].normal, places[i].normal) > 0))
            continue;
        size_t space = find_space(s, &places[i], before);
        if (space == s->found->n) {
            if (space == ORL_ENCLOSURES)
                continue;
            space = add_space(s, &places[i], i);
        }
        s->found->of[i] = (uint8_t)space;
        s->found->at[space].count++;
        s->found->at[space].last = places[i].point;
        before = space;
    }
    return budget_error(s->budget);
}

/* ---- Spaces ---------------------------------------------------------------------------------- */

static size_t largest_of(const struct orl_enclosures *found)
{
    size_t largest = 0;
    for (size_t k = 1; k < found->n; k++)
        if (found->at[k].count > found->at[largest].count)
            largest = k;
    return largest;
}

static void join_spaces(struct orl_enclosures *found, size_t part, size_t whole, size_t n_places)
{
    found->at[whole].count += found->at[part].count;
    found->at[part].count = 0;
    for (size_t i = 0; i < n_places; i++)
        if (found->of[i] == part)
            found->of[i] = (uint8_t)whole;
}

/* Joins spaces to the largest, after a search with more paths: the few paths before may have
 * missed a door. */
static int join_largest(struct search *s, const struct orl_query_point *places, size_t n)
{
    struct orl_enclosures *found = s->found;
    const size_t main = found->largest = largest_of(found);
    struct orl_enclosure *const e = &found->at[main];
    for (size_t k = 0; k < found->n; k++) {
        if (k == main || found->at[k].count == 0)
            continue;
        if (search_by_paths(s, &places[found->at[k].first], PATHS_OF_A_SPACE, main, main + 1) ==
                main ||
            search_by_paths(s, &places[e->first], PATHS_OF_A_SPACE, k, k + 1) == k)
            join_spaces(found, k, main, n);
    }
    return budget_error(s->budget);
}

int orl_enclosures_new(const struct orl_scene *scene, const struct orl_query_point *places,
                       size_t n_places, struct orl_ray_budget *budget,
                       struct orl_enclosures **ret_enclosures)
{
    struct search s = {.scene = scene,
                       .found = calloc(1, sizeof *s.found),
                       .budget = budget,
                       .random = orl_random_stream(3, ORL_PURPOSE_PILOT, 1)};
    int code = ORL_ERR_NOMEM;
    if (s.found)
        s.found->of = malloc(n_places + 1);
    if (s.found && s.found->of)
        code = sort_places(&s, places, n_places);
    if (code == 0)
        code = join_largest(&s, places, n_places);
    if (code < 0) {
        orl_enclosures_free(s.found);
        return code;
    }
    *ret_enclosures = s.found;
    return 0;
}

void orl_enclosures_free(struct orl_enclosures *enclosures)
{
    if (enclosures)
        free(enclosures->of);
    free(enclosures);
}

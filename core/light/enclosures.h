/*
 * Tests of places by paths: whether any light reaches them, and which of them lie in one space.
 *
 * To test whether any light can reach a place at all, paths leave the place, bounce diffusely off
 * all surfaces and pass windows. They look for the open sky (if there is a sky or a sun), and at
 * each bounce test the visibility of a lamp. A place where no path finds light is dark: a room
 * without a window, the inside of a solid or of a wall. 2^14 paths of 64 bounces find a hole of a
 * millionth of a room's surface with a probability above one half.
 *
 * The result depends only on the seed of the paths, not on the number of threads.
 */
#ifndef ORL_LIGHT_ENCLOSURES_H
#define ORL_LIGHT_ENCLOSURES_H

#include "light/lit_scene.h"
#include "scene/built/scene.h"

/* A place where light is searched: on the side of normal, or in all directions if that is zero. */
struct orl_query_point {
    struct orl_vec3 point, normal;
};

/*
 * Returns true as soon as one of the paths has found light; paths are distributed over the query
 * points in turn. Also returns true if the pool is cancelled, because the result is then unknown.
 */
bool orl_light_reaches(const struct orl_lit_scene *lit_scene,
                       const struct orl_query_point *query_points, size_t count, size_t paths,
                       struct orl_thread_pool *pool);

/*
 * Enclosures: finds which points lie in one space, and which are separated by surfaces.
 *
 * Two places lie in one space if a chain of straight lines connects them that crosses no surface
 * but indoor panes. Panes to the outside (ports) separate, as walls do. Rays search the chains in
 * three ways: from one place to the next in the list; to points that diffuse paths from the space's
 * places have reached; and from points on such paths of the place itself. Places that are connected
 * by a tiny opening only may be reported as separate.
 *
 * The result depends only on the scene, the places and the budget. Threads: the caller's; nothing
 * is shared.
 */

enum { ORL_ENCLOSURES = 64, ORL_ENCLOSURE_POINTS = 48, ORL_ENCLOSURE_UNKNOWN = 255 };

/* Rays that the searches of one job may trace. A search that uses up the last one has no result. */
struct orl_ray_budget {
    const struct orl_thread_pool
        *pool; /* polled for cancellation, which sets `left` to 0; or NULL */
    uint64_t left, traced;
    bool cancelled;
};

/* Returns false when no ray is left. */
static inline bool orl_ray_budget_take(struct orl_ray_budget *budget)
{
    enum { POLL = 256 };
    if (budget->left == 0)
        return false;
    budget->left--;
    if (++budget->traced % POLL == 0 && orl_thread_pool_cancelled(budget->pool)) {
        budget->cancelled = true;
        budget->left = 0;
    }
    return true;
}

struct orl_enclosure {
    size_t count;  /* number of places in it */
    size_t first;  /* index of its first place */
    uint64_t rays; /* rays of the paths that explored it */
    /* escaped: rays that met nothing; windows: rays that met a port's inner face */
    uint64_t escaped, windows;
    struct orl_vec3 last;                         /* the last place found in it */
    struct orl_vec3 points[ORL_ENCLOSURE_POINTS]; /* points that paths have reached */
    size_t n_points;
};

struct orl_enclosures {
    struct orl_enclosure at[ORL_ENCLOSURES];
    size_t n;
    size_t largest; /* the one with the most places */
    /* enclosure of each place; ORL_ENCLOSURE_UNKNOWN: left out, or there are too many spaces */
    uint8_t *of;
};

/* Returns true if more than 1 in 500 rays escaped. A space whose rays meet windows and do not
 * escape is a room. */
static inline bool orl_enclosure_is_open(const struct orl_enclosure *enclosure)
{
    return 500 * enclosure->escaped > enclosure->rays;
}

/* Finds the enclosures of places, which are in moved coordinates and clear of surfaces
 * (orl_offset_from_surface). A place without a normal is left out. Returns 0 and enclosures that
 * the caller frees, or ORL_ERR_NOMEM, ORL_ERR_CANCELLED, or ORL_ERR_LIMIT if the budget is used up.
 */
int orl_enclosures_new(const struct orl_scene *scene, const struct orl_query_point *places,
                       size_t n_places, struct orl_ray_budget *budget,
                       struct orl_enclosures **ret_enclosures);
void orl_enclosures_free(struct orl_enclosures *enclosures); /* NULL is allowed */

/* Explores the space around a place by diffuse paths. *ret_enclosure holds only the results of
 * these rays. Returns 0, or ORL_ERR_CANCELLED or ORL_ERR_LIMIT as above. */
int orl_enclosure_explore(const struct orl_scene *scene, const struct orl_query_point *place,
                          struct orl_ray_budget *budget, struct orl_enclosure *ret_enclosure);

/* Finds the first surface on the straight line between two points that separates them. Returns
 * false if there is none. */
bool orl_enclosures_separator(const struct orl_scene *scene, struct orl_vec3 from,
                              struct orl_vec3 to, struct orl_hit *ret_hit);

#endif

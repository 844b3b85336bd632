/*
 * Enclosures: which places lie in one space, and which are separated by surfaces.
 *
 * Two places lie in one space when a chain of straight lines connects them that crosses no surface
 * but panes indoors. Panes to the outside (ports) separate, as walls do. The chains are found by
 * rays: from one place to the next in the list, to points that diffuse paths from the space's
 * places have reached, and from points of such paths of the place's own. Places that are in one
 * space but connected by a tiny opening alone may be reported as separate.
 *
 * The answer depends on the scene, the places and the budget alone. Threads: the caller's; nothing
 * is shared.
 */
#ifndef ORL_LIGHT_ENCLOSURES_H
#define ORL_LIGHT_ENCLOSURES_H

#include "light/reach.h"
#include "light/scene.h"

enum { ORL_ENCLOSURES = 64, ORL_ENCLOSURE_POINTS = 48, ORL_ENCLOSURE_UNKNOWN = 255 };

/* Rays that the searches of one job may trace. A search that uses the last one has no result. */
struct orl_ray_budget {
    const struct orl_crew *crew; /* polled for cancellation, which takes what is left; or NULL */
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
    if (++budget->traced % POLL == 0 && orl_crew_cancelled(budget->crew)) {
        budget->cancelled = true;
        budget->left = 0;
    }
    return true;
}

struct orl_enclosure {
    size_t count;              /* places in it */
    size_t first;              /* the first of them */
    uint64_t rays;             /* of the paths that explored it */
    uint64_t escaped, windows; /* of these, rays that met nothing, or a port's inner face */
    struct orl_vec3 last;      /* the last place found in it */
    struct orl_vec3 points[ORL_ENCLOSURE_POINTS]; /* reached by paths */
    size_t n_points;
};

struct orl_enclosures {
    struct orl_enclosure at[ORL_ENCLOSURES];
    size_t n;
    size_t largest; /* the one with the most places */
    uint8_t *of; /* of each place; ORL_ENCLOSURE_UNKNOWN: left out, or there are too many spaces */
};

/* Windows seen and no way out: a room. A way out for a five-hundredth of the rays: open. */
static inline bool orl_enclosure_is_open(const struct orl_enclosure *enclosure)
{
    return 500 * enclosure->escaped > enclosure->rays;
}

/* Places are in moved coordinates, clear of surfaces (orl_stand); one without a normal is left out.
 * Returns 0 and enclosures that the caller frees, or ORL_ERR_NOMEM, ORL_ERR_CANCELLED, or
 * ORL_ERR_LIMIT when the budget is used up. */
int orl_enclosures_new(const struct orl_scene *scene, const struct orl_outlook *places,
                       size_t n_places, struct orl_ray_budget *budget,
                       struct orl_enclosures **ret_enclosures);
void orl_enclosures_free(struct orl_enclosures *enclosures); /* NULL is allowed */

/* Explores the space that a place lies in, by diffuse paths from there; ret: its rays alone.
 * Returns 0, or ORL_ERR_CANCELLED or ORL_ERR_LIMIT as above. */
int orl_enclosure_explore(const struct orl_scene *scene, const struct orl_outlook *place,
                          struct orl_ray_budget *budget, struct orl_enclosure *ret_enclosure);

/* The first surface on the straight line between two places that separates them. */
bool orl_enclosures_between(const struct orl_scene *scene, struct orl_vec3 from, struct orl_vec3 to,
                            struct orl_hit *ret_hit);

#endif

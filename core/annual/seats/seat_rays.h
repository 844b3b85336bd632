/*
 * Rays of a seat's pixels. They add terms for the sky and for diffuse surfaces, reached through
 * panes, mirrors and lobes. They also add spots on visible surfaces where the sun may fall.
 *
 * At a surface a path may continue in three ways: straight through, mirrored, and in one direction
 * sampled from its lobes. It splits into all of them while the ray may have more paths. Afterwards
 * it takes one, sampled in proportion to what each carries. Paths that carry little, and paths of
 * many steps, end by Russian roulette (Arvo and Kirk 1990, "Particle transport and image
 * synthesis"). So a ray has at most ORL_SEAT_RAY_PATHS paths in any scene, and the estimate is
 * unbiased.
 *
 * Threads: one thread per seat. Random numbers are keyed by seat and pixel.
 */
#ifndef ORL_ANNUAL_SEATS_SEAT_RAYS_H
#define ORL_ANNUAL_SEATS_SEAT_RAYS_H

#include "annual/seats/seat_terms.h"
#include "annual/seats/seat_view.h"

/* Most paths of a ray: in general, and if the pixel sees lobes and has more rays. */
enum { ORL_SEAT_RAY_PATHS = 8, ORL_SEAT_LOBE_PATHS = 4 };

struct orl_seat_rays {
    struct orl_seat_view *view; /* receives places and spots */
    const struct orl_annual_scene *scene;
    struct orl_random random;
    uint32_t pixel;
    double share;                /* share of the pixel that a ray represents */
    uint32_t most_paths;         /* most paths of a ray */
    bool spots;                  /* true if the next ray adds spots */
    bool lobes;                  /* true once a ray has hit lobes */
    struct orl_seat_terms terms; /* terms of the current pixel */
    size_t spots_room;           /* capacity of view->spots */
    uint64_t steps;              /* traced segments */
};

/* Traces a ray from the eye. Returns 0 or ORL_ERR_NOMEM. */
int orl_seat_rays_follow(struct orl_seat_rays *rays, struct orl_vec3 direction);

#endif

/*
 * The rays of a seat's pixels: terms for the sky and the diffuse surfaces that a ray reaches
 * through panes, mirrors and lobes, and spots where the sun may fall on what is seen.
 *
 * At a surface a path goes on in up to three ways: straight through, mirrored, and by one direction
 * drawn from its lobes. It splits into all of them while the ray may have more paths; afterwards it
 * goes one way, chosen at random in proportion to what each carries. Paths that carry little, and
 * those of many steps, end by Russian roulette (Arvo and Kirk 1990, "Particle transport and image
 * synthesis"). So a ray has at most ORL_SEAT_RAY_PATHS paths, whatever the scene, and no light is
 * left out on the average.
 *
 * Threads: one seat, one thread. Random numbers are named by seat and pixel.
 */
#ifndef ORL_ANNUAL_SEAT_RAYS_H
#define ORL_ANNUAL_SEAT_RAYS_H

#include "annual/seat_terms.h"
#include "annual/seat_view.h"

/* Paths of a ray; of one among those of a pixel that sees lobes, which are more. */
enum { ORL_SEAT_RAY_PATHS = 8, ORL_SEAT_LOBE_PATHS = 4 };

struct orl_seat_rays {
    struct orl_seat_view *view; /* whose places and spots are added to */
    const struct orl_annual_scene *scene;
    struct orl_random random;
    uint32_t pixel;
    double share;                /* of the pixel that a ray stands for */
    uint32_t most_paths;         /* of a ray */
    bool spots;                  /* the next ray adds spots */
    bool lobes;                  /* a ray has met lobes */
    struct orl_seat_terms terms; /* of the pixel */
    size_t spots_room;           /* of the view's array */
    uint64_t steps;              /* segments followed */
};

/* Follows a ray from the eye. Returns 0 or ORL_ERR_NOMEM. */
int orl_seat_rays_follow(struct orl_seat_rays *rays, struct orl_vec3 direction);

#endif

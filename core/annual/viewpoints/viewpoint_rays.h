/*
 * Rays of a viewpoint's pixels. They add terms for the sky and for diffuse surfaces, reached
 * through panes, mirrors and lobes. They also add spots on visible surfaces where the sun may fall.
 *
 * At a surface a path may continue in three ways: straight through, mirrored, and in one direction
 * sampled from its lobes. It splits into all of them while the ray may have more paths. Afterwards
 * it takes one, sampled in proportion to what each carries. Paths that carry little, and paths of
 * many steps, end by Russian roulette (Arvo and Kirk 1990, "Particle transport and image
 * synthesis"). So a ray has at most ORL_VIEWPOINT_RAY_PATHS paths in any scene, and the estimate is
 * unbiased.
 *
 * Threads: one thread per viewpoint. Random numbers are keyed by viewpoint and pixel.
 */
#ifndef ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_RAYS_H
#define ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_RAYS_H

#include "annual/viewpoints/pixel_terms.h"
#include "annual/viewpoints/viewpoint_image.h"

/* Most paths of a ray: in general, and if the pixel sees lobes and has more rays. */
enum { ORL_VIEWPOINT_RAY_PATHS = 8, ORL_VIEWPOINT_LOBE_PATHS = 4 };

struct orl_viewpoint_rays {
    struct orl_viewpoint_image *view; /* receives visible points and spots */
    const struct orl_annual_scene *scene;
    struct orl_random random;
    uint32_t pixel;
    double share;                 /* share of the pixel that a ray represents */
    uint32_t most_paths;          /* most paths of a ray */
    bool spots;                   /* true if the next ray adds spots */
    bool lobes;                   /* true once a ray has hit lobes */
    struct orl_pixel_terms terms; /* terms of the current pixel */
    size_t spots_room;            /* capacity of view->spots */
    uint64_t steps;               /* traced segments */
};

/* Traces a ray from the eye. Returns 0 or ORL_ERR_NOMEM. */
int orl_viewpoint_rays_trace(struct orl_viewpoint_rays *rays, struct orl_vec3 direction);

#endif

/*
 * How clusters of light move as the light that comes turns, at each incident direction: from where
 * they go to, or come from, at all directions that share an edge of the mesh with it. Between two
 * directions light then follows a parabola, not a line: what parts and meets, widens and narrows,
 * does so at the right time.
 *
 * A slope takes turns of the incident direction to turns of the cluster: light that is mirrored
 * turns as much as what comes, whatever the distance, and what stays has a slope of none, so that
 * both are exact. By least squares over the edges, which in a row has the parabola through three;
 * at the border slopes are continued from those within.
 */
#ifndef ORL_FIT_SLOPES_H
#define ORL_FIT_SLOPES_H

#include "fit/mesh.h"
#include "fit/transport.h"

struct orl_fit_edge {
    uint32_t a, b; /* a < b */
    struct orl_fit_plan plans[ORL_FIT_KINDS];
    int code; /* of making it */
};

/* Slopes of one incident direction, by cluster. */
struct orl_fit_slopes {
    struct orl_fit_slope *of[ORL_FIT_KINDS]; /* owned; NULL: none is known */
};

/* A vector of the tangent plane in one place of the sphere that the great circle to another has
 * there, as long as the arc between them. Of unit vectors. */
struct orl_vec3 orl_fit_arc(struct orl_vec3 from, struct orl_vec3 to);
/* The same in coordinates of the frame about an incident direction. */
struct orl_fit_turn {
    double u, v;
};
struct orl_fit_turn orl_fit_turn_between(struct orl_vec3 from, struct orl_vec3 to);
/* Where that tangent leads from a unit vector. */
struct orl_vec3 orl_fit_follow(struct orl_vec3 from, struct orl_vec3 arc);
/* A slope's arc for a turn. */
struct orl_vec3 orl_fit_slope_arc(const struct orl_fit_slope *slope, struct orl_fit_turn turn);

/* edges: by a, then b, with their plans, whose moves get slopes; *ret_slopes: by direction of the
 * mesh, owned by the caller, orl_fit_slopes_done. False: no memory. */
bool orl_fit_slopes_make(struct orl_fit_edge *edges, size_t n, const struct orl_fit_mesh *mesh,
                         struct orl_fit_slopes **ret_slopes);
void orl_fit_slopes_done(struct orl_fit_slopes *slopes, size_t n);

#endif

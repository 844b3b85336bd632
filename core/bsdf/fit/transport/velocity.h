/*
 * Motion of light clusters as the incident direction turns, at each incident direction. It is
 * derived from moves to and from all neighbours in the mesh. Between two directions light then
 * follows a parabola instead of a line. Lobes thus separate, meet, widen and narrow at the right
 * places.
 *
 * A velocity maps turns of the incident direction to turns of the cluster. Mirrored light turns as
 * much as the incident direction at any distance. Light that does not move has velocity 0. Both are
 * therefore exact. Velocities are fitted by least squares over the edges; in a row this gives the
 * parabola through three. At the border velocities are extrapolated from inner directions.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_VELOCITY_H
#define ORL_BSDF_FIT_TRANSPORT_VELOCITY_H

#include "bsdf/fit/transport/incident_mesh.h"
#include "bsdf/fit/transport/transport.h"

struct orl_fit_edge {
    uint32_t a, b; /* a < b */
    struct orl_fit_plan plans[ORL_FIT_KINDS];
    int code; /* result of making its plans, an enum orl_err */
};

/* Velocities of one incident direction, by cluster. */
struct orl_fit_velocities {
    struct orl_fit_velocity *of[ORL_FIT_KINDS]; /* owned; NULL: none is known */
};

/* Returns the tangent vector at `from` of the great circle to `to`, as long as the arc between
 * them. Both are unit vectors. */
struct orl_vec3 orl_fit_arc(struct orl_vec3 from, struct orl_vec3 to);
/* A tangent vector in the frame about an incident direction, radians. */
struct orl_fit_turn {
    double u, v;
};
struct orl_fit_turn orl_fit_turn_between(struct orl_vec3 from, struct orl_vec3 to);
/* Returns the end of the arc that starts at a unit vector. */
struct orl_vec3 orl_fit_arc_end(struct orl_vec3 from, struct orl_vec3 arc);
/* Returns the arc of a velocity for a turn. */
struct orl_vec3 orl_fit_velocity_arc(const struct orl_fit_velocity *velocity,
                                     struct orl_fit_turn turn);

/* Sets the velocities of all directions, and of the moves in the edges' plans. edges: sorted by a,
 * then b. *ret_slopes: by direction of the mesh, owned by the caller, freed with
 * orl_fit_velocities_done. Returns false if out of memory. */
bool orl_fit_velocities_make(struct orl_fit_edge *edges, size_t n, const struct orl_fit_mesh *mesh,
                             struct orl_fit_velocities **ret_velocities);
void orl_fit_velocities_done(struct orl_fit_velocities *velocities, size_t n);

#endif

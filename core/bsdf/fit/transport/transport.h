/*
 * Interpolation between incident directions by transport of light: plans between two scans, the
 * mesh of incident directions, motion at each of them, plans along the mesh's edges, and the
 * result.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_TRANSPORT_H
#define ORL_BSDF_FIT_TRANSPORT_TRANSPORT_H

#include <oriel/base/thread_pool.h>

#include "bsdf/fit/scan/scan_light.h"

/*
 * Transport plans assign shares of one scan's light to another's at the least cost: displacement
 * interpolation (Bonneel, van de Panne, Paris and Heidrich 2011). The cost of a unit of light is
 * the squared chord of its move, up to a bound. Light that would have to move farther fades at one
 * place and appears at the other.
 *
 * Plans are solved by the transportation simplex (Dantzig 1951) over clusters
 * (fit/scan/scan_light.h). The solution is exact to 1e-7 of the largest cost, unless the limit on
 * pivots is reached. Ownership: the caller's, freed by orl_fit_plan_done.
 */

/* Motion and widening of a cluster per radian of turn of the incident direction, along the two axes
 * of the frame about that direction (orl_frame_about). */
struct orl_fit_velocity {
    float x[2], y[2], z[2], sigma[2];
    bool known;
};

/* Part of a cluster and its destination; shares of a cluster add up to 1. Destinations that are
 * close compared with the clusters' widths are merged. The cluster then moves as a whole and is not
 * split towards its neighbours' destinations. */
struct orl_fit_move {
    float x, y, z, sigma_rad; /* destination */
    float share;
    bool fades;       /* true if the destination is too far away */
    uint32_t submove; /* the first submove of the heaviest of the merged moves */
    struct orl_fit_velocity
        velocity; /* mean velocity of the clusters there; set by orl_fit_plans_make */
};

/* Part of a move, by destination cluster. */
struct orl_fit_submove {
    uint32_t to, move;
    float share;
};

/* Moves of the clusters of one scan (direction 0) or the other (direction 1). Those of cluster i
 * have the numbers from first[i] up to, but without, first[i + 1]. */
struct orl_fit_moves {
    uint32_t *first;
    struct orl_fit_move *moves;
    struct orl_fit_submove *submoves; /* in any order */
    size_t n_submoves;
};

struct orl_fit_plan {
    struct orl_fit_moves directions[2];
};

/* Makes a plan. If one part has no light, all light fades and there are no moves. farthest: the
 * chord from which light fades. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_fit_plan_make(const struct orl_fit_part *from, const struct orl_fit_part *to,
                      double farthest, const atomic_bool *cancel, struct orl_fit_plan *ret_plan,
                      struct orl_error *err);
void orl_fit_plan_done(struct orl_fit_plan *plan);

/* ---- The transportation problem ------------------------------------------------------------- */

struct orl_fit_flow {
    uint32_t from, to;
    double amount;
};

/*
 * Solves a transportation problem; supply and demand must have equal sums. cost: [from][to].
 * *ret_flows: owned by the caller, n_from + n_to - 1 entries, some of which may be 0. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_fit_transport(const double *supply, size_t n_from, const double *demand, size_t n_to,
                      const float *cost, const atomic_bool *cancel, struct orl_fit_flow **ret_flows,
                      size_t *ret_n);

/*
 * Mesh of incident directions, for interpolation between them.
 *
 * Isotropic samples: directions form a row by theta, preceded by the mirror images of the first
 * ones. Other samples: directions are corners of a Delaunay triangulation of the sphere (of its
 * stereographic projection), whose sides are arcs of great circles. Outside the mesh the nearest
 * position on its border is used.
 *
 * Ownership: the caller's, freed by orl_fit_mesh_done; shapes are borrowed. Immutable once made.
 */

enum { ORL_FIT_CORNERS = 3, ORL_FIT_MASSES = ORL_FIT_KINDS + 1 };

struct orl_fit_mesh {
    bool isotropic;
    size_t n;
    const struct orl_fit_shape **shapes; /* owned array of borrowed shapes */
    double (*positions)[2]; /* theta by azimuth, radians; in a row only the first is used */
    double (*gradients)[2]; /* gradients of totals along positions, 1/radian */
    uint32_t (*triangles)[ORL_FIT_CORNERS];
    size_t n_triangles, capacity;
};

/* Returns 0, ORL_ERR_INVALID (the directions do not surround the normal) or ORL_ERR_NOMEM. */
int orl_fit_mesh_make(const struct orl_fit_shape *const *shapes, size_t n, bool isotropic,
                      struct orl_fit_mesh *ret_mesh, struct orl_error *err);
void orl_fit_mesh_done(struct orl_fit_mesh *mesh);

/* Location of an incident direction in the mesh. */
struct orl_fit_location {
    struct orl_vec3 in, at; /* in: the query; at: the nearest direction within the mesh */
    unsigned count;
    uint32_t corner[ORL_FIT_CORNERS];
    double weight[ORL_FIT_CORNERS]; /* weights of the corners; they add up to 1 */
    double lean[ORL_FIT_CORNERS]; /* weights by which the corner directions add up to a vector along
                                     at */
    double mass[ORL_FIT_MASSES];  /* mass of each kind, then of the floor */
};
void orl_fit_mesh_locate(const struct orl_fit_mesh *mesh, struct orl_vec3 in,
                         struct orl_fit_location *ret_location);

/* Returns the number of pairs of neighbours; inner edges of a triangulation come twice. */
size_t orl_fit_mesh_edges(const struct orl_fit_mesh *mesh);
void orl_fit_mesh_edge(const struct orl_fit_mesh *mesh, size_t index, uint32_t ret_ends[2]);
/* Sets for each direction: true on the border of the mesh, or at an end of the row. */
void orl_fit_mesh_border(const struct orl_fit_mesh *mesh, bool *ret_border);

/*
 * Motion of light clusters as the incident direction turns, at each incident direction. It is
 * derived from moves to and from all neighbours in the mesh. Between two directions light then
 * follows a parabola instead of a line. Lobes thus separate, merge, widen and narrow at the right
 * directions.
 *
 * A velocity maps turns of the incident direction to turns of the cluster. Mirrored light turns as
 * much as the incident direction at any distance. Light that does not move has velocity 0. Both are
 * therefore exact. Velocities are fitted by least squares over the edges; in a row this gives the
 * parabola through three. At the border velocities are extrapolated from inner directions.
 */

struct orl_fit_edge {
    uint32_t a, b; /* a < b */
    struct orl_fit_plan plans[ORL_FIT_KINDS];
    int code; /* result of making its plans, an enum orl_err */
};

/* Velocities of one incident direction, by cluster. */
struct orl_fit_velocities {
    struct orl_fit_velocity *of[ORL_FIT_KINDS]; /* owned; NULL: none is known */
};

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

/*
 * Transport plans between the requested incident directions of a mesh, and velocities.
 *
 * Ownership: the caller's, freed by _done. Once made, plans may be read by many threads.
 */

struct orl_fit_plans {
    struct orl_fit_edge *edges; /* sorted by a, then b */
    size_t n, capacity;
    struct orl_fit_velocities *velocities; /* by direction of the mesh; owned */
    size_t n_directions;
};

/* Requests the edges that a location needs, in any order; repeats are allowed. Returns false if out
 * of memory. */
bool orl_fit_plans_request(struct orl_fit_plans *plans, const struct orl_fit_location *location);
/* Sorts the edges and makes their plans, in parallel or serially (pool NULL). Returns 0 or a
 * negative enum orl_err. */
int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_thread_pool *pool, const atomic_bool *cancel,
                       struct orl_error *err);
void orl_fit_plans_done(struct orl_fit_plans *plans);

/* Returns the moves of one direction's light to another's; NULL if there is no plan. */
const struct orl_fit_moves *orl_fit_plans_moves(const struct orl_fit_plans *plans, uint32_t from,
                                                uint32_t to, int kind);

/*
 * Interpolation between incident directions: the lobes of each corner, moved by the plans to the
 * other corners, and weighted.
 *
 * A lobe moves with its cluster. Its offset from the cluster and its width are scaled like the
 * cluster's width. A cluster moves to a mean of its places at the corners and of the places that
 * the velocities at the corners predict. At a corner the result is therefore that corner's shape,
 * and it varies continuously between corners. Beyond the border of the mesh the narrow part is
 * turned with the straight direction; the rest does not move.
 *
 * Ownership: lobes are owned by the caller, who frees them with _done.
 */

/* A Gaussian of light around the direction (x, y, z). */
struct orl_fit_gaussian {
    float x, y, z, mass, sigma_rad;
};

struct orl_fit_light {
    struct orl_fit_gaussian *gaussians; /* lobes; owned */
    size_t n, capacity;
    double floor; /* constant value beside the lobes, 1/sr */
};

/* Replaces the contents of *light. Returns false if out of memory. */
bool orl_fit_interpolate(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                         const struct orl_fit_location *location, struct orl_fit_light *light);
void orl_fit_light_done(struct orl_fit_light *light);

#endif

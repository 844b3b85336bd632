/*
 * Importance sampling of ray directions at a place. A ray is drawn by one of four strategies:
 *   by the cosine;
 *   at a port: a point uniform over one of them;
 *   along a beam: at a pane whose lobes send a sun that way, in proportion to the light (beam.h).
 *   The pane is a port or, in a scene that is no building, a free-standing pane;
 *   at a small mirror or lens (targets.h).
 * A place draws some rays by each strategy. If several strategies could have made a ray, its weight
 * has the sum of their densities, each times its number of rays: the multi-sample balance heuristic
 * of Veach and Guibas 1995. The last three strategies count only if the ray first meets its goal.
 * No density is therefore needed for a port behind a wall.
 */
#ifndef ORL_RENDER_GATHER_AIM_H
#define ORL_RENDER_GATHER_AIM_H

#include "render/gather/beam.h"
#include "render/gather/targets.h"

enum { ORL_MOST_BEAMS = 32 };

struct orl_aim {
    const struct orl_world *world; /* borrowed */
    struct orl_beam *beams;   /* those beyond ORL_MOST_BEAMS are left to the other strategies */
    struct orl_shaft *shafts; /* one for every pair of beam and pane */
    struct orl_beam_cells *cells;
    uint32_t n_beams, n_shafts;
    uint32_t *first_shaft; /* index of each pane's first shaft, and one past the last */
    uint32_t *panes;       /* facets, ascending, owned; NULL: panes are the world's ports */
    uint32_t n_panes;
    struct orl_targets targets;
};

/* Initialises an aim. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; call orl_aim_done in either
 * case. */
int orl_aim_init(struct orl_aim *aim, const struct orl_world *world, const struct orl_sobol *sobol,
                 struct orl_crew *crew);
void orl_aim_done(struct orl_aim *aim); /* also accepts an all-zero struct */

enum orl_way { ORL_WAY_COSINE, ORL_WAY_PORT, ORL_WAY_BEAM, ORL_WAY_TARGET, ORL_WAYS };

/* Mean number of rays at a place by strategy; fractions are rounded at random. */
struct orl_effort {
    double rays[ORL_WAYS];
};

/* Returns the wanted counts, with 0 for strategies that do not apply to the scene. */
struct orl_effort orl_aim_effort(const struct orl_aim *aim, struct orl_effort wanted);

/* Returns the density, per steradian, of a direction towards a point uniform by area on one of the
 * ports, each with the same probability. Returns 0 if the ray first meets something else. */
double orl_aim_port_density(const struct orl_aim *aim, const struct orl_hit *hit,
                            struct orl_vec3 direction);

struct orl_aimed {
    struct orl_vec3 direction;
    /* Cosine over density; the sum over all rays of weight times radiance is irradiance. */
    double weight;
    bool met; /* true if the ray meets a surface, which is hit */
    struct orl_hit hit;
};

/* Draws a ray by one strategy and traces it; sets all fields but its weight. Returns false if the
 * ray counts for nothing. u: three numbers in [0,1). */
bool orl_aim_draw(const struct orl_aim *aim, enum orl_way way, struct orl_vec3 point,
                  struct orl_vec3 normal, const double u[3], struct orl_aimed *ret_aimed);

/* Returns the combined density, per steradian, of such a ray: the sum over strategies of density
 * times number of rays. */
double orl_aim_density(const struct orl_aim *aim, const struct orl_effort *effort,
                       struct orl_vec3 point, struct orl_vec3 normal,
                       const struct orl_aimed *aimed);

/* Draws as orl_aim_draw does, and sets the weight that the ray has among all rays of an effort. */
bool orl_aim_sample(const struct orl_aim *aim, const struct orl_effort *effort, enum orl_way way,
                    struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                    struct orl_aimed *ret_aimed);

#endif

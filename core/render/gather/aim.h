/*
 * Rays from a place, towards where light may come from. A ray is drawn in one of four ways:
 *   by the cosine;
 *   at a port: a point uniform over one of them;
 *   along a beam: at a pane whose lobes send a sun that way, by how much (beam.h): a port, or where
 *   there are none, for nothing is a building, one that stands free;
 *   at a small mirror or lens (targets.h).
 * A place draws some of each, and where several ways could have made a ray it weighs by the sum of
 * their densities, each times its number: the balance heuristic for many samples of Veach and
 * Guibas 1995. The last three count only when the ray first meets what it was aimed at, so that
 * no density of a port behind a wall is needed.
 */
#ifndef ORL_RENDER_GATHER_AIM_H
#define ORL_RENDER_GATHER_AIM_H

#include "render/gather/beam.h"
#include "render/gather/targets.h"

enum { ORL_MOST_BEAMS = 32 };

struct orl_aim {
    const struct orl_world *world; /* borrowed */
    struct orl_beam *beams;        /* those beyond the most are left to the other ways */
    struct orl_shaft *shafts;      /* every beam by way of every pane */
    struct orl_beam_cells *cells;
    uint32_t n_beams, n_shafts;
    uint32_t *first_shaft; /* per pane, and one more */
    uint32_t *panes;       /* facets, ascending; NULL: panes are the world's ports */
    uint32_t n_panes;
    struct orl_targets targets;
};

/* Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; orl_aim_done in either case. */
int orl_aim_init(struct orl_aim *aim, const struct orl_world *world, const struct orl_sobol *sobol,
                 struct orl_crew *crew);
void orl_aim_done(struct orl_aim *aim); /* also of one that is all zero */

enum orl_way { ORL_WAY_COSINE, ORL_WAY_PORT, ORL_WAY_BEAM, ORL_WAY_TARGET, ORL_WAYS };

/* How many rays of a place are drawn in each way, on average: fractions are drawn by lot. */
struct orl_effort {
    double rays[ORL_WAYS];
};

/* The effort, without the ways that the scene has nothing for. */
struct orl_effort orl_aim_effort(const struct orl_aim *aim, struct orl_effort wanted);

/* Density, per steradian, of a direction towards a point uniform by area on one of the ports, all
 * with the same probability; 0 where the ray meets first something else. */
double orl_aim_port_density(const struct orl_aim *aim, const struct orl_hit *hit,
                            struct orl_vec3 direction);

struct orl_aimed {
    struct orl_vec3 direction;
    double weight; /* cosine over density: times radiance, summed over all rays, irradiance */
    bool met;      /* a surface: hit */
    struct orl_hit hit;
};

/* Draws a ray in one of the ways and traces it; all but its weight. False when it counts for
 * nothing. u: three numbers in [0,1). */
bool orl_aim_draw(const struct orl_aim *aim, enum orl_way way, struct orl_vec3 point,
                  struct orl_vec3 normal, const double u[3], struct orl_aimed *ret_aimed);

/* Density, per steradian, of such a ray by all ways of an effort: the sum of the density of each
 * times its number of rays. */
double orl_aim_density(const struct orl_aim *aim, const struct orl_effort *effort,
                       struct orl_vec3 point, struct orl_vec3 normal,
                       const struct orl_aimed *aimed);

/* orl_aim_draw, with the weight that the ray has among all of an effort. */
bool orl_aim_sample(const struct orl_aim *aim, const struct orl_effort *effort, enum orl_way way,
                    struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                    struct orl_aimed *ret_aimed);

#endif

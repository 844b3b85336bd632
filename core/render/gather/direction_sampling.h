/*
 * Importance sampling of ray directions at a place. A ray is drawn by one of four strategies:
 *   by the cosine;
 *   at a port: a point uniform over one of them;
 *   along a sun lobe: at a pane whose lobes send a sun that way, in proportion to the light
 * (sun_lobe.h). The pane is a port or, in a scene that is no building, a free-standing pane; at a
 * small mirror or lens (targets.h). A place draws some rays by each strategy. If several strategies
 * could have made a ray, its weight has the sum of their densities, each times its number of rays:
 * the multi-sample balance heuristic of Veach and Guibas 1995. The last three strategies count only
 * if the ray first meets its goal. No density is therefore needed for a port behind a wall.
 */
#ifndef ORL_RENDER_GATHER_DIRECTION_SAMPLING_H
#define ORL_RENDER_GATHER_DIRECTION_SAMPLING_H

#include "render/gather/sun_lobe.h"
#include "render/gather/targets.h"

enum { ORL_MOST_SUN_LOBES = 32 };

struct orl_direction_sampler {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_sun_lobe
        *sun_lobes; /* those beyond ORL_MOST_SUN_LOBES are left to the other strategies */
    struct orl_window_lobe *window_lobes; /* one for every pair of sun lobe and pane */
    struct orl_sun_lobe_cells *cells;
    uint32_t n_sun_lobes, n_window_lobes;
    uint32_t *first_window_lobe; /* index of each pane's first window lobe, and one past the last */
    uint32_t *panes;             /* facets, ascending, owned; NULL: panes are the world's ports */
    uint32_t n_panes;
    struct orl_targets targets;
};

/* Initialises a sampler. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; call
 * orl_direction_sampler_done in either case. */
int orl_direction_sampler_init(struct orl_direction_sampler *sampler,
                               const struct orl_lit_scene *lit_scene, const struct orl_sobol *sobol,
                               struct orl_thread_pool *pool);
void orl_direction_sampler_done(
    struct orl_direction_sampler *sampler); /* also accepts an all-zero struct */

enum orl_strategy {
    ORL_SAMPLE_COSINE,
    ORL_SAMPLE_PORT,
    ORL_SAMPLE_LOBE,
    ORL_SAMPLE_TARGET,
    ORL_STRATEGIES
};

/* Mean number of rays at a place by strategy; fractions are rounded at random. */
struct orl_strategy_counts {
    double rays[ORL_STRATEGIES];
};

/* Returns the wanted counts, with 0 for strategies that do not apply to the scene. */
struct orl_strategy_counts orl_direction_sampler_counts(const struct orl_direction_sampler *sampler,
                                                        struct orl_strategy_counts wanted);

/* Returns the density, per steradian, of a direction towards a point uniform by area on one of the
 * ports, each with the same probability. Returns 0 if the ray first meets something else. */
double orl_direction_port_pdf(const struct orl_direction_sampler *sampler,
                              const struct orl_hit *hit, struct orl_vec3 direction);

struct orl_direction_sample {
    struct orl_vec3 direction;
    /* Cosine over density; the sum over all rays of weight times radiance is irradiance. */
    double weight;
    bool met; /* true if the ray meets a surface, which is hit */
    struct orl_hit hit;
};

/* Draws a ray by one strategy and traces it; sets all fields but its weight. Returns false if the
 * ray counts for nothing. u: three numbers in [0,1). */
bool orl_direction_trace(const struct orl_direction_sampler *sampler, enum orl_strategy strategy,
                         struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                         struct orl_direction_sample *ret_sample);

/* Returns the combined density, per steradian, of such a ray: the sum over strategies of density
 * times number of rays. */
double orl_direction_pdf(const struct orl_direction_sampler *sampler,
                         const struct orl_strategy_counts *ray_counts, struct orl_vec3 point,
                         struct orl_vec3 normal, const struct orl_direction_sample *ray_sample);

/* Draws as orl_direction_trace does, and sets the weight that the ray has among all rays of the
 * counts. */
bool orl_direction_sample_traced(const struct orl_direction_sampler *sampler,
                                 const struct orl_strategy_counts *ray_counts,
                                 enum orl_strategy strategy, struct orl_vec3 point,
                                 struct orl_vec3 normal, const double u[3],
                                 struct orl_direction_sample *ret_sample);

#endif

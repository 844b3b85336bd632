/*
 * Importance sampling of ray directions at a place. A ray is drawn by one of four strategies:
 *   by the cosine;
 *   at a port: a point uniform over one of them;
 *   along a sun lobe: at a pane whose lobes send a sun that way, in proportion to the light. The
 *     pane is a port or, in a scene that is no building, a free-standing pane;
 *   at a target: a small mirror or lens.
 * A place draws some rays by each strategy. If several strategies could have made a ray, its weight
 * has the sum of their densities, each times its number of rays: the multi-sample balance heuristic
 * of Veach and Guibas 1995. The last three strategies count only if the ray first meets its goal.
 * No density is therefore needed for a port behind a wall.
 *
 * Sun lobes and targets have sections of their own.
 */
#ifndef ORL_RENDER_GATHER_DIRECTION_SAMPLING_H
#define ORL_RENDER_GATHER_DIRECTION_SAMPLING_H

#include <oriel/base/thread_pool.h>

#include "base/sampling/sampling.h"
#include "light/lit_scene.h"

/*
 * Sun lobes: the light of a sun through the lobes of a kind of pane, as a table over the directions
 * on the far side. From a place only the directions towards the pane count. A direction is drawn by
 * descending the table: at each level one of four quarters is chosen by its light, without the
 * quarters that cannot come from the pane.
 *
 * The table may be inexact and incomplete: another strategy reaches every direction, and a ray is
 * weighed by the densities of both. Constant once made.
 */

enum { ORL_SUN_LOBE_LEVELS = 7, ORL_SUN_LOBE_SIDE = 1 << (ORL_SUN_LOBE_LEVELS - 1) };
enum {
    ORL_SUN_LOBE_CELLS = ((1 << 2 * ORL_SUN_LOBE_LEVELS) - 1) / 3
}; /* cells of all levels, coarsest first */

/* Directions of all cells, in a pane's frame; z points away from the pane on the far side. */
struct orl_sun_lobe_cells {
    float direction[ORL_SUN_LOBE_CELLS][3], radius[ORL_SUN_LOBE_CELLS];
};

/* A sun in a kind of pane. Panes of one material that face alike share a sun lobe. */
struct orl_sun_lobe {
    const struct orl_material *material; /* borrowed from the lit scene */
    struct orl_vec3 normal;
    const struct orl_sun *sun;       /* borrowed from the lit scene */
    struct orl_frame frame;          /* n points to the far side */
    float light[ORL_SUN_LOBE_CELLS]; /* share of the total */
};

/* The bounding rectangle of a pane, in a sun lobe's frame. */
struct orl_window_lobe {
    uint32_t sun_lobe, facet;
    struct orl_vec3 center;
    double half_u, half_v;
};

void orl_sun_lobe_cells_init(struct orl_sun_lobe_cells *cells);

/* Fills in all fields but material, normal and sun, which the caller sets. The result does not
 * depend on the pool. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_sun_lobe_init(struct orl_sun_lobe *sun_lobe, const struct orl_sobol *sobol,
                      struct orl_thread_pool *pool);

struct orl_window_lobe orl_window_lobe_make(const struct orl_geometry *geometry,
                                            const struct orl_sun_lobe *sun_lobe, uint32_t index,
                                            uint32_t facet);

/* Draws a direction from a place towards the pane, against its sun lobe. Returns false if no light
 * from the pane reaches the place. u: two numbers in [0,1). */
bool orl_window_lobe_sample(const struct orl_window_lobe *window_lobe,
                            const struct orl_sun_lobe *sun_lobe,
                            const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                            const double u[2], struct orl_vec3 *ret_direction);

/* Returns the density, per steradian, of orl_window_lobe_sample. */
double orl_window_lobe_pdf(const struct orl_window_lobe *window_lobe,
                           const struct orl_sun_lobe *sun_lobe,
                           const struct orl_sun_lobe_cells *cells, struct orl_vec3 point,
                           struct orl_vec3 direction);

/*
 * Small mirrors and lenses as targets of rays. A ball of glass that fills a thousandth of the field
 * of view may bring a tenth of the light at a place. Rays drawn by the cosine meet it a few times
 * at most. Each target is a group of facets with a bounding sphere. Directions towards it are
 * uniform in the cone that the sphere fills (Pharr, Jakob and Humphreys 2016, section 14.2.2), or
 * in all directions if the place is in the sphere.
 *
 * Groups are facets that lie near each other. A set is divided at the middle of its longest axis
 * while the spheres about both parts have less than half the surface of the sphere about the set.
 * Large groups are no targets: other rays meet them often enough.
 */

enum { ORL_MOST_TARGETS = 32, ORL_NO_TARGET = 255 };

struct orl_target_sphere {
    struct orl_vec3 center; /* moved coordinates */
    double radius;
};

struct orl_targets {
    struct orl_target_sphere at[ORL_MOST_TARGETS];
    uint32_t n;
    uint8_t *of_facet; /* target of each of the scene's own facets, or ORL_NO_TARGET; NULL: none */
    uint8_t *of_instance; /* target of each placed copy (scene/geometry/instances.h); NULL: none */
};

/* Finds the targets indoors; in a scene that is no building, all of them. Returns 0 or
 * ORL_ERR_NOMEM; call orl_targets_done in either case. */
int orl_targets_init(struct orl_targets *targets, const struct orl_lit_scene *lit_scene);
void orl_targets_done(struct orl_targets *targets); /* also accepts an all-zero struct */

/* Returns the target that a facet belongs to, or ORL_NO_TARGET. */
uint32_t orl_targets_of(const struct orl_targets *targets, const struct orl_geometry *geometry,
                        uint32_t facet);

/* Returns a direction from a point towards a target; u in [0,1)^2. */
struct orl_vec3 orl_target_sample(const struct orl_target_sphere *target, struct orl_vec3 point,
                                  const double u[2]);

/* Returns the density of that direction, per steradian; 0 outside the target's cone. */
double orl_target_pdf(const struct orl_target_sphere *target, struct orl_vec3 point,
                      struct orl_vec3 direction);

enum { ORL_MOST_SUN_LOBES = 32 };

struct orl_direction_sampler {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_sun_lobe
        *sun_lobes; /* those beyond ORL_MOST_SUN_LOBES are left to the other strategies */
    struct orl_window_lobe *window_lobes; /* one for every pair of sun lobe and pane */
    struct orl_sun_lobe_cells *cells;
    uint32_t n_sun_lobes, n_window_lobes;
    uint32_t *first_window_lobe; /* index of each pane's first window lobe, and one past the last */
    bool panes_are_ports;        /* true: the lit scene's ports; false: free-standing panes */
    uint32_t *panes;             /* facets of free-standing panes, ascending, owned */
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

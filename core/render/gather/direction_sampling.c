#include "render/gather/direction_sampling.h"

#include <stdlib.h>

#include "scene/material/scatter.h"

/* Inputs for building a sampler. */
struct maker {
    struct orl_direction_sampler *sampler;
    const struct orl_sobol *sobol;
    struct orl_thread_pool *pool;
};

/* Finds the sun lobe of a sun in a kind of pane, or adds it. Returns its index, or
 * ORL_MOST_SUN_LOBES if the table is full, or ORL_ERR_NOMEM. */
static int find_sun_lobe(const struct maker *maker, uint32_t facet, const struct orl_sun *sun)
{
    struct orl_direction_sampler *sampler = maker->sampler;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(sampler->lit_scene->geometry, facet, &own);
    const struct orl_material *m = &sampler->lit_scene->materials[f->material];
    for (uint32_t i = 0; i < sampler->n_sun_lobes; i++) {
        const struct orl_sun_lobe *sun_lobe = &sampler->sun_lobes[i];
        if (sun_lobe->material == m && orl_dot(sun_lobe->normal, f->normal) > 1 - 1e-9 &&
            sun_lobe->sun == sun)
            return (int)i;
    }
    if (sampler->n_sun_lobes == ORL_MOST_SUN_LOBES)
        return ORL_MOST_SUN_LOBES;
    struct orl_sun_lobe *sun_lobe = &sampler->sun_lobes[sampler->n_sun_lobes];
    *sun_lobe = (struct orl_sun_lobe){.material = m, .normal = f->normal, .sun = sun};
    const int code = orl_sun_lobe_init(sun_lobe, maker->sobol, maker->pool);
    return code < 0 ? code : (int)sampler->n_sun_lobes++;
}

enum { MOST_FREE_PANES = 1024 };

static bool is_pane(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(lit_scene->geometry, facet, &own);
    return orl_surface_kind_is_flat(f->kind) && f->area > 0 &&
           orl_material_transmits_lobes(&lit_scene->materials[f->material]);
}

/* Lists the ports or, if there are none, free-standing panes. Panes beyond MOST_FREE_PANES are left
 * to the other strategies. */
static bool list_panes(struct orl_direction_sampler *sampler)
{
    const struct orl_lit_scene *lit_scene = sampler->lit_scene;
    sampler->n_panes = (uint32_t)lit_scene->n_ports;
    sampler->panes_are_ports = lit_scene->n_ports > 0;
    if (sampler->panes_are_ports)
        return true;
    sampler->panes = malloc(MOST_FREE_PANES * sizeof *sampler->panes);
    for (uint32_t i = 0;
         sampler->panes && i < lit_scene->geometry->n_facets && sampler->n_panes < MOST_FREE_PANES;
         i++)
        if (is_pane(lit_scene, i))
            sampler->panes[sampler->n_panes++] = i;
    return sampler->panes != NULL;
}

static uint32_t pane_facet(const struct orl_direction_sampler *sampler, uint32_t pane)
{
    return sampler->panes_are_ports ? sampler->lit_scene->ports[pane].facet : sampler->panes[pane];
}

/* Returns the index of a facet's pane, or ORL_NO_PORT. */
static int32_t pane_of(const struct orl_direction_sampler *sampler, uint32_t facet)
{
    uint32_t low = 0, high = sampler->n_panes;
    if (sampler->panes_are_ports)
        return orl_lit_scene_port_of(sampler->lit_scene, facet);
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (sampler->panes[middle] < facet)
            low = middle + 1;
        else
            high = middle;
    }
    return low < sampler->n_panes && sampler->panes[low] == facet ? (int32_t)low : ORL_NO_PORT;
}

static int add_window_lobes(const struct maker *maker, uint32_t pane)
{
    struct orl_direction_sampler *sampler = maker->sampler;
    const struct orl_lit_scene *lit_scene = sampler->lit_scene;
    const uint32_t facet = pane_facet(sampler, pane);
    if (!is_pane(lit_scene, facet))
        return 0;
    for (size_t s = 0; s < lit_scene->n_suns; s++) {
        if (sampler->panes_are_ports &&
            !(orl_dot(lit_scene->suns[s].frame.n, lit_scene->ports[pane].outward) > 0))
            continue;
        const int sun_lobe = find_sun_lobe(maker, facet, &lit_scene->suns[s]);
        if (sun_lobe < 0)
            return sun_lobe;
        if (sun_lobe < ORL_MOST_SUN_LOBES)
            sampler->window_lobes[sampler->n_window_lobes++] = orl_window_lobe_make(
                lit_scene->geometry, &sampler->sun_lobes[sun_lobe], (uint32_t)sun_lobe, facet);
    }
    return 0;
}

int orl_direction_sampler_init(struct orl_direction_sampler *sampler,
                               const struct orl_lit_scene *lit_scene, const struct orl_sobol *sobol,
                               struct orl_thread_pool *pool)
{
    const struct maker maker = {sampler, sobol, pool};
    int code = 0;
    *sampler = (struct orl_direction_sampler){.lit_scene = lit_scene};
    if (!list_panes(sampler) || orl_targets_init(&sampler->targets, lit_scene) < 0)
        return ORL_ERR_NOMEM;
    sampler->first_window_lobe =
        calloc((size_t)sampler->n_panes + 1, sizeof *sampler->first_window_lobe);
    if (!sampler->first_window_lobe)
        return ORL_ERR_NOMEM;
    bool lobes = false;
    for (uint32_t i = 0; i < sampler->n_panes; i++)
        lobes = lobes || is_pane(lit_scene, pane_facet(sampler, i));
    if (!lobes || lit_scene->n_suns == 0)
        return 0;
    sampler->cells = malloc(sizeof *sampler->cells);
    sampler->sun_lobes = calloc(ORL_MOST_SUN_LOBES, sizeof *sampler->sun_lobes);
    sampler->window_lobes =
        calloc(sampler->n_panes * lit_scene->n_suns, sizeof *sampler->window_lobes);
    if (!sampler->cells || !sampler->sun_lobes || !sampler->window_lobes)
        return ORL_ERR_NOMEM;
    orl_sun_lobe_cells_init(sampler->cells);
    for (uint32_t i = 0; i < sampler->n_panes && code == 0; i++) {
        code = add_window_lobes(&maker, i);
        sampler->first_window_lobe[i + 1] = sampler->n_window_lobes;
    }
    return code;
}

void orl_direction_sampler_done(struct orl_direction_sampler *sampler)
{
    free(sampler->first_window_lobe);
    free(sampler->panes);
    free(sampler->cells);
    free(sampler->sun_lobes);
    free(sampler->window_lobes);
    orl_targets_done(&sampler->targets);
    *sampler = (struct orl_direction_sampler){.lit_scene = NULL};
}

struct orl_strategy_counts orl_direction_sampler_counts(const struct orl_direction_sampler *sampler,
                                                        struct orl_strategy_counts wanted)
{
    if (sampler->lit_scene->n_ports == 0)
        wanted.rays[ORL_SAMPLE_PORT] = 0;
    if (sampler->n_window_lobes == 0)
        wanted.rays[ORL_SAMPLE_LOBE] = 0;
    if (sampler->targets.n == 0)
        wanted.rays[ORL_SAMPLE_TARGET] = 0;
    return wanted;
}

/* Returns the density, per steradian, of a direction towards a point uniform by area on one of the
 * ports, each with the same probability. The ray first meets that port. */
static double port_pdf(const struct orl_direction_sampler *sampler, const struct orl_hit *hit,
                       struct orl_vec3 direction)
{
    struct orl_facet own;
    const struct orl_facet *facet =
        orl_facet_get_own(sampler->lit_scene->geometry, hit->facet, &own);
    const double cosine = fmax(fabs(orl_dot(direction, hit->normal)), 1e-9);
    return hit->distance * hit->distance /
           (cosine * facet->area * (double)sampler->lit_scene->n_ports);
}

/* Returns the density, per steradian, of rays drawn along sun lobes. */
static double window_lobe_pdf(const struct orl_direction_sampler *sampler,
                              const struct orl_direction_sample *ray_sample, int32_t pane,
                              struct orl_vec3 point)
{
    double sum = 0;
    for (uint32_t i = sampler->first_window_lobe[pane]; i < sampler->first_window_lobe[pane + 1];
         i++)
        sum += orl_window_lobe_pdf(&sampler->window_lobes[i],
                                   &sampler->sun_lobes[sampler->window_lobes[i].sun_lobe],
                                   sampler->cells, point, ray_sample->direction);
    return sum / sampler->n_window_lobes;
}

/* The facet or target that a ray must meet first to count. */
struct goal {
    uint32_t facet;  /* UINT32_MAX: any */
    uint32_t target; /* ORL_NO_TARGET: any */
};

/* Draws a direction by one strategy, and sets what the ray must meet first. */
static bool draw_direction(const struct orl_direction_sampler *sampler, enum orl_strategy strategy,
                           struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                           struct orl_vec3 *ret_direction, struct goal *ret_goal)
{
    const struct orl_lit_scene *lit_scene = sampler->lit_scene;
    const size_t choices[ORL_STRATEGIES] = {1, lit_scene->n_ports, sampler->n_window_lobes,
                                            sampler->targets.n};
    const size_t choice = (size_t)(u[2] * (double)choices[strategy]);
    *ret_goal = (struct goal){.facet = UINT32_MAX, .target = ORL_NO_TARGET};
    if (strategy == ORL_SAMPLE_COSINE) {
        *ret_direction = orl_hemisphere_about(normal, u[0], u[1]);
        return true;
    }
    if (strategy == ORL_SAMPLE_TARGET) {
        ret_goal->target = (uint32_t)choice;
        *ret_direction = orl_target_sample(&sampler->targets.at[choice], point, u);
        return true;
    }
    if (strategy == ORL_SAMPLE_PORT) {
        struct orl_vec3 there, ignored;
        ret_goal->facet = lit_scene->ports[choice].facet;
        orl_facet_sample(lit_scene->geometry, ret_goal->facet, u, &there, &ignored);
        *ret_direction = orl_normalize(orl_sub(there, point));
        return true;
    }
    const struct orl_window_lobe *window_lobe = &sampler->window_lobes[choice];
    ret_goal->facet = window_lobe->facet;
    return orl_window_lobe_sample(window_lobe, &sampler->sun_lobes[window_lobe->sun_lobe],
                                  sampler->cells, point, u, ret_direction);
}

static uint32_t target_of(const struct orl_direction_sampler *sampler,
                          const struct orl_direction_sample *ray_sample)
{
    return ray_sample->met ? orl_targets_of(&sampler->targets, sampler->lit_scene->geometry,
                                            ray_sample->hit.facet)
                           : ORL_NO_TARGET;
}

bool orl_direction_trace(const struct orl_direction_sampler *sampler, enum orl_strategy strategy,
                         struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                         struct orl_direction_sample *ret_sample)
{
    struct goal goal;
    if (!draw_direction(sampler, strategy, point, normal, u, &ret_sample->direction, &goal) ||
        !(orl_dot(ret_sample->direction, normal) > 0))
        return false;
    ret_sample->met = orl_geometry_intersect(sampler->lit_scene->geometry, point,
                                             ret_sample->direction, INFINITY, &ret_sample->hit);
    if (goal.facet != UINT32_MAX)
        return ret_sample->met && ret_sample->hit.facet == goal.facet;
    return goal.target == ORL_NO_TARGET || target_of(sampler, ret_sample) == goal.target;
}

double orl_direction_pdf(const struct orl_direction_sampler *sampler,
                         const struct orl_strategy_counts *ray_counts, struct orl_vec3 point,
                         struct orl_vec3 normal, const struct orl_direction_sample *ray_sample)
{
    const double *const rays = ray_counts->rays;
    const int32_t pane = ray_sample->met ? pane_of(sampler, ray_sample->hit.facet) : ORL_NO_PORT;
    double density = rays[ORL_SAMPLE_COSINE] * orl_dot(ray_sample->direction, normal) / ORL_PI;
    if (pane != ORL_NO_PORT && rays[ORL_SAMPLE_PORT] > 0)
        density +=
            rays[ORL_SAMPLE_PORT] * port_pdf(sampler, &ray_sample->hit, ray_sample->direction);
    if (pane != ORL_NO_PORT && rays[ORL_SAMPLE_LOBE] > 0)
        density += rays[ORL_SAMPLE_LOBE] * window_lobe_pdf(sampler, ray_sample, pane, point);
    if (!(rays[ORL_SAMPLE_TARGET] > 0))
        return density;
    const uint32_t target = target_of(sampler, ray_sample);
    if (target != ORL_NO_TARGET)
        density += rays[ORL_SAMPLE_TARGET] / sampler->targets.n *
                   orl_target_pdf(&sampler->targets.at[target], point, ray_sample->direction);
    return density;
}

bool orl_direction_sample_traced(const struct orl_direction_sampler *sampler,
                                 const struct orl_strategy_counts *ray_counts,
                                 enum orl_strategy strategy, struct orl_vec3 point,
                                 struct orl_vec3 normal, const double u[3],
                                 struct orl_direction_sample *ret_sample)
{
    if (!orl_direction_trace(sampler, strategy, point, normal, u, ret_sample))
        return false;
    ret_sample->weight = orl_dot(ret_sample->direction, normal) /
                         orl_direction_pdf(sampler, ray_counts, point, normal, ret_sample);
    return true;
}

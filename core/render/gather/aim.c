#include "render/gather/aim.h"

#include <stdlib.h>

#include "scene/material/hemisphere.h"

/* Inputs for building an aim. */
struct maker {
    struct orl_aim *aim;
    const struct orl_sobol *sobol;
    struct orl_crew *crew;
};

/* Finds the beam of a sun in a kind of pane, or adds it. Returns its index, or ORL_MOST_BEAMS if
 * the table is full, or ORL_ERR_NOMEM. */
static int find_beam(const struct maker *maker, uint32_t facet, const struct orl_sun *sun)
{
    struct orl_aim *aim = maker->aim;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_own(aim->world->geometry, facet, &own);
    const struct orl_material *m = &aim->world->materials[f->material];
    for (uint32_t i = 0; i < aim->n_beams; i++) {
        const struct orl_beam *beam = &aim->beams[i];
        if (beam->material == m && orl_dot(beam->normal, f->normal) > 1 - 1e-9 && beam->sun == sun)
            return (int)i;
    }
    if (aim->n_beams == ORL_MOST_BEAMS)
        return ORL_MOST_BEAMS;
    struct orl_beam *beam = &aim->beams[aim->n_beams];
    *beam = (struct orl_beam){.material = m, .normal = f->normal, .sun = sun};
    const int code = orl_beam_init(beam, maker->sobol, maker->crew);
    return code < 0 ? code : (int)aim->n_beams++;
}

enum { MOST_FREE_PANES = 1024 };

static bool is_pane(const struct orl_world *world, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_own(world->geometry, facet, &own);
    return orl_surface_kind_is_flat(f->kind) && f->area > 0 &&
           orl_material_transmits_lobes(&world->materials[f->material]);
}

/* Lists the ports or, if there are none, free-standing panes. Panes beyond MOST_FREE_PANES are left
 * to the other strategies. */
static bool list_panes(struct orl_aim *aim)
{
    const struct orl_world *world = aim->world;
    aim->n_panes = (uint32_t)world->n_ports;
    if (world->n_ports > 0)
        return true;
    aim->panes = malloc(MOST_FREE_PANES * sizeof *aim->panes);
    for (uint32_t i = 0;
         aim->panes && i < world->geometry->n_facets && aim->n_panes < MOST_FREE_PANES; i++)
        if (is_pane(world, i))
            aim->panes[aim->n_panes++] = i;
    return aim->panes != NULL;
}

static uint32_t pane_facet(const struct orl_aim *aim, uint32_t pane)
{
    return aim->panes ? aim->panes[pane] : aim->world->ports[pane].facet;
}

/* Returns the index of a facet's pane, or ORL_NO_PORT. */
static int32_t pane_of(const struct orl_aim *aim, uint32_t facet)
{
    uint32_t low = 0, high = aim->n_panes;
    if (!aim->panes)
        return orl_world_port_of(aim->world, facet);
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (aim->panes[middle] < facet)
            low = middle + 1;
        else
            high = middle;
    }
    return low < aim->n_panes && aim->panes[low] == facet ? (int32_t)low : ORL_NO_PORT;
}

static int add_shafts(const struct maker *maker, uint32_t pane)
{
    struct orl_aim *aim = maker->aim;
    const struct orl_world *world = aim->world;
    const uint32_t facet = pane_facet(aim, pane);
    if (!is_pane(world, facet))
        return 0;
    for (size_t s = 0; s < world->n_suns; s++) {
        if (!aim->panes && !(orl_dot(world->suns[s].frame.n, world->ports[pane].outward) > 0))
            continue;
        const int beam = find_beam(maker, facet, &world->suns[s]);
        if (beam < 0)
            return beam;
        if (beam < ORL_MOST_BEAMS)
            aim->shafts[aim->n_shafts++] =
                orl_shaft_of(world->geometry, &aim->beams[beam], (uint32_t)beam, facet);
    }
    return 0;
}

int orl_aim_init(struct orl_aim *aim, const struct orl_world *world, const struct orl_sobol *sobol,
                 struct orl_crew *crew)
{
    const struct maker maker = {aim, sobol, crew};
    int code = 0;
    *aim = (struct orl_aim){.world = world};
    if (!list_panes(aim) || orl_targets_init(&aim->targets, world) < 0)
        return ORL_ERR_NOMEM;
    aim->first_shaft = calloc((size_t)aim->n_panes + 1, sizeof *aim->first_shaft);
    if (!aim->first_shaft)
        return ORL_ERR_NOMEM;
    bool lobes = false;
    for (uint32_t i = 0; i < aim->n_panes; i++)
        lobes = lobes || is_pane(world, pane_facet(aim, i));
    if (!lobes || world->n_suns == 0)
        return 0;
    aim->cells = malloc(sizeof *aim->cells);
    aim->beams = calloc(ORL_MOST_BEAMS, sizeof *aim->beams);
    aim->shafts = calloc(aim->n_panes * world->n_suns, sizeof *aim->shafts);
    if (!aim->cells || !aim->beams || !aim->shafts)
        return ORL_ERR_NOMEM;
    orl_beam_cells_init(aim->cells);
    for (uint32_t i = 0; i < aim->n_panes && code == 0; i++) {
        code = add_shafts(&maker, i);
        aim->first_shaft[i + 1] = aim->n_shafts;
    }
    return code;
}

void orl_aim_done(struct orl_aim *aim)
{
    free(aim->first_shaft);
    free(aim->panes);
    free(aim->cells);
    free(aim->beams);
    free(aim->shafts);
    orl_targets_done(&aim->targets);
    *aim = (struct orl_aim){.world = NULL};
}

struct orl_effort orl_aim_effort(const struct orl_aim *aim, struct orl_effort wanted)
{
    if (aim->world->n_ports == 0)
        wanted.rays[ORL_WAY_PORT] = 0;
    if (aim->n_shafts == 0)
        wanted.rays[ORL_WAY_BEAM] = 0;
    if (aim->targets.n == 0)
        wanted.rays[ORL_WAY_TARGET] = 0;
    return wanted;
}

/* Returns the density, per steradian, with which a ray is aimed at the port that it meets. */
static double port_density(const struct orl_aim *aim, const struct orl_hit *hit,
                           struct orl_vec3 direction)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_own(aim->world->geometry, hit->facet, &own);
    const double cosine = fmax(fabs(orl_dot(direction, hit->normal)), 1e-9);
    return hit->distance * hit->distance / (cosine * facet->area * (double)aim->world->n_ports);
}

double orl_aim_port_density(const struct orl_aim *aim, const struct orl_hit *hit,
                            struct orl_vec3 direction)
{
    return orl_world_port_of(aim->world, hit->facet) == ORL_NO_PORT
               ? 0
               : port_density(aim, hit, direction);
}

/* Returns the density, per steradian, of rays drawn along beams. */
static double beam_density(const struct orl_aim *aim, const struct orl_aimed *aimed, int32_t pane,
                           struct orl_vec3 point)
{
    double sum = 0;
    for (uint32_t i = aim->first_shaft[pane]; i < aim->first_shaft[pane + 1]; i++)
        sum += orl_shaft_density(&aim->shafts[i], &aim->beams[aim->shafts[i].beam], aim->cells,
                                 point, aimed->direction);
    return sum / aim->n_shafts;
}

/* The thing that a ray must meet first to count. */
struct goal {
    uint32_t facet;  /* UINT32_MAX: any */
    uint32_t target; /* ORL_NO_TARGET: any */
};

/* Draws a direction by one strategy, and sets what the ray must meet first. */
static bool draw_direction(const struct orl_aim *aim, enum orl_way way, struct orl_vec3 point,
                           struct orl_vec3 normal, const double u[3],
                           struct orl_vec3 *ret_direction, struct goal *ret_goal)
{
    const struct orl_world *world = aim->world;
    const size_t choices[ORL_WAYS] = {1, world->n_ports, aim->n_shafts, aim->targets.n};
    const size_t choice = (size_t)(u[2] * (double)choices[way]);
    *ret_goal = (struct goal){.facet = UINT32_MAX, .target = ORL_NO_TARGET};
    if (way == ORL_WAY_COSINE) {
        *ret_direction = orl_hemisphere_about(normal, u[0], u[1]);
        return true;
    }
    if (way == ORL_WAY_TARGET) {
        ret_goal->target = (uint32_t)choice;
        *ret_direction = orl_target_draw(&aim->targets.at[choice], point, u);
        return true;
    }
    if (way == ORL_WAY_PORT) {
        struct orl_vec3 there, ignored;
        ret_goal->facet = world->ports[choice].facet;
        orl_facet_sample(world->geometry, ret_goal->facet, u, &there, &ignored);
        *ret_direction = orl_normalize(orl_sub(there, point));
        return true;
    }
    const struct orl_shaft *shaft = &aim->shafts[choice];
    ret_goal->facet = shaft->facet;
    return orl_shaft_draw(shaft, &aim->beams[shaft->beam], aim->cells, point, u, ret_direction);
}

static uint32_t target_of(const struct orl_aim *aim, const struct orl_aimed *aimed)
{
    return aimed->met ? orl_targets_of(&aim->targets, aim->world->geometry, aimed->hit.facet)
                      : ORL_NO_TARGET;
}

bool orl_aim_draw(const struct orl_aim *aim, enum orl_way way, struct orl_vec3 point,
                  struct orl_vec3 normal, const double u[3], struct orl_aimed *ret_aimed)
{
    struct goal goal;
    if (!draw_direction(aim, way, point, normal, u, &ret_aimed->direction, &goal) ||
        !(orl_dot(ret_aimed->direction, normal) > 0))
        return false;
    ret_aimed->met = orl_geometry_intersect(aim->world->geometry, point, ret_aimed->direction,
                                            INFINITY, &ret_aimed->hit);
    if (goal.facet != UINT32_MAX)
        return ret_aimed->met && ret_aimed->hit.facet == goal.facet;
    return goal.target == ORL_NO_TARGET || target_of(aim, ret_aimed) == goal.target;
}

double orl_aim_density(const struct orl_aim *aim, const struct orl_effort *effort,
                       struct orl_vec3 point, struct orl_vec3 normal, const struct orl_aimed *aimed)
{
    const double *const rays = effort->rays;
    const int32_t pane = aimed->met ? pane_of(aim, aimed->hit.facet) : ORL_NO_PORT;
    double density = rays[ORL_WAY_COSINE] * orl_dot(aimed->direction, normal) / ORL_PI;
    if (pane != ORL_NO_PORT && rays[ORL_WAY_PORT] > 0)
        density += rays[ORL_WAY_PORT] * port_density(aim, &aimed->hit, aimed->direction);
    if (pane != ORL_NO_PORT && rays[ORL_WAY_BEAM] > 0)
        density += rays[ORL_WAY_BEAM] * beam_density(aim, aimed, pane, point);
    if (!(rays[ORL_WAY_TARGET] > 0))
        return density;
    const uint32_t target = target_of(aim, aimed);
    if (target != ORL_NO_TARGET)
        density += rays[ORL_WAY_TARGET] / aim->targets.n *
                   orl_target_density(&aim->targets.at[target], point, aimed->direction);
    return density;
}

bool orl_aim_sample(const struct orl_aim *aim, const struct orl_effort *effort, enum orl_way way,
                    struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                    struct orl_aimed *ret_aimed)
{
    if (!orl_aim_draw(aim, way, point, normal, u, ret_aimed))
        return false;
    ret_aimed->weight = orl_dot(ret_aimed->direction, normal) /
                        orl_aim_density(aim, effort, point, normal, ret_aimed);
    return true;
}

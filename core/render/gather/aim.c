#include "render/gather/aim.h"

#include <stdlib.h>

#include "scene/material/hemisphere.h"

/* What aims are made with. */
struct maker {
    struct orl_aim *aim;
    const struct orl_sobol *sobol;
    struct orl_crew *crew;
};

/* The beam of a sun in a kind of pane, new where there is none yet. Returns its index, or
 * ORL_MOST_BEAMS where there are so many, or ORL_ERR_NOMEM. */
static int find_beam(const struct maker *maker, uint32_t facet, const struct orl_sun *sun)
{
    struct orl_aim *aim = maker->aim;
    const struct orl_facet *f = &aim->world->geometry->facets[facet];
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

static int add_shafts(const struct maker *maker, const struct orl_port *port)
{
    struct orl_aim *aim = maker->aim;
    const struct orl_world *world = aim->world;
    const struct orl_facet *facet = &world->geometry->facets[port->facet];
    const bool flat = facet->kind == ORL_SURFACE_POLYGON || facet->kind == ORL_SURFACE_RING;
    if (!flat || !orl_material_transmits_lobes(&world->materials[facet->material]))
        return 0;
    for (size_t s = 0; s < world->n_suns; s++) {
        if (!(orl_dot(world->suns[s].frame.n, port->outward) > 0))
            continue;
        const int beam = find_beam(maker, port->facet, &world->suns[s]);
        if (beam < 0)
            return beam;
        if (beam < ORL_MOST_BEAMS)
            aim->shafts[aim->n_shafts++] =
                orl_shaft_of(world->geometry, &aim->beams[beam], (uint32_t)beam, port->facet);
    }
    return 0;
}

int orl_aim_init(struct orl_aim *aim, const struct orl_world *world, const struct orl_sobol *sobol,
                 struct orl_crew *crew)
{
    const struct maker maker = {aim, sobol, crew};
    int code = 0;
    *aim = (struct orl_aim){.world = world};
    aim->first_shaft = calloc(world->n_ports + 1, sizeof *aim->first_shaft);
    if (!aim->first_shaft)
        return ORL_ERR_NOMEM;
    bool lobes = false;
    for (size_t i = 0; i < world->n_ports; i++) {
        const uint32_t m = world->geometry->facets[world->ports[i].facet].material;
        lobes = lobes || orl_material_transmits_lobes(&world->materials[m]);
    }
    if (!lobes || world->n_suns == 0)
        return 0;
    aim->cells = malloc(sizeof *aim->cells);
    aim->beams = calloc(ORL_MOST_BEAMS, sizeof *aim->beams);
    aim->shafts = calloc(world->n_ports * world->n_suns, sizeof *aim->shafts);
    if (!aim->cells || !aim->beams || !aim->shafts)
        return ORL_ERR_NOMEM;
    orl_beam_cells_init(aim->cells);
    for (size_t i = 0; i < world->n_ports && code == 0; i++) {
        code = add_shafts(&maker, &world->ports[i]);
        aim->first_shaft[i + 1] = aim->n_shafts;
    }
    return code;
}

void orl_aim_done(struct orl_aim *aim)
{
    free(aim->first_shaft);
    free(aim->cells);
    free(aim->beams);
    free(aim->shafts);
    *aim = (struct orl_aim){.world = NULL};
}

struct orl_effort orl_aim_effort(const struct orl_aim *aim, struct orl_effort wanted)
{
    if (aim->world->n_ports == 0)
        wanted.rays[ORL_WAY_PORT] = 0;
    if (aim->n_shafts == 0)
        wanted.rays[ORL_WAY_BEAM] = 0;
    return wanted;
}

/* Density, per steradian, with which a ray is aimed at the port it meets. */
static double port_density(const struct orl_aim *aim, const struct orl_aimed *aimed)
{
    const struct orl_facet *facet = &aim->world->geometry->facets[aimed->hit.facet];
    const double cosine = fmax(fabs(orl_dot(aimed->direction, aimed->hit.normal)), 1e-9);
    return aimed->hit.distance * aimed->hit.distance /
           (cosine * facet->area * (double)aim->world->n_ports);
}

/* The same for rays drawn along beams. */
static double beam_density(const struct orl_aim *aim, const struct orl_aimed *aimed,
                           struct orl_vec3 point)
{
    const int32_t port = aim->world->port_of_facet[aimed->hit.facet];
    double sum = 0;
    for (uint32_t i = aim->first_shaft[port]; i < aim->first_shaft[port + 1]; i++)
        sum += orl_shaft_density(&aim->shafts[i], &aim->beams[aim->shafts[i].beam], aim->cells,
                                 point, aimed->direction);
    return sum / aim->n_shafts;
}

/* Draws a direction; ret_facet says what the ray must first meet to count, UINT32_MAX: anything. */
static bool draw(const struct orl_aim *aim, enum orl_way way, struct orl_vec3 point,
                 struct orl_vec3 normal, const double u[3], struct orl_vec3 *ret_direction,
                 uint32_t *ret_facet)
{
    const struct orl_world *world = aim->world;
    const size_t choices = way == ORL_WAY_PORT ? world->n_ports : aim->n_shafts;
    const size_t choice = (size_t)(u[2] * (double)choices);
    if (way == ORL_WAY_COSINE) {
        *ret_facet = UINT32_MAX;
        *ret_direction = orl_hemisphere_about(normal, u[0], u[1]);
        return true;
    }
    if (way == ORL_WAY_PORT) {
        struct orl_vec3 there, ignored;
        *ret_facet = world->ports[choice].facet;
        orl_facet_sample(world->geometry, *ret_facet, u, &there, &ignored);
        *ret_direction = orl_normalize(orl_sub(there, point));
        return true;
    }
    const struct orl_shaft *shaft = &aim->shafts[choice];
    *ret_facet = shaft->facet;
    return orl_shaft_draw(shaft, &aim->beams[shaft->beam], aim->cells, point, u, ret_direction);
}

bool orl_aim_sample(const struct orl_aim *aim, const struct orl_effort *effort, enum orl_way way,
                    struct orl_vec3 point, struct orl_vec3 normal, const double u[3],
                    struct orl_aimed *ret_aimed)
{
    uint32_t facet;
    if (!draw(aim, way, point, normal, u, &ret_aimed->direction, &facet))
        return false;
    const double cosine = orl_dot(ret_aimed->direction, normal);
    if (!(cosine > 0))
        return false;
    ret_aimed->met = orl_geometry_intersect(aim->world->geometry, point, ret_aimed->direction,
                                            INFINITY, &ret_aimed->hit);
    const bool at_port =
        ret_aimed->met && orl_world_port_of(aim->world, ret_aimed->hit.facet) != ORL_NO_PORT;
    if (facet != UINT32_MAX && (!ret_aimed->met || ret_aimed->hit.facet != facet))
        return false;
    double density = effort->rays[ORL_WAY_COSINE] * cosine / ORL_PI;
    if (at_port && effort->rays[ORL_WAY_PORT] > 0)
        density += effort->rays[ORL_WAY_PORT] * port_density(aim, ret_aimed);
    if (at_port && effort->rays[ORL_WAY_BEAM] > 0)
        density += effort->rays[ORL_WAY_BEAM] * beam_density(aim, ret_aimed, point);
    ret_aimed->weight = cosine / density;
    return true;
}

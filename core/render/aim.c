#include "render/aim.h"

#include "scene/hemisphere.h"

static void add_beams(struct orl_aim *aim, const struct orl_port *port)
{
    const struct orl_world *world = aim->world;
    const struct orl_facet *facet = &world->geometry->facets[port->facet];
    const struct orl_material *m = &world->description.materials[facet->material];
    if (!orl_material_transmits_lobes(m))
        return;
    for (uint32_t i = 0; i < aim->n_beams; i++)
        if (aim->beams[i].material == m && orl_dot(aim->beams[i].normal, facet->normal) > 1 - 1e-9)
            return;
    for (size_t s = 0; s < world->n_suns && aim->n_beams < ORL_MOST_BEAMS; s++)
        if (orl_dot(world->suns[s].frame.n, port->outward) > 0)
            aim->beams[aim->n_beams++] =
                (struct orl_beam){m, facet->normal, world->suns[s].frame.n, port->facet};
}

void orl_aim_init(struct orl_aim *aim, const struct orl_world *world)
{
    *aim = (struct orl_aim){.world = world, .by_cosine = 1};
    for (size_t i = 0; i < world->n_ports; i++)
        add_beams(aim, &world->ports[i]);
    if (world->n_ports > 0)
        aim->at_ports = 0.4;
    if (aim->n_beams > 0)
        aim->along_beams = 0.2;
    aim->by_cosine -= aim->at_ports + aim->along_beams;
}

/* Density, per steradian, with which a ray is aimed at the port it meets. */
static double port_density(const struct orl_aim *aim, const struct orl_aimed *aimed)
{
    const struct orl_facet *facet = &aim->world->geometry->facets[aimed->hit.facet];
    const double cosine = fmax(fabs(orl_dot(aimed->direction, aimed->hit.normal)), 1e-9);
    return aimed->hit.distance * aimed->hit.distance /
           (cosine * facet->area * (double)aim->world->n_ports);
}

static bool is_of(const struct orl_aim *aim, const struct orl_beam *beam, const struct orl_hit *hit)
{
    return orl_world_material(aim->world, hit) == beam->material &&
           orl_dot(beam->normal, hit->normal) > 1 - 1e-9;
}

/* The same for rays drawn along beams. */
static double beam_density(const struct orl_aim *aim, const struct orl_aimed *aimed)
{
    double sum = 0;
    for (uint32_t i = 0; i < aim->n_beams; i++) {
        const struct orl_beam *beam = &aim->beams[i];
        if (is_of(aim, beam, &aimed->hit))
            sum += orl_scatter_pdf(beam->material, &aimed->hit, beam->sun, ORL_TRANSPORT_LIGHT,
                                   ORL_LOBE_TRANSMITTED, orl_neg(aimed->direction));
    }
    return aim->n_beams > 0 ? sum / aim->n_beams : 0;
}

/* Draws a direction; ret_beam and ret_facet say what the ray must first meet to count. */
static bool draw(const struct orl_aim *aim, struct orl_vec3 point, struct orl_vec3 normal,
                 const double u[3], struct orl_vec3 *ret_direction,
                 const struct orl_beam **ret_beam, uint32_t *ret_facet)
{
    const struct orl_world *world = aim->world;
    double left = u[2] - aim->by_cosine;
    *ret_beam = NULL;
    *ret_facet = UINT32_MAX;
    if (left < 0 || world->n_ports == 0) {
        *ret_direction = orl_hemisphere_about(normal, u[0], u[1]);
        return true;
    }
    if (left < aim->at_ports || aim->n_beams == 0) {
        const size_t i = (size_t)(fmin(left / aim->at_ports, 1 - 0x1p-53) * (double)world->n_ports);
        struct orl_vec3 there, ignored;
        *ret_facet = world->ports[i].facet;
        orl_facet_sample(world->geometry, *ret_facet, u, &there, &ignored);
        *ret_direction = orl_normalize(orl_sub(there, point));
        return true;
    }
    left = fmin((left - aim->at_ports) / aim->along_beams, 1 - 0x1p-53) * aim->n_beams;
    const struct orl_beam *beam = &aim->beams[(uint32_t)left];
    const struct orl_hit pane = {.facet = beam->facet, .normal = beam->normal};
    const double three[3] = {u[0], u[1], left - floor(left)};
    const struct orl_scatter s = orl_scatter_sample_at(
        beam->material, &pane, beam->sun, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, three);
    *ret_beam = beam;
    *ret_direction = orl_neg(s.direction);
    return s.event == ORL_EVENT_GLOSSY;
}

bool orl_aim_sample(const struct orl_aim *aim, struct orl_vec3 point, struct orl_vec3 normal,
                    const double u[3], struct orl_aimed *ret_aimed)
{
    const struct orl_beam *beam;
    uint32_t facet;
    if (!draw(aim, point, normal, u, &ret_aimed->direction, &beam, &facet))
        return false;
    const double cosine = orl_dot(ret_aimed->direction, normal);
    if (!(cosine > 0))
        return false;
    ret_aimed->met = orl_geometry_intersect(aim->world->geometry, point, ret_aimed->direction,
                                            INFINITY, &ret_aimed->hit);
    const bool at_port =
        ret_aimed->met && aim->world->port_of_facet[ret_aimed->hit.facet] != ORL_NO_PORT;
    if ((facet != UINT32_MAX && (!ret_aimed->met || ret_aimed->hit.facet != facet)) ||
        (beam && (!at_port || !is_of(aim, beam, &ret_aimed->hit))))
        return false;
    double density = aim->by_cosine * cosine / ORL_PI;
    if (at_port)
        density += aim->at_ports * port_density(aim, ret_aimed) +
                   aim->along_beams * beam_density(aim, ret_aimed);
    ret_aimed->weight = cosine / density;
    return true;
}

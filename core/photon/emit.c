#include "photon/emit.h"

#include "photon/guide.h"
#include "photon/map.h"
#include "photon/sunward.h"
#include "photon/table.h"
#include "scene/hemisphere.h"

_Static_assert((int)ORL_SOBOL_BLOCK == (int)ORL_MAP_BATCHES, "a block has one point of each batch");

/* The port as a path meets it from outside. */
static struct orl_hit port_hit(const struct orl_world *world, const struct orl_port *port,
                               struct orl_vec3 point)
{
    return (struct orl_hit){.point = point,
                            .normal = world->geometry->facets[port->facet].normal,
                            .facet = port->facet,
                            .front = port->outside_is_front};
}

/*
 * Light of that radiance times measure arrives at the port from outwards; sends it through. Of a
 * passage, if there is one, for light from there.
 */
static bool pass_port(const struct orl_world *world, const struct orl_port *port,
                      const struct orl_passage *passage, struct orl_vec3 point,
                      struct orl_vec3 outwards, struct orl_rgb flux, struct orl_random *random,
                      struct orl_flight *ret_flight)
{
    const struct orl_hit hit = port_hit(world, port, point);
    if (!orl_port_owns(world, port, point))
        return false;
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const double u[3] = {u0, u1, orl_random_uniform(random)};
    const struct orl_scatter s =
        passage ? orl_passage_sample(passage, outwards, u)
                : orl_scatter_sample_at(orl_world_material(world, &hit), &hit, outwards,
                                        ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, u);
    if (s.event == ORL_EVENT_ABSORBED)
        return false;
    ret_flight->origin = orl_hit_leave(world->geometry, &hit, s.direction);
    ret_flight->direction = s.direction;
    ret_flight->flux = orl_rgb_mul(flux, s.weight);
    ret_flight->way = orl_deflected(ret_flight->way, s.event);
    ret_flight->from_port = true;
    ret_flight->clarity = orl_scatter_clarity(orl_world_material(world, &hit), &s, orl_gray(1));
    return orl_rgb_max(ret_flight->flux) > 0;
}

static bool emit_port_dome(const struct orl_emission *e, const struct orl_stratum *stratum,
                           const double *u, struct orl_random *random, struct orl_health *health,
                           struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    const struct orl_port *port = &world->ports[stratum->port];
    struct orl_vec3 point, normal;
    double at[2];
    orl_facet_sample(world->geometry, port->facet, u + 1, &point, &normal);
    const double density = orl_table_sample(&e->port_tables[stratum->port], u + 3, at);
    const struct orl_vec3 out = orl_hemisphere_about(port->outward, at[0], at[1]);
    const struct orl_vec3 start =
        orl_facet_leave(world->geometry, port->facet, point, normal, port->outward);
    const struct orl_rgb radiance = orl_port_radiance(world, port, start, out, random, health);
    /* The square is uniform in projected solid angle, pi in all. */
    const struct orl_rgb flux = orl_rgb_scale(radiance, ORL_PI * port->area / density);
    return orl_rgb_max(flux) > 0 &&
           pass_port(world, port, NULL, point, out, flux, random, ret_flight);
}

static bool emit_port_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                          bool caustic, const double *u, struct orl_random *random,
                          struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    const struct orl_port *port = &world->ports[stratum->port];
    const struct orl_sun *sun = &world->suns[stratum->sun];
    const struct orl_vec3 towards = orl_sun_sample(sun, u + 3);
    const bool image = stratum->kind == ORL_STRATUM_PORT_IMAGE;
    struct orl_vec3 point, normal, out = towards;
    double place[2] = {u[1], u[2]}, density = 1;
    if (caustic && stratum->place.weight)
        density = orl_table_sample(&stratum->place, u + 1, place);
    orl_facet_sample(world->geometry, port->facet, place, &point, &normal);
    const struct orl_vec3 start =
        orl_facet_leave(world->geometry, port->facet, point, normal, port->outward);
    const struct orl_rgb share =
        image ? orl_mirrored_transmittance(world, start, towards, world->mirrors[stratum->mirror],
                                           false, &out)
        : stratum->shades && !orl_may_be_shaded(stratum->shades, point)
            ? orl_gray(1)
            : orl_transmittance(world, start, towards, INFINITY, false);
    const double cosine = orl_dot(out, port->outward);
    if (!(cosine > 0) || !(orl_rgb_max(share) > 0))
        return false;
    ret_flight->from_light = true;
    ret_flight->way.mirror = image;
    const struct orl_rgb flux =
        orl_rgb_scale(orl_rgb_mul(sun->irradiance, share), cosine * port->area / density);
    return pass_port(world, port, image ? NULL : stratum->passage, point, out, flux, random,
                     ret_flight);
}

/* Uniform over a spotlight's cone; the flux of light of radiance 1 from a unit of area. */
static double spot_direction(const struct orl_material *spot, struct orl_vec3 normal,
                             const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_frame frame = orl_frame_about(spot->aim);
    const double down = u[0] * (1 - spot->cos_cone), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down)), phi = 2 * ORL_PI * u[1];
    *ret_direction = orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
    return 2 * ORL_PI * (1 - spot->cos_cone) * fmax(orl_dot(*ret_direction, normal), 0);
}

static bool emit_emitter(const struct orl_emission *e, const struct orl_stratum *stratum,
                         const double *u, struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    const struct orl_emitter *emitter = &world->emitters[stratum->port];
    const struct orl_facet *facet = &world->geometry->facets[emitter->facet];
    const struct orl_material *m = &world->description.materials[facet->material];
    struct orl_vec3 point, normal;
    double measure = ORL_PI;
    orl_facet_sample(world->geometry, emitter->facet, u + 1, &point, &normal);
    ret_flight->origin = orl_madd(point, normal, facet->offset);
    /* A cone of 60 degrees' half angle holds as much as the cosine's pi. */
    if (m->kind == ORL_MATERIAL_SPOTLIGHT && m->cos_cone > 0.5)
        measure = spot_direction(m, normal, u + 3, &ret_flight->direction);
    else
        ret_flight->direction = orl_hemisphere_about(normal, u[3], u[4]);
    if (!orl_material_beams(m, ret_flight->direction))
        return false;
    ret_flight->flux = orl_rgb_scale(emitter->radiance, measure * facet->area);
    ret_flight->from_light = emitter->direct;
    ret_flight->focus = m->focus;
    return measure > 0;
}

double orl_emission_box_point(const struct orl_geometry *g, struct orl_vec3 towards,
                              const double u[2], struct orl_vec3 *ret_point)
{
    const double pad = g->radius * 1e-4;
    const double low[3] = {g->low.x - pad, g->low.y - pad, g->low.z - pad};
    const double high[3] = {g->high.x + pad, g->high.y + pad, g->high.z + pad};
    const double d[3] = {towards.x, towards.y, towards.z};
    double area[3], total = 0, at[3];
    int face = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        area[k] = fabs(d[k]) * (high[i] - low[i]) * (high[j] - low[j]);
        total += area[k];
    }
    double left = u[0] * total;
    while (face < 2 && left >= area[face])
        left -= area[face++];
    const int i = (face + 1) % 3, j = (face + 2) % 3;
    at[face] = d[face] > 0 ? high[face] : low[face];
    at[i] = low[i] + fmin(area[face] > 0 ? left / area[face] : 0, 1) * (high[i] - low[i]);
    at[j] = low[j] + u[1] * (high[j] - low[j]);
    *ret_point = orl_v3(at[0], at[1], at[2]);
    return total;
}

static bool emit_open(const struct orl_emission *e, const struct orl_stratum *stratum, bool caustic,
                      const double *u, struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    struct orl_vec3 towards;
    struct orl_rgb radiance;
    double measure;
    if (stratum->kind == ORL_STRATUM_OPEN_SUN) {
        towards = orl_sun_sample(&world->suns[stratum->sun], u + 3);
        radiance = world->suns[stratum->sun].radiance;
        measure = world->suns[stratum->sun].solid_angle_sr;
        ret_flight->from_light = true;
    } else {
        double at[2];
        const double density = orl_table_sample(&e->dome_table, u + 3, at);
        const double z = 2 * at[1] - 1, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * ORL_PI * at[0];
        towards = orl_v3(s * cos(phi), s * sin(phi), z);
        radiance = orl_world_dome_radiance(world, towards);
        measure = 4 * ORL_PI / density;
    }
    double place[2] = {u[1], u[2]}, density = 1;
    const struct orl_table *guide = orl_guide_find(e, stratum, caustic, towards);
    if (guide)
        density = orl_table_sample(guide, u + 1, place);
    const double area =
        orl_emission_box_point(world->geometry, towards, place, &ret_flight->origin);
    ret_flight->direction = orl_neg(towards);
    ret_flight->flux = orl_rgb_scale(radiance, measure * area / density);
    return orl_rgb_max(ret_flight->flux) > 0;
}

bool orl_emission_from(const struct orl_emission *emission, const struct orl_stratum *stratum,
                       bool caustic, const double *point, struct orl_random *random,
                       struct orl_health *health, struct orl_flight *ret_flight)
{
    *ret_flight = (struct orl_flight){.fate = orl_random_uniform(random), .reflected = 1};
    switch (stratum->kind) {
    case ORL_STRATUM_PORT_DOME:
        return emit_port_dome(emission, stratum, point, random, health, ret_flight);
    case ORL_STRATUM_PORT_SUN:
    case ORL_STRATUM_PORT_IMAGE:
        return emit_port_sun(emission, stratum, caustic, point, random, ret_flight);
    case ORL_STRATUM_EMITTER:
        return emit_emitter(emission, stratum, point, ret_flight);
    case ORL_STRATUM_OPEN_DOME:
    case ORL_STRATUM_OPEN_SUN:
        return emit_open(emission, stratum, caustic, point, ret_flight);
    }
    return false;
}

static const struct orl_stratum *pick(const struct orl_emission *e, double u, bool caustic)
{
    size_t low = 0, high = e->n_strata;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        const struct orl_stratum *s = &e->strata[middle];
        if ((caustic ? s->below_caustic : s->below) <= u)
            low = middle;
        else
            high = middle;
    }
    return &e->strata[low];
}

void orl_emission_points(const struct orl_emission *emission, uint64_t seed, uint64_t index,
                         bool caustic, struct orl_sobol_block *ret_points)
{
    const uint64_t within = index / ORL_MAP_BATCHES;
    uint32_t sequences[ORL_MAP_BATCHES];
    for (uint64_t batch = 0; batch < ORL_MAP_BATCHES; batch++)
        sequences[batch] =
            (uint32_t)orl_mix64(orl_mix64(seed * 2 + caustic) + batch) + (uint32_t)(within >> 32);
    orl_sobol_block(&emission->sobol, (uint32_t)within, sequences, ret_points);
}

bool orl_emission_sample(const struct orl_emission *emission, const double *point, bool caustic,
                         struct orl_random *random, struct orl_health *health,
                         struct orl_flight *ret_flight)
{
    if (emission->n_strata == 0)
        return false;
    const struct orl_stratum *stratum = pick(emission, point[0], caustic);
    const double share = caustic ? stratum->share_caustic : stratum->share;
    if (!(share > 0) ||
        !orl_emission_from(emission, stratum, caustic, point, random, health, ret_flight))
        return false;
    ret_flight->flux = orl_rgb_scale(ret_flight->flux, 1 / share);
    ret_flight->fate = point[5];
    ret_flight->reflected = caustic ? 1 : stratum->reflected;
    return true;
}

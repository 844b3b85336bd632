#include "photon/flight/emit_freely.h"

#include "photon/flight/guide.h"
#include "photon/flight/parallel_beam.h"
#include "photon/flight/table.h"
#include "scene/material/hemisphere.h"

/* Samples a direction uniformly over a spotlight's cone. Returns the flux for radiance 1 from a
 * unit of area. */
static double spot_direction(const struct orl_material *spot, struct orl_vec3 normal,
                             const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_frame frame = orl_frame_about(spot->aim);
    const double down = u[0] * (1 - spot->cos_cone), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down)), phi = 2 * ORL_PI * u[1];
    *ret_direction = orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
    return 2 * ORL_PI * (1 - spot->cos_cone) * fmax(orl_dot(*ret_direction, normal), 0);
}

bool orl_emit_from_lamp(const struct orl_emission *e, const struct orl_stratum *stratum,
                        const double *u, struct orl_flight *ret_flight)
{
    const struct orl_world *world = e->world;
    const struct orl_emitter *emitter = &world->emitters[stratum->port];
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_own(world->geometry, emitter->facet, &own);
    const struct orl_material *m = &world->materials[facet->material];
    struct orl_vec3 point, normal;
    double measure = ORL_PI;
    orl_facet_sample(world->geometry, emitter->facet, u + 1, &point, &normal);
    ret_flight->origin = orl_madd(point, normal, facet->offset);
    /* A cone of 60 degrees half angle has the solid angle pi, the same as the cosine's measure. */
    if (m->kind == ORL_MATERIAL_SPOTLIGHT && m->cos_cone > 0.5)
        measure = spot_direction(m, normal, u + 3, &ret_flight->direction);
    else
        ret_flight->direction = orl_hemisphere_about(normal, u[3], u[4]);
    if (!orl_material_beams(m, ret_flight->direction))
        return false;
    const struct orl_hit hit = {
        .point = point, .normal = normal, .facet = emitter->facet, .front = true};
    const struct orl_rgb radiance = orl_material_radiance_varies(m)
                                        ? orl_material_emission(m, &hit, ret_flight->direction)
                                        : emitter->radiance;
    ret_flight->flux = orl_rgb_scale(radiance, measure * facet->area);
    ret_flight->from_light = ret_flight->lamp = emitter->direct;
    ret_flight->lamp_facet = emitter->facet;
    ret_flight->focus = m->focus;
    return measure > 0;
}

bool orl_emit_from_sky(const struct orl_emission *e, const struct orl_stratum *stratum,
                       bool caustic, const double *u, struct orl_flight *ret_flight)
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
        ret_flight->sun = stratum->sun;
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
    const double area = orl_beam_point(world->geometry, towards, place, &ret_flight->origin);
    ret_flight->direction = orl_neg(towards);
    ret_flight->flux = orl_rgb_scale(radiance, measure * area / density);
    return orl_rgb_max(ret_flight->flux) > 0;
}

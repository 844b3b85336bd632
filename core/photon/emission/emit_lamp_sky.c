#include "photon/emission/emit_lamp_sky.h"

#include "photon/emission/distribution_2d.h"
#include "photon/emission/emission_importance.h"
#include "photon/emission/parallel_beam.h"
#include "scene/material/hemisphere.h"

/* Samples a direction uniformly over a spotlight's cone. Returns the flux for radiance 1 from a
 * unit of area. */
static double spot_direction(const struct orl_material *spot, struct orl_vec3 normal,
                             const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_frame frame = orl_frame_about(spot->beam_axis);
    const double down = u[0] * (1 - spot->cos_cone), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down)), phi = 2 * ORL_PI * u[1];
    *ret_direction = orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
    return 2 * ORL_PI * (1 - spot->cos_cone) * fmax(orl_dot(*ret_direction, normal), 0);
}

bool orl_emit_from_lamp(const struct orl_emission *e, const struct orl_stratum *stratum,
                        const double *u, struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    const struct orl_emitter *emitter = &lit_scene->emitters[stratum->port];
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    const struct orl_material *m = &lit_scene->materials[facet->material];
    struct orl_vec3 point, normal;
    double measure = ORL_PI;
    orl_facet_sample(lit_scene->geometry, emitter->facet, u + 1, &point, &normal);
    ret_photon_ray->origin = orl_madd(point, normal, facet->offset);
    /* A cone of 60 degrees half angle has the solid angle pi, the same as the cosine's measure. */
    if (m->kind == ORL_MATERIAL_SPOTLIGHT && m->cos_cone > 0.5)
        measure = spot_direction(m, normal, u + 3, &ret_photon_ray->direction);
    else
        ret_photon_ray->direction = orl_hemisphere_about(normal, u[3], u[4]);
    if (!orl_spotlight_covers(m, ret_photon_ray->direction))
        return false;
    const struct orl_hit hit = {
        .point = point, .normal = normal, .facet = emitter->facet, .front = true};
    const struct orl_rgb radiance = orl_material_radiance_varies(m)
                                        ? orl_material_emission(m, &hit, ret_photon_ray->direction)
                                        : emitter->radiance;
    ret_photon_ray->flux = orl_rgb_scale(radiance, measure * facet->area);
    ret_photon_ray->from_light = ret_photon_ray->lamp = emitter->direct;
    ret_photon_ray->lamp_facet = emitter->facet;
    ret_photon_ray->focus = m->focus;
    return measure > 0;
}

bool orl_emit_from_sky(const struct orl_emission *e, const struct orl_stratum *stratum,
                       bool caustic, const double *u, struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    struct orl_vec3 towards;
    struct orl_rgb radiance;
    double measure;
    if (stratum->kind == ORL_STRATUM_OPEN_SUN) {
        towards = orl_sun_sample(&lit_scene->suns[stratum->sun], u + 3);
        radiance = lit_scene->suns[stratum->sun].radiance;
        measure = lit_scene->suns[stratum->sun].solid_angle_sr;
        ret_photon_ray->from_light = true;
        ret_photon_ray->sun = stratum->sun;
    } else {
        double at[2];
        const double pdf = orl_distribution_2d_sample(&e->dome_distribution, u + 3, at);
        const double z = 2 * at[1] - 1, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * ORL_PI * at[0];
        towards = orl_v3(s * cos(phi), s * sin(phi), z);
        radiance = orl_lit_scene_dome_radiance(lit_scene, towards);
        measure = 4 * ORL_PI / pdf;
    }
    double place[2] = {u[1], u[2]}, pdf = 1;
    const struct orl_distribution_2d *importance =
        orl_emission_importance_find(e, stratum, caustic, towards);
    if (importance)
        pdf = orl_distribution_2d_sample(importance, u + 1, place);
    const double area =
        orl_parallel_beam_sample(lit_scene->geometry, towards, place, &ret_photon_ray->origin);
    ret_photon_ray->direction = orl_neg(towards);
    ret_photon_ray->flux = orl_rgb_scale(radiance, measure * area / pdf);
    return orl_rgb_max(ret_photon_ray->flux) > 0;
}

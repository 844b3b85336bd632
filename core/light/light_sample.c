#include "light/direct.h"

/* Samples a sphere from outside, uniformly over the cone that it fills. */
static bool sample_sphere(const struct orl_facet *facet, struct orl_vec3 from, const double u[2],
                          struct orl_light_sample *ret_sample)
{
    const struct orl_vec3 way = orl_sub(facet->quadric->center[0], from);
    const double d2 = orl_dot(way, way), r2 = facet->quadric->radius[0] * facet->quadric->radius[0];
    if (d2 <= r2 * (1 + 1e-9))
        return false;
    const double sine2 = r2 / d2, least_cosine = sqrt(1 - sine2);
    const double down = u[0] * sine2 / (1 + least_cosine), cosine = 1 - down;
    const double sine = sqrt(fmax(0, down * (2 - down))), phi = 2 * ORL_PI * u[1], d = sqrt(d2);
    const struct orl_frame frame = orl_frame_about(orl_scale(way, 1 / d));
    ret_sample->light = orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
    /* Shortens the distance to that of a slightly larger sphere: a ray to the rim has float
     * coordinates and must not hit the lamp itself. */
    const double room = 2 * facet->quadric->radius[0] * (d * 0x1p-20 + facet->offset);
    ret_sample->distance = d * cosine - sqrt(fmax(0, r2 - d2 * sine * sine) + room);
    ret_sample->normal = orl_normalize(orl_sub(
        orl_madd(from, ret_sample->light, ret_sample->distance), facet->quadric->center[0]));
    ret_sample->measure_sr = 2 * ORL_PI * sine2 / (1 + least_cosine);
    return true;
}

/*
 * Returns how far before the sampled point a ray with float coordinates may hit a tube or cone,
 * which is far near the rim. As for spheres, it is the distance to a slightly thicker surface.
 */
static double float_room(const struct orl_facet *facet, const struct orl_light_sample *light_sample)
{
    if (orl_surface_kind_is_flat(facet->kind))
        return 0;
    const struct orl_quadric *const quadric = facet->quadric;
    const double r = orl_larger(quadric->radius[0], quadric->radius[1]);
    const struct orl_vec3 axis = orl_sub(quadric->center[1], quadric->center[0]);
    const double length2 = orl_dot(axis, axis), along = orl_dot(light_sample->light, axis);
    const double across2 = /* squared sine of the ray's angle to the axis; 1 if there is none */
        facet->kind == ORL_SURFACE_BUBBLE || !(length2 > 0) ? 1 : 1 - along * along / length2;
    const double room = 2 * r * (light_sample->distance * 0x1p-20 + facet->offset);
    const double rc = -r * orl_dot(light_sample->light, light_sample->normal);
    return room / (rc + sqrt(rc * rc + orl_larger(across2, 0) * room));
}

/* Samples any other surface uniformly by area. */
static bool sample_area(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter,
                        struct orl_vec3 from, const double u[2],
                        struct orl_light_sample *ret_sample)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    struct orl_vec3 point, normal;
    orl_facet_sample(lit_scene->geometry, emitter->facet, u, &point, &normal);
    const struct orl_vec3 way = orl_sub(point, from);
    const double d2 = orl_dot(way, way), d = sqrt(d2);
    if (!(d > 0))
        return false;
    ret_sample->light = orl_scale(way, 1 / d);
    ret_sample->normal = normal;
    ret_sample->distance = d;
    ret_sample->measure_sr = -orl_dot(ret_sample->light, normal) * facet->area / d2;
    if (!(ret_sample->measure_sr > 0))
        return false;
    ret_sample->distance -= float_room(facet, ret_sample);
    return true;
}

bool orl_light_sample(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter,
                      struct orl_vec3 from, const double u[2], struct orl_light_sample *ret_sample)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    return facet->kind == ORL_SURFACE_SPHERE ? sample_sphere(facet, from, u, ret_sample)
                                             : sample_area(lit_scene, emitter, from, u, ret_sample);
}

double orl_light_pdf_of_hit(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                            struct orl_vec3 from)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, hit->facet, &own);
    const struct orl_vec3 way = orl_sub(hit->point, from);
    const double d2 = orl_dot(way, way);
    if (facet->kind != ORL_SURFACE_SPHERE) {
        const double cosine = fabs(orl_dot(way, hit->normal)) / sqrt(d2);
        return d2 / (cosine * facet->area);
    }
    const struct orl_vec3 to_center = orl_sub(facet->quadric->center[0], from);
    const double r2 = facet->quadric->radius[0] * facet->quadric->radius[0],
                 c2 = orl_dot(to_center, to_center);
    const double sine2 = r2 / c2;
    return c2 > r2 ? (1 + sqrt(1 - sine2)) / (2 * ORL_PI * sine2) : 0;
}

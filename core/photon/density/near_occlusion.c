#include "photon/density/near_occlusion.h"

enum { RAYS = 16, LEAST_BLOCKED = 3 };

/* Most places are open: if none of the first rays hits anything, the others are not traced. With
 * this step the first rays are distributed as evenly as all of them. */
enum { FIRST = 6, STEP = 5 };

/* Sectors between the azimuths of successive rays: about the golden section of all sectors. */
enum { TURN = 13 };

/* Length of the rays in radii. Farther objects blur shadows and sight over more than the
 * estimate's width. */
static const double reach = 2;

/* Returns true if a ray hits an opaque surface. The rays carry equal shares of the light of a
 * uniform sky. */
static bool ray_is_blocked(const struct orl_surface_point *surface_point,
                           const struct orl_frame *frame, int ray, double length)
{
    const struct orl_lit_scene *lit_scene = surface_point->lit_scene;
    const double *azimuth = orl_footprint_azimuths[ray * TURN % ORL_FOOTPRINT_SECTORS];
    const double sine2 = (ray + 0.5) / RAYS, sine = sqrt(sine2), cosine = sqrt(1 - sine2);
    const struct orl_vec3 flat =
        orl_add(orl_scale(frame->u, azimuth[0] * sine), orl_scale(frame->v, azimuth[1] * sine));
    const struct orl_vec3 direction = orl_madd(flat, surface_point->normal, cosine);
    const struct orl_vec3 start =
        orl_facet_ray_origin(lit_scene->geometry, surface_point->facet, surface_point->point,
                             surface_point->normal, direction);
    struct orl_hit hit;
    return orl_geometry_occluded(lit_scene->geometry, start, direction, length) &&
           orl_geometry_intersect(lit_scene->geometry, start, direction, length, &hit) &&
           !orl_material_is_window(orl_lit_scene_material(lit_scene, &hit));
}

bool orl_near_occlusion_test(const struct orl_surface_point *surface_point, double radius)
{
    const struct orl_frame frame = orl_frame_about(surface_point->normal);
    int blocked = 0;
    for (int i = 0; i < RAYS && blocked < LEAST_BLOCKED && (i < FIRST || blocked > 0); i++)
        blocked += ray_is_blocked(surface_point, &frame, i * STEP % RAYS, reach * radius);
    return blocked == LEAST_BLOCKED;
}

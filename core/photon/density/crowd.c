#include "photon/density/crowd.h"

enum { RAYS = 16, CROWD = 3 };

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
static bool ray_is_blocked(const struct orl_footing *footing, const struct orl_frame *frame,
                           int ray, double length)
{
    const struct orl_world *world = footing->world;
    const double *azimuth = orl_footprint_azimuths[ray * TURN % ORL_FOOTPRINT_SECTORS];
    const double sine2 = (ray + 0.5) / RAYS, sine = sqrt(sine2), cosine = sqrt(1 - sine2);
    const struct orl_vec3 flat =
        orl_add(orl_scale(frame->u, azimuth[0] * sine), orl_scale(frame->v, azimuth[1] * sine));
    const struct orl_vec3 direction = orl_madd(flat, footing->normal, cosine);
    const struct orl_vec3 start = orl_facet_leave(world->geometry, footing->facet, footing->point,
                                                  footing->normal, direction);
    struct orl_hit hit;
    return orl_geometry_occluded(world->geometry, start, direction, length) &&
           orl_geometry_intersect(world->geometry, start, direction, length, &hit) &&
           !orl_material_is_window(orl_world_material(world, &hit));
}

bool orl_is_crowded(const struct orl_footing *footing, double radius)
{
    const struct orl_frame frame = orl_frame_about(footing->normal);
    int met = 0;
    for (int i = 0; i < RAYS && met < CROWD && (i < FIRST || met > 0); i++)
        met += ray_is_blocked(footing, &frame, i * STEP % RAYS, reach * radius);
    return met == CROWD;
}

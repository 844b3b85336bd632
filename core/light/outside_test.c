/* Test whether a point is outside a sealed building, by tracing rays from it. */
#include <stdlib.h>

#include "base/sampling/random.h"
#include "light/lit_scene.h"
#include "scene/material/hemisphere.h"

enum { RAYS = 32, BOUNCES = 64, MARGIN = 2 };

/* Numbers of ports that rays met by their outer and by their inner faces. */
struct vote_counts {
    int outside, inside;
};

static struct orl_vec3 direction_of(int ray)
{
    const double z = 1 - (2 * ray + 1.0) / RAYS, s = sqrt(1 - z * z);
    const double phi = 2.399963229728653 * ray;
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/* Counts a hit of a port, also of one that is closed temporarily. Returns true if it is one. */
static bool count_port(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                       struct vote_counts *vote_counts)
{
    const enum orl_port_crossing crossing = orl_scene_crossing(lit_scene->scene, hit);
    vote_counts->outside += crossing == ORL_CROSSING_INWARDS;
    vote_counts->inside += crossing == ORL_CROSSING_OUTWARDS;
    return crossing != ORL_CROSSING_NONE;
}

/* Follows a diffuse path from the point. It stays on its side of the surfaces until it meets a
 * port or leaves the scene. Windows that are not ports let it through. */
static void trace_walk(const struct orl_lit_scene *lit_scene, struct orl_vec3 point, int ray,
                       struct vote_counts *vote_counts)
{
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, (uint64_t)ray);
    struct orl_vec3 direction = direction_of(ray);
    for (int bounce = 0; bounce < BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(lit_scene->geometry, point, direction, INFINITY, &hit)) {
            vote_counts->outside++;
            return;
        }
        if (count_port(lit_scene, &hit, vote_counts))
            return;
        if (!orl_material_is_window(orl_scene_material(lit_scene->scene, hit.facet))) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            direction = orl_hemisphere_about(orl_hit_facing(&hit), u, v);
        }
        point = orl_hit_ray_origin(lit_scene->geometry, &hit, direction);
    }
}

/*
 * No point inside sees past the walls, and most points outside do. Points outside that do not,
 * between slats and the pane behind them, see a pane's outer face.
 */
bool orl_lit_scene_is_outside(const struct orl_lit_scene *lit_scene, struct orl_vec3 point)
{
    struct vote_counts vote_counts = {0, 0};
    if (lit_scene->open)
        return false;
    for (int i = 0; i < RAYS; i++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(lit_scene->geometry, point, direction_of(i), INFINITY, &hit))
            return true;
        count_port(lit_scene, &hit, &vote_counts);
    }
    for (int i = 0; i < RAYS && abs(vote_counts.outside - vote_counts.inside) < MARGIN; i++)
        trace_walk(lit_scene, point, i, &vote_counts);
    return vote_counts.outside > vote_counts.inside;
}

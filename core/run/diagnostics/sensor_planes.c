/* Finds sensors in the plane of a surface that they do not face, such as a wall for a sensor that
 * looks up: rounding decides on which side of it they lie. */
#include <math.h>
#include <stdio.h>

#include "run/diagnostics/sensor_places.h"
#include "scene/built/scene.h"
#include "scene/geometry/surface_offset.h"

/* Distance from a surface at which a sensor is clear of it, in units of the geometry's
 * resolution. */
static const double clear_of_surfaces = 10;
/* A sensor that faces a surface by more than this cosine is moved off it (surface_offset.h). */
static const double faces_from = 0.25;

/* Tests for a surface along a direction, from one resolution behind the point to one ahead of
 * it. */
static bool touches_along(const struct orl_geometry *g, struct orl_vec3 point,
                          struct orl_vec3 normal, struct orl_vec3 direction,
                          struct orl_surface_contact *ret_touch)
{
    const double span = orl_geometry_resolution(g);
    struct orl_hit hit;
    if (!orl_geometry_intersect(g, orl_madd(point, direction, -span), direction, 2 * span, &hit) ||
        fabs(orl_dot(hit.normal, normal)) > faces_from)
        return false;
    const double height = fabs(orl_dot(orl_sub(hit.point, point), hit.normal));
    *ret_touch = (struct orl_surface_contact){hit.facet, height};
    return height <= span;
}

/* Returns true if a surface contains the sensor. Two orthogonal directions suffice for planes of
 * any orientation. */
static bool lies_in_plane(const struct orl_geometry *g, const struct orl_sensor *sensor,
                          struct orl_surface_contact *ret_touch)
{
    const struct orl_vec3 normal = orl_normalize(sensor->direction);
    const struct orl_vec3 point =
        orl_offset_from_surface(g, orl_sub(sensor->position, g->center), normal);
    const struct orl_frame frame = orl_frame_about(normal);
    return touches_along(g, point, normal, frame.u, ret_touch) ||
           touches_along(g, point, normal, frame.v, ret_touch);
}

bool orl_run_lies_in_plane(const struct orl_scene *scene, const struct orl_sensor *sensor)
{
    struct orl_surface_contact touch;
    return lies_in_plane(scene->geometry, sensor, &touch);
}

bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_thread_pool *pool, char *ret_text,
                                        size_t size)
{
    enum { POLL = 1024 };
    const struct orl_geometry *g = scene->geometry;
    struct orl_surface_contact touch = {0}, first = {0};
    size_t count = 0, first_index = 0;
    for (size_t i = 0; i < n; i++) {
        if (i % POLL == 0 && orl_thread_pool_cancelled(pool))
            return false;
        if (!lies_in_plane(g, &sensors[i], &touch) || count++ > 0)
            continue;
        first = touch;
        first_index = i;
    }
    if (count == 0)
        return false;
    const struct orl_surface_label label = orl_scene_label_of(scene, first.facet);
    const struct orl_vec3 at = sensors[first_index].position;
    snprintf(ret_text, size,
             "%zu of %zu sensors: the sensor lies in the plane of a surface; the first, number %zu "
             "at (%.6g, %.6g, %.6g), %.2g m from '%.100s' (%.100s:%d): which side it measures is "
             "chance; move it at least %.1g m away from the surface",
             count, n, first_index + 1, at.x, at.y, at.z, first.distance, label.name, label.file,
             label.line, clear_of_surfaces * orl_geometry_resolution(g));
    return true;
}

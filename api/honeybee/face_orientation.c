#include "honeybee/model_objects.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_FACES = 256, MOST_CORNERS_TRIED = 64 };

/* A face, its normal, and two axes; the face's projection onto their plane has an area. */
struct face_polygon {
    struct orl_hb_polygon polygon;
    struct orl_vec3 normal;
    int u, v;
};

static double coordinate_of(struct orl_vec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* Returns true if a point in the face's plane is inside the face; holes are outside. */
static bool is_inside(const struct face_polygon *face_polygon, struct orl_vec3 point)
{
    const struct orl_hb_polygon *polygon = &face_polygon->polygon;
    const double u = coordinate_of(point, face_polygon->u),
                 v = coordinate_of(point, face_polygon->v);
    bool inside = false;
    for (size_t loop = 0, from = 0; loop < polygon->n_loops; from = polygon->ends[loop++])
        for (size_t i = from, before = polygon->ends[loop] - 1; i < polygon->ends[loop];
             before = i++) {
            const struct orl_vec3 a = polygon->points[before], b = polygon->points[i];
            const double av = coordinate_of(a, face_polygon->v),
                         bv = coordinate_of(b, face_polygon->v);
            if ((av > v) != (bv > v) &&
                u < coordinate_of(a, face_polygon->u) +
                        (v - av) / (bv - av) *
                            (coordinate_of(b, face_polygon->u) - coordinate_of(a, face_polygon->u)))
                inside = !inside;
        }
    return inside;
}

/* Finds a point inside the face, near a corner and off the centre, so that lines through it
 * miss edges of similar faces. */
static bool find_inside(const struct face_polygon *face_polygon, struct orl_vec3 *ret_point)
{
    const struct orl_vec3 *p = face_polygon->polygon.points;
    const size_t n = face_polygon->polygon.n_loops > 0 ? face_polygon->polygon.ends[0] : 0;
    for (size_t i = 0; i < n && i < MOST_CORNERS_TRIED; i++) {
        *ret_point = orl_add(orl_add(orl_scale(p[(i + n - 1) % n], 0.41), orl_scale(p[i], 0.32)),
                             orl_scale(p[(i + 1) % n], 0.27));
        if (is_inside(face_polygon, *ret_point))
            return true;
    }
    return false;
}

static bool faces_inwards(const struct face_polygon *face_polygons, size_t n, size_t which,
                          double tolerance)
{
    const struct face_polygon *own = &face_polygons[which];
    size_t ahead = 0, behind = 0;
    struct orl_vec3 point;
    if (!find_inside(own, &point))
        return false;
    for (size_t i = 0; i < n; i++) {
        const double slope = orl_dot(own->normal, face_polygons[i].normal);
        if (i == which || fabs(slope) < 1e-6)
            continue;
        const double way =
            orl_dot(orl_sub(face_polygons[i].polygon.points[0], point), face_polygons[i].normal) /
            slope;
        if (fabs(way) > tolerance &&
            is_inside(&face_polygons[i], orl_add(point, orl_scale(own->normal, way))))
            *(way > 0 ? &ahead : &behind) += 1;
    }
    return ahead % 2 == 1 && behind % 2 == 0;
}

static int read_side(struct orl_hb *hb, const json_t *face, const struct orl_hb_at *at,
                     struct face_polygon *face_polygon)
{
    const int rc =
        orl_hb_polygon_read(hb, json_object_get(face, "geometry"), at, &face_polygon->polygon);
    if (rc)
        return rc;
    face_polygon->normal = orl_hb_polygon_normal(&face_polygon->polygon);
    const double x = fabs(face_polygon->normal.x), y = fabs(face_polygon->normal.y),
                 z = fabs(face_polygon->normal.z);
    face_polygon->u = x > y && x > z ? 1 : 0;
    face_polygon->v = z > x && z > y ? 1 : 2;
    return 0;
}

int orl_hb_inward_faces(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                        bool **ret_inward)
{
    struct orl_hb_walk faces;
    *ret_inward = NULL;
    int rc = orl_hb_walk(hb, room, at, "faces", &faces);
    const size_t n = rc ? 0 : json_array_size(faces.array);
    if (n == 0 || n > MOST_FACES)
        return rc;
    struct face_polygon *face_polygons = calloc(n, sizeof *face_polygons);
    bool *inward = calloc(n, sizeof *inward);
    size_t count = 0;
    if (!face_polygons || !inward) {
        free(face_polygons);
        free(inward);
        return orl_error_no_memory(hb->err);
    }
    for (const json_t *face; rc == 0 && (face = orl_hb_next(&faces));)
        rc = read_side(hb, face, &faces.here, &face_polygons[count++]);
    for (size_t i = 0; i < count && rc == 0; i++)
        inward[i] = faces_inwards(face_polygons, count, i, hb->tolerance);
    for (size_t i = 0; i < count; i++)
        orl_hb_polygon_done(&face_polygons[i].polygon);
    free(face_polygons);
    if (rc) {
        free(inward);
        return rc;
    }
    *ret_inward = inward;
    return 0;
}

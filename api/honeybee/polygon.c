#include "honeybee/model_objects.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>

/* ---- Reading --------------------------------------------------------------------------------- */

void orl_hb_polygon_done(struct orl_hb_polygon *polygon)
{
    free(polygon->points);
    free(polygon->ends);
    *polygon = (struct orl_hb_polygon){0};
}

static int add_loop(struct orl_hb *hb, const json_t *corners, const struct orl_hb_at *at,
                    struct orl_hb_polygon *polygon)
{
    const size_t n = json_array_size(corners);
    int rc = 0;
    if (n < 3)
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "three points or more are expected here");
    if (!orl_array_reserve_more(&polygon->points, &polygon->point_room, polygon->n_points, n,
                                sizeof *polygon->points) ||
        !orl_array_reserve(&polygon->ends, &polygon->loop_room, polygon->n_loops,
                           sizeof *polygon->ends))
        return orl_error_no_memory(hb->err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        const struct orl_hb_at here = {at, NULL, i};
        rc = orl_hb_point(hb, json_array_get(corners, i), &here,
                          &polygon->points[polygon->n_points + i]);
    }
    if (rc == 0) {
        polygon->n_points += n;
        polygon->ends[polygon->n_loops++] = polygon->n_points;
    }
    return rc;
}

int orl_hb_polygon_add_hole(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                            struct orl_hb_polygon *polygon)
{
    const struct orl_hb_at here = {at, "geometry", 0}, boundary = {&here, "boundary", 0};
    return add_loop(hb, json_object_get(geometry, "boundary"), &boundary, polygon);
}

/* Orders the corners by the plane's normal, if there is one. */
static int orient_by_plane(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *here,
                           struct orl_hb_polygon *polygon)
{
    const struct orl_hb_at in_plane = {here, "plane", 0}, in_normal = {&in_plane, "n", 0};
    const json_t *plane = orl_hb_get(geometry, "plane");
    struct orl_vec3 normal;
    const int rc = plane ? orl_hb_point(hb, json_object_get(plane, "n"), &in_normal, &normal) : 0;
    if (rc == 0 && plane)
        orl_hb_polygon_orient(polygon, normal);
    return rc;
}

int orl_hb_polygon_read(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                        struct orl_hb_polygon *polygon)
{
    const struct orl_hb_at here = {at, "geometry", 0};
    struct orl_hb_walk holes = {0};
    polygon->n_points = polygon->n_loops = 0;
    int rc = orl_hb_polygon_add_hole(hb, geometry, at, polygon);
    if (rc == 0)
        rc = orient_by_plane(hb, geometry, &here, polygon);
    if (rc == 0)
        rc = orl_hb_walk(hb, geometry, &here, "holes", &holes);
    for (const json_t *hole; rc == 0 && (hole = orl_hb_next(&holes));)
        rc = add_loop(hb, hole, &holes.here, polygon);
    return rc;
}

/* ---- Geometry of loops ----------------------------------------------------------------------- */

static size_t begin_of(const struct orl_hb_polygon *p, size_t loop)
{
    return loop > 0 ? p->ends[loop - 1] : 0;
}

/* Returns twice the area along the normal (Newell's sum). Corners are relative to the first
 * one, so that distant coordinates lose no digits. */
static struct orl_vec3 area_of(const struct orl_hb_polygon *p, size_t loop)
{
    const size_t from = begin_of(p, loop), to = p->ends[loop];
    struct orl_vec3 sum = orl_v3(0, 0, 0);
    for (size_t i = from + 1; i + 1 < to; i++)
        sum = orl_add(sum, orl_cross(orl_sub(p->points[i], p->points[from]),
                                     orl_sub(p->points[i + 1], p->points[from])));
    return sum;
}

struct orl_vec3 orl_hb_polygon_normal(const struct orl_hb_polygon *polygon)
{
    const struct orl_vec3 area = area_of(polygon, 0);
    const double length = orl_length(area);
    return length > 0 ? orl_scale(area, 1 / length) : orl_v3(0, 0, 0);
}

/* Reverses the boundary only: holes are written in the opposite order to it anyway. */
void orl_hb_polygon_orient(struct orl_hb_polygon *polygon, struct orl_vec3 front)
{
    if (!(orl_dot(area_of(polygon, 0), front) < 0))
        return;
    for (size_t i = 0, j = polygon->ends[0] - 1; i < j; i++, j--) {
        const struct orl_vec3 corner = polygon->points[i];
        polygon->points[i] = polygon->points[j];
        polygon->points[j] = corner;
    }
}

void orl_hb_polygon_offset(struct orl_hb_polygon *polygon, struct orl_vec3 by)
{
    for (size_t i = 0; i < polygon->n_points; i++)
        polygon->points[i] = orl_add(polygon->points[i], by);
}

/* ---- The order of holes ---------------------------------------------------------------------- */

struct hole {
    size_t loop;
    double at[2]; /* first corner, in two of the axes */
    long strip;
};

static int compare_along(const void *a, const void *b)
{
    const struct hole *x = a, *y = b;
    return x->at[0] < y->at[0] ? -1 : x->at[0] > y->at[0];
}

/* Orders upwards in one strip, downwards in the next. */
static int compare_strips(const void *a, const void *b)
{
    const struct hole *x = a, *y = b;
    const int order = x->at[1] < y->at[1] ? -1 : x->at[1] > y->at[1];
    return x->strip != y->strip ? (x->strip < y->strip ? -1 : 1)
           : order == 0         ? (x->loop < y->loop ? -1 : 1)
           : x->strip % 2 == 0  ? order
                                : -order;
}

/* Orders holes in strips; there are about as many strips as holes in a strip. */
static void order_holes(const struct orl_hb_polygon *p, struct hole *holes, size_t n)
{
    const struct orl_vec3 area = area_of(p, 0);
    const double x = fabs(area.x), y = fabs(area.y), z = fabs(area.z);
    const size_t each = 1 + (size_t)sqrt((double)n);
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 q = p->points[begin_of(p, i + 1)];
        holes[i].loop = i + 1;
        holes[i].at[0] = x > y && x > z ? q.y : q.x;
        holes[i].at[1] = z > x && z > y ? q.y : q.z;
    }
    qsort(holes, n, sizeof *holes, compare_along);
    for (size_t i = 0; i < n; i++)
        holes[i].strip = (long)(i / each);
    qsort(holes, n, sizeof *holes, compare_strips);
}

/* ---- Writing --------------------------------------------------------------------------------- */

void orl_hb_put_point(struct orl_vec3 point, FILE *stream)
{
    fprintf(stream, "\n%.17g %.17g %.17g", point.x, point.y, point.z);
}

void orl_hb_put_name(const char *name, FILE *stream)
{
    enum { MOST = 100 };
    for (size_t i = 0; name[i] && i < MOST; i++) {
        const unsigned char c = (unsigned char)name[i];
        fputc(c < 0x80 && (isalnum(c) || strchr("._-", c)) ? c : '_', stream);
    }
}

/* Writes all corners of a hole and the first again, in the opposite direction to the boundary. */
static void put_hole(const struct orl_hb_polygon *p, size_t loop, FILE *stream)
{
    const size_t from = begin_of(p, loop), n = p->ends[loop] - from;
    const bool turn = orl_dot(area_of(p, 0), area_of(p, loop)) > 0;
    for (size_t i = 0; n > 0 && i <= n; i++)
        orl_hb_put_point(p->points[from + (turn ? n - i : i) % n], stream);
}

static void put_holes(const struct orl_hb_polygon *p, const struct hole *holes, size_t n,
                      FILE *stream)
{
    orl_hb_put_point(p->points[0], stream);
    for (size_t i = 0; i < n; i++)
        put_hole(p, holes[i].loop, stream);
    for (size_t i = n - 1; i-- > 0;)
        orl_hb_put_point(p->points[begin_of(p, holes[i].loop)], stream);
}

int orl_hb_polygon_write(struct orl_hb *hb, const struct orl_hb_polygon *polygon,
                         const char *modifier, const char *name, struct orl_hb_file *file)
{
    const size_t holes = polygon->n_loops - 1;
    /* The outline visits every hole and returns. Repeated corners: the boundary's first, the
     * closing corner of each hole, and on the way back the first corner of each hole but the
     * last. */
    const size_t corners = polygon->n_points + (holes > 0 ? 2 * holes : 0);
    struct hole *order = NULL;
    if (holes > 0) {
        order = malloc(holes * sizeof *order);
        if (!order)
            return orl_error_no_memory(hb->err);
        order_holes(polygon, order, holes);
    }
    fprintf(file->stream, "%s polygon ", modifier);
    orl_hb_put_name(name, file->stream);
    fprintf(file->stream, "\n0\n0\n%zu", 3 * corners);
    for (size_t i = 0; i < polygon->ends[0]; i++)
        orl_hb_put_point(polygon->points[i], file->stream);
    if (holes > 0)
        put_holes(polygon, order, holes, file->stream);
    fputs("\n\n", file->stream);
    free(order);
    return orl_hb_check(hb, file);
}

#include "render/heat_map/heat_map.h"

#include <stdlib.h>
#include <string.h>

/* Limit of the planes tried before the largest are chosen; it bounds the time. */
enum { MOST_TRIED = 64 };
/* Tolerances of a plane and of a grid line, as shares of the extent of all sensors. */
static const double plane_width = 1e-4, line_width = 1e-3;
/* Least cosine between normals of one plane. */
static const double alike = 0.9999;

static double extent_of(const struct orl_sensor *sensors, size_t n)
{
    struct orl_vec3 low = sensors[0].position, high = low;
    for (size_t i = 1; i < n; i++) {
        const struct orl_vec3 p = sensors[i].position;
        low = orl_v3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = orl_v3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    return orl_length(orl_sub(high, low));
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double turned(const double at[2], double angle, int axis)
{
    return axis == 0 ? at[0] * cos(angle) + at[1] * sin(angle)
                     : at[1] * cos(angle) - at[0] * sin(angle);
}

/* Finds the lines of a grid along one axis. Returns their number and sets their median spacing. */
static size_t find_lines(const struct orl_sensor_plane *p, double angle, int axis, double width,
                         double *scratch, double *ret_apart)
{
    size_t lines = 1;
    for (size_t i = 0; i < p->count; i++)
        scratch[i] = turned(p->at[i], angle, axis);
    qsort(scratch, p->count, sizeof *scratch, by_value);
    for (size_t i = 1; i < p->count; i++)
        if (scratch[i] - scratch[lines - 1] > width)
            scratch[lines++] = scratch[i];
    for (size_t i = 0; i + 1 < lines; i++)
        scratch[i] = scratch[i + 1] - scratch[i];
    qsort(scratch, lines - 1, sizeof *scratch, by_value);
    *ret_apart = lines > 1 ? scratch[(lines - 1) / 2] : 0;
    return lines;
}

/* Returns the direction to the nearest neighbour of one sensor, reduced to a quarter turn. */
static double find_angle(const struct orl_sensor_plane *p)
{
    const double *from = p->at[p->count / 2];
    double least = INFINITY, angle = 0;
    for (size_t i = 0; i < p->count; i++) {
        const double du = p->at[i][0] - from[0], dv = p->at[i][1] - from[1];
        const double off = hypot(du, dv);
        if (i != p->count / 2 && off > 0 && off < least) {
            least = off;
            angle = atan2(dv, du);
        }
    }
    angle = fmod(angle + ORL_PI, ORL_PI / 2);
    return angle > ORL_PI / 2 - 1e-6 || angle < 1e-6 ? 0 : angle;
}

static void bound_cells(struct orl_sensor_plane *p)
{
    const double c = fabs(cos(p->angle)), s = fabs(sin(p->angle));
    const double half[2] = {(p->cell[0] * c + p->cell[1] * s) / 2,
                            (p->cell[0] * s + p->cell[1] * c) / 2};
    for (int axis = 0; axis < 2; axis++) {
        p->low[axis] = INFINITY;
        p->high[axis] = -INFINITY;
        for (size_t i = 0; i < p->count; i++) {
            p->low[axis] = fmin(p->low[axis], p->at[i][axis] - half[axis]);
            p->high[axis] = fmax(p->high[axis], p->at[i][axis] + half[axis]);
        }
    }
}

static void make_squares(struct orl_sensor_plane *p)
{
    p->cell[0] = p->cell[1] = 0;
    p->angle = 0;
    bound_cells(p);
    const double wide = p->high[0] - p->low[0], high = p->high[1] - p->low[1];
    /* Sensors nearly in a row have almost no area: use the row's length. */
    p->cell[0] = p->cell[1] =
        fmax(sqrt(wide * high / (double)p->count), fmax(wide, high) / (double)p->count);
}

/* Finds the cells. A grid may have up to twice as many positions as there are sensors, for rooms
 * that are no rectangles and omitted positions. */
static int find_cells(struct orl_sensor_plane *p, double extent)
{
    double *scratch = malloc((p->count + 1) * sizeof *scratch);
    size_t lines[2];
    if (!scratch)
        return ORL_ERR_NOMEM;
    p->angle = find_angle(p);
    for (int axis = 0; axis < 2; axis++)
        lines[axis] = find_lines(p, p->angle, axis, line_width * extent, scratch, &p->cell[axis]);
    free(scratch);
    p->grid = lines[0] > 1 && lines[1] > 1 &&
              (double)lines[0] * (double)lines[1] <= 2.0 * (double)p->count;
    if ((lines[0] > 1) != (lines[1] > 1)) /* a row of squares */
        p->cell[0] = p->cell[1] = fmax(p->cell[0], p->cell[1]);
    else if (!p->grid)
        make_squares(p);
    bound_cells(p);
    return 0;
}

/* ---- Planes ---------------------------------------------------------------------------------- */

static void set_axes(struct orl_sensor_plane *p)
{
    if (fabs(p->normal.z) > alike) {
        p->u = orl_v3(1, 0, 0);
        p->v = orl_v3(0, 1, 0);
        return;
    }
    p->u = orl_normalize(orl_cross(orl_v3(0, 0, 1), p->normal));
    p->v = orl_cross(p->normal, p->u);
}

/* Takes sensor `first` and all others in its plane; *ret_plane receives them. */
static int take_plane(const struct orl_sensor *sensors, size_t n, size_t first, double extent,
                      bool *taken, struct orl_sensor_plane *ret_plane)
{
    struct orl_sensor_plane p = {.normal = orl_normalize(sensors[first].direction)};
    p.offset = orl_dot(p.normal, sensors[first].position);
    set_axes(&p);
    p.sensors = calloc(n, sizeof *p.sensors);
    p.at = calloc(n, sizeof *p.at);
    *ret_plane = p;
    if (!p.sensors || !p.at)
        return ORL_ERR_NOMEM;
    for (size_t i = first; i < n; i++) {
        const struct orl_vec3 at = sensors[i].position;
        if (taken[i] || fabs(orl_dot(p.normal, at) - p.offset) > plane_width * extent ||
            orl_dot(p.normal, orl_normalize(sensors[i].direction)) < alike)
            continue;
        taken[i] = true;
        p.sensors[p.count] = i;
        p.at[p.count][0] = orl_dot(p.u, at);
        p.at[p.count++][1] = orl_dot(p.v, at);
    }
    *ret_plane = p;
    return 0;
}

static void plane_done(struct orl_sensor_plane *plane)
{
    free(plane->sensors);
    free(plane->at);
    *plane = (struct orl_sensor_plane){.count = 0};
}

void orl_sensor_planes_done(struct orl_sensor_plane *planes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        plane_done(&planes[i]);
}

/* Inserts a plane among the largest so far, or frees it. */
static void keep_largest(struct orl_sensor_plane *planes, size_t most, size_t *count,
                         struct orl_sensor_plane *plane)
{
    size_t at = *count;
    while (at > 0 && planes[at - 1].count < plane->count)
        at--;
    if (at == most || plane->count < ORL_LEAST_IN_PLANE) {
        plane_done(plane);
        return;
    }
    if (*count == most)
        plane_done(&planes[--*count]);
    memmove(planes + at + 1, planes + at, (*count - at) * sizeof *planes);
    planes[at] = *plane;
    ++*count;
}

int orl_sensor_planes_find(const struct orl_sensor *sensors, size_t n, size_t most,
                           struct orl_sensor_plane *ret_planes, size_t *ret_count)
{
    bool *taken = calloc(n + 1, sizeof *taken);
    int code = taken ? 0 : ORL_ERR_NOMEM;
    const double extent = n > 0 ? extent_of(sensors, n) : 0;
    int tried = 0;
    *ret_count = 0;
    for (size_t i = 0; i < n && code == 0 && tried < MOST_TRIED && extent > 0; i++) {
        struct orl_sensor_plane plane;
        if (taken[i])
            continue;
        code = take_plane(sensors, n, i, extent, taken, &plane);
        if (code == 0)
            keep_largest(ret_planes, most, ret_count, &plane);
        else
            plane_done(&plane);
        tried++;
    }
    free(taken);
    for (size_t i = 0; i < *ret_count && code == 0; i++)
        code = find_cells(&ret_planes[i], extent);
    return code;
}

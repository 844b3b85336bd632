/*
 * Groups sensors that lie in a plane, and gives each of them a cell there.
 *
 * A plane has its own axes. A level one has x and y of the scene, as a plan is drawn. Any other has
 * u horizontal and v upwards, seen from the side that the sensors face. Sensors on a grid, which
 * may be rotated, stand for its cells. Sensors in one row stand for squares as wide as their
 * spacing. Others stand for squares of the mean area per sensor.
 */
#ifndef ORL_RENDER_HEAT_MAP_PLANES_H
#define ORL_RENDER_HEAT_MAP_PLANES_H

#include <oriel/job/run.h>

enum { ORL_LEAST_IN_PLANE = 4 }; /* smallest number of sensors for a map */

struct orl_sensor_plane {
    struct orl_vec3 normal, u, v; /* unit */
    double offset;                /* distance from the origin along the normal, scene units */
    size_t *sensors;              /* indices of its sensors, owned */
    double (*at)[2];              /* their positions in u and v, owned */
    size_t count;
    bool grid;              /* true if they lie on a grid */
    double angle;           /* rotation of the cells, radians anticlockwise from u */
    double cell[2];         /* sides of a cell along its own axes */
    double low[2], high[2]; /* bounds of the cells, u and v */
};

/* Finds planes and returns up to `most` of them, those with the most sensors first. Sensors are in
 * the job's coordinates. Returns 0 or ORL_ERR_NOMEM; call orl_sensor_planes_done in either case. */
int orl_sensor_planes_find(const struct orl_sensor *sensors, size_t n, size_t most,
                           struct orl_sensor_plane *ret_planes, size_t *ret_count);
void orl_sensor_planes_done(struct orl_sensor_plane *planes, size_t count);

#endif

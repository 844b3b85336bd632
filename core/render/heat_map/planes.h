/*
 * Sensors that lie in a plane, and what each of them stands for there.
 *
 * A plane has axes of its own: of a level one x and y of the scene, so that it is seen as a plan is
 * drawn; of any other u level and v upwards, as seen from where the sensors look. Sensors on a
 * grid, which may be turned, stand for its cells; those in one row for squares as wide as they are
 * apart; others for squares, of as much area as there is for one.
 */
#ifndef ORL_RENDER_HEAT_MAP_PLANES_H
#define ORL_RENDER_HEAT_MAP_PLANES_H

#include <oriel/run.h>

enum { ORL_LEAST_IN_PLANE = 4 }; /* fewer sensors are no map */

struct orl_sensor_plane {
    struct orl_vec3 normal, u, v; /* unit */
    double offset;                /* of its points along the normal, scene units */
    size_t *sensors;              /* which; owned */
    double (*at)[2];              /* where, by u and v; owned */
    size_t count;
    bool grid;              /* they lie on one: */
    double angle;           /* that it is turned by, radians anticlockwise from u */
    double cell[2];         /* the sides of a cell along its own axes */
    double low[2], high[2]; /* bounds of the cells, u and v */
};

/* The planes of the most sensors first, at most so many. Sensors are as jobs have them. Returns 0
 * or ORL_ERR_NOMEM; orl_sensor_planes_done in either case. */
int orl_sensor_planes_find(const struct orl_sensor *sensors, size_t n, size_t most,
                           struct orl_sensor_plane *ret_planes, size_t *ret_count);
void orl_sensor_planes_done(struct orl_sensor_plane *planes, size_t count);

#endif

/* Maps of sensors in planes over the plan of the scene: groups of sensors, sections of the scene,
 * and the maps. */
#ifndef ORL_RENDER_HEAT_MAP_HEAT_MAP_H
#define ORL_RENDER_HEAT_MAP_HEAT_MAP_H

#include <oriel/base/canvas.h>
#include <oriel/job/run.h>

#include "render/picture/false_color.h"
#include "scene/geometry/geometry.h"

/*
 * Groups sensors that lie in a plane, and gives each of them a cell there.
 *
 * A plane has its own axes. A level one has x and y of the scene, as a plan is drawn. Any other has
 * u horizontal and v upwards, seen from the side that the sensors face. Sensors on a grid, which
 * may be rotated, stand for its cells. Sensors in one row stand for squares as wide as their
 * spacing. Others stand for squares of the mean area per sensor.
 */

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

/*
 * Cuts a scene by a plane into straight segments. Round surfaces are cut as prisms of 32 sides. The
 * cut lies slightly in front of the plane, so that objects standing on it are cut, and surfaces in
 * it are not.
 */

/* Callback for each segment, in the plane's axes. */
typedef void (*orl_section_segment)(void *ctx, const double from[2], const double to[2]);

void orl_section_cut(const struct orl_geometry *geometry, const struct orl_sensor_plane *plane,
                     orl_section_segment piece, void *ctx);

/*
 * Values of sensors in a plane, as a map over the plan of the scene: one cell a sensor, in the
 * colours of a scale. A cell is hatched if a threshold lies within the sensor's 95 % interval, so
 * that its side is undetermined. Walls and objects are outlined where the plane cuts them. The map
 * has a legend and a scale bar of a round length.
 */

struct orl_heat_map {
    const struct orl_geometry *geometry; /* borrowed, like all other pointers */
    const struct orl_sensor_plane *plane;
    const char *quantity, *unit; /* "Illuminance", "lx" */
    const double *values; /* one for each of the job's sensors, in the unit; plane has indices */
    const double (*intervals)[2];
    const struct orl_heat_map_request *how; /* thresholds are in the unit */
};

/* The request of maps that no job asks for: contours of 300 lx, and a scale by the values. It is
 * logarithmic where they differ much, as where the sun shines on a few sensors. */
extern const struct orl_heat_map_request orl_default_heat_map;

/* Writes the map to a file, complete or absent. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_heat_map_write(const struct orl_heat_map *map, enum orl_canvas_kind kind, const char *path,
                       struct orl_error *err);

/* Returns the map's size on a page. side: length of the longer side of the area shown, page
 * units. */
void orl_heat_map_size(const struct orl_heat_map *map, double side, double *ret_width,
                       double *ret_height);
/* Draws the map on an open page; (x, y) is its upper left corner. Returns 0 or ORL_ERR_NOMEM. */
int orl_heat_map_draw(const struct orl_heat_map *map, struct orl_canvas *canvas, double x, double y,
                      double side);

#endif

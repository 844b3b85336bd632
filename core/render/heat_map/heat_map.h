/*
 * Values of sensors in a plane, as a map over the plan of the scene: one cell a sensor, in the
 * colours of a scale. A cell is hatched if a threshold lies within the sensor's 95 % interval, so
 * that its side is undetermined. Walls and objects are outlined where the plane cuts them
 * (section.h). The map has a legend and a scale bar of a round length.
 */
#ifndef ORL_RENDER_HEAT_MAP_HEAT_MAP_H
#define ORL_RENDER_HEAT_MAP_HEAT_MAP_H

#include <oriel/base/canvas.h>

#include "render/heat_map/planes.h"
#include "render/picture/scale.h"
#include "scene/geometry/geometry.h"

struct orl_heat_map {
    const struct orl_geometry *geometry; /* borrowed, like all other pointers */
    const struct orl_sensor_plane *plane;
    const char *quantity, *unit; /* "Illuminance", "lx" */
    const double *values; /* one for each of the job's sensors, in the unit; plane has indices */
    const double (*intervals)[2];
    const struct orl_heat_map_request *how; /* thresholds are in the unit */
};

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

/*
 * Values of sensors in a plane, as a map over the plan of the scene: a cell a sensor, in the
 * colours of a scale, hatched where a threshold lies within the sensor's 95 % interval, so that
 * nobody can tell on which side it is. Walls and things are outlined as the plane cuts them
 * (section.h). With a legend, and a bar of some round length.
 */
#ifndef ORL_RENDER_HEAT_MAP_HEAT_MAP_H
#define ORL_RENDER_HEAT_MAP_HEAT_MAP_H

#include <oriel/canvas.h>

#include "render/heat_map/planes.h"
#include "render/picture/scale.h"
#include "scene/geometry/geometry.h"

struct orl_heat_map {
    const struct orl_geometry *geometry; /* borrowed, as all of it */
    const struct orl_sensor_plane *plane;
    const char *quantity, *unit; /* "Illuminance", "lx" */
    const double *values;        /* of all sensors that the plane is of, in the unit */
    const double (*intervals)[2];
    const struct orl_heat_map_request *how; /* thresholds are in the unit */
};

/* Into a file, whole or absent. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_heat_map_write(const struct orl_heat_map *map, enum orl_canvas_kind kind, const char *path,
                       struct orl_error *err);

/* What it takes on a page where the longer side of what is shown has so many page units. */
void orl_heat_map_size(const struct orl_heat_map *map, double side, double *ret_width,
                       double *ret_height);
/* The same onto a page that is open, its upper left corner there. Returns 0 or ORL_ERR_NOMEM. */
int orl_heat_map_draw(const struct orl_heat_map *map, struct orl_canvas *canvas, double x, double y,
                      double side);

#endif

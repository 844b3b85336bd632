/*
 * Window groups: one for each group with shades, and one for windows in no group. The light
 * of a year is the sum over its window groups. Light belongs to the window group of the port by
 * which its path, followed back from the sensor, first leaves the building.
 */
#ifndef ORL_ANNUAL_SHADES_WINDOW_GROUP_PORTS_H
#define ORL_ANNUAL_SHADES_WINDOW_GROUP_PORTS_H

#include "light/lit_scene.h"

/* Returns the window group of a port, from 0; windows of no group are window group n_groups. */
uint16_t orl_window_group_of_port(const struct orl_lit_scene *lit_scene, size_t port,
                                  size_t n_groups);

/*
 * Checks that all surfaces of a window group are near its ports: no further from one of them than
 * half its longer side, in front, behind and beside it. Returns 0, or ORL_ERR_UNSUPPORTED naming
 * the surface. name: the window group's.
 */
int orl_window_group_check_near(const struct orl_lit_scene *lit_scene, uint32_t part,
                                const char *name, struct orl_error *err);

#endif

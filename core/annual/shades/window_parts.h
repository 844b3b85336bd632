/*
 * Parts of the windows: one for each group with shades, and one for windows in no group. The light
 * of a year is the sum over its parts. Light belongs to the part of the port by which its path,
 * followed back from the sensor, first leaves the building.
 */
#ifndef ORL_ANNUAL_SHADES_WINDOW_PARTS_H
#define ORL_ANNUAL_SHADES_WINDOW_PARTS_H

#include "light/world.h"

/* Returns the part of a port, from 0; windows of no group are part n_groups. */
uint16_t orl_part_of_port(const struct orl_world *world, size_t port, size_t n_groups);

/*
 * Checks that all surfaces of a part are near its ports: no further from one of them than half its
 * longer side, in front, behind and beside it. Returns 0, or ORL_ERR_UNSUPPORTED naming the
 * surface. name: the part's.
 */
int orl_part_admit(const struct orl_world *world, uint32_t part, const char *name,
                   struct orl_error *err);

#endif

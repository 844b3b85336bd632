/*
 * Parts of the windows: those of each group with shades, and those in no group. Light of a year is
 * the sum of that of its parts. Paths tell them apart: light is of the part of the port by which
 * its path, followed back from the sensor, first leaves the building.
 */
#ifndef ORL_ANNUAL_PARTS_H
#define ORL_ANNUAL_PARTS_H

#include "light/world.h"

/* Returns the part of a port, from 0; windows of no group are part n_groups. */
uint16_t orl_part_of_port(const struct orl_world *world, size_t port, size_t n_groups);

/*
 * Whether what belongs to the part is by its ports: no further from one of them than half its
 * longer side, before, behind and beside it. ORL_ERR_UNSUPPORTED, naming the surface. name: the
 * part's.
 */
int orl_part_admit(const struct orl_world *world, uint32_t part, const char *name,
                   struct orl_error *err);

#endif

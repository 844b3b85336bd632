/*
 * Light of one part of the windows: of a group with shades, or of those in no group. The ports of
 * all other parts are closed: nothing comes through, and they reflect, evenly, as much of what
 * meets them from inside as they do when they are open.
 *
 * Light of a year is the sum of that of its parts: each path is counted by the port that it comes
 * in by. That is exact for sunlight straight to a sensor. For all other light it leaves out that
 * another group's panes may reflect more or less in another state, and light that goes out by one
 * port and comes in again by another.
 */
#ifndef ORL_ANNUAL_PARTS_H
#define ORL_ANNUAL_PARTS_H

#include "light/world.h"

/* Which ports a world has: of each part (index 0: part 1, ...), and of none. */
struct orl_ports_of_parts {
    size_t *of_part; /* n_parts of them; the caller's */
    size_t n_parts, of_none;
    bool open; /* light has other ways in than ports */
};
void orl_ports_count(const struct orl_world *world, struct orl_ports_of_parts *ret_counts);

/* Closes the ports of all parts but that one. *ret_port_of_facet is owned by the caller, and in use
 * as long as the world is. Returns 0 or ORL_ERR_NOMEM. */
int orl_ports_close(struct orl_world *world, uint32_t part, int32_t **ret_port_of_facet);

/*
 * Whether what belongs to the part is by its ports: no further from one of them than half its
 * longer side, before, behind and beside it. ORL_ERR_UNSUPPORTED, naming the surface. name: the
 * part's.
 */
int orl_part_admit(const struct orl_world *world, uint32_t part, const char *name,
                   struct orl_error *err);

#endif

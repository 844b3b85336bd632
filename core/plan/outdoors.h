/*
 * Whether anything stands outside a window: a facet that reaches beyond the plane of the port's
 * pane. Where none does, whoever looks out of it sees domes and suns and nothing else. That is a
 * fact of geometry, every facet looked at, not of rays that happened to meet something.
 *
 * crew: whose cancellation is heeded; what is found then means nothing.
 */
#ifndef ORL_PLAN_OUTDOORS_H
#define ORL_PLAN_OUTDOORS_H

#include "light/world.h"

/* Fills ret_clear, one per port. False, and all false: there was too much to look at. */
bool orl_outdoors_look(const struct orl_world *world, const struct orl_crew *crew, bool *ret_clear);

/* Of all facets that reach beyond any port: the largest share of light that one sends back. */
double orl_outdoors_reflectance(const struct orl_world *world, const struct orl_crew *crew);

/* The largest share of light that a port sends back, to whoever stands before it. */
double orl_panes_reflectance(const struct orl_world *world);

#endif

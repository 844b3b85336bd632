/*
 * Tests for objects outside a window: facets that reach beyond the plane of the port's pane.
 * Without them, only domes and suns are visible through the pane. The test is geometric and checks
 * every facet; it does not depend on random rays.
 *
 * crew: polled for cancellation; after it the results are meaningless.
 */
#ifndef ORL_PLAN_OUTDOORS_H
#define ORL_PLAN_OUTDOORS_H

#include "light/lit_scene.h"

/* Fills ret_clear, one entry per port: true if no facet reaches beyond it. Returns false, with all
 * entries false, if there are too many facets to check. */
bool orl_outdoors_find_clear(const struct orl_lit_scene *lit_scene,
                             const struct orl_thread_pool *pool, bool *ret_clear);

/* Returns the largest share of light that a facet beyond any port reflects. */
double orl_outdoors_reflectance(const struct orl_lit_scene *lit_scene,
                                const struct orl_thread_pool *pool);

/* Returns the largest share of light that a port reflects. */
double orl_panes_reflectance(const struct orl_lit_scene *lit_scene);

#endif

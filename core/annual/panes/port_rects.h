/*
 * Bounding rectangles of a sealed building's ports. A ray from inside to the sun must pass one
 * whose pane transmits light straight. BSDF panes without a peak do not.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PANES_PORT_RECTS_H
#define ORL_ANNUAL_PANES_PORT_RECTS_H

#include "annual/panes/pane_bvh.h"

struct orl_port_rects {
    struct orl_bounding_rect *at; /* by port */
    size_t count;
    struct orl_bounding_rect *clear; /* the windows that rays pass straight through */
    size_t n_clear;
    struct orl_pane_bvh tree; /* searches the clear windows */
    bool all; /* true if light has other ways in, so that every ray must be traced */
};

/* Collects the windows of a sealed building. Returns 0 or ORL_ERR_NOMEM; orl_port_rects_done in
 * either case. */
int orl_port_rects_init(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene);
void orl_port_rects_done(struct orl_port_rects *windows);

/* Returns true if the ray passes a window; slack as in orl_bounding_rect_passed. */
bool orl_port_rects_passed(const struct orl_port_rects *windows, struct orl_vec3 origin,
                           struct orl_vec3 direction, double slack);
/* Returns true if the ray passes a window nearer than `before`. */
bool orl_port_rects_passed_before(const struct orl_port_rects *windows, struct orl_vec3 origin,
                                  struct orl_vec3 direction, double before);

#endif

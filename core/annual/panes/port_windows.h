/*
 * Bounding rectangles of a sealed building's ports. A ray from inside to the sun must pass one
 * whose pane transmits light straight. BSDF panes without a peak do not.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PANES_PORT_WINDOWS_H
#define ORL_ANNUAL_PANES_PORT_WINDOWS_H

#include "annual/panes/pane_tree.h"

struct orl_windows {
    struct orl_window *at; /* by port */
    size_t count;
    struct orl_window *clear; /* the windows that rays pass straight through */
    size_t n_clear;
    struct orl_pane_tree tree; /* searches the clear windows */
    bool all; /* true if light has other ways in, so that every ray must be traced */
};

/* Collects the windows of a sealed building. Returns 0 or ORL_ERR_NOMEM; orl_windows_done in either
 * case. */
int orl_windows_of_ports(struct orl_windows *windows, const struct orl_world *world);
void orl_windows_done(struct orl_windows *windows);

/* Returns true if the ray passes a window; slack as in orl_window_passed. */
bool orl_windows_passed(const struct orl_windows *windows, struct orl_vec3 origin,
                        struct orl_vec3 direction, double slack);
/* Returns true if the ray passes a window nearer than `before`. */
bool orl_windows_passed_before(const struct orl_windows *windows, struct orl_vec3 origin,
                               struct orl_vec3 direction, double before);

#endif

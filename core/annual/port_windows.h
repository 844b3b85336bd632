/*
 * The windows of a sealed building's ports: a ray from inside to the sun passes one of them, whose
 * pane lets light go straight through. BSDF panes without a peak do not.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PORT_WINDOWS_H
#define ORL_ANNUAL_PORT_WINDOWS_H

#include "annual/pane_tree.h"

struct orl_windows {
    struct orl_window *at; /* by port */
    size_t count;
    struct orl_window *clear; /* those that rays can pass */
    size_t n_clear;
    struct orl_pane_tree tree; /* of those */
    bool all;                  /* every ray is to be traced: light has other ways */
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

/*
 * The sun at sensors by way of panes described by BSDFs, at its own place of every hour.
 *
 * Radiance that a pane sends towards a sensor is looked for in two ways, weighted by the balance
 * heuristic (Veach 1997, chapter 9): points of the pane, and directions drawn by its BSDF from the
 * hour's sun. The draws are the same wherever a pane of that kind hangs and whoever looks: they are
 * made once for all sensors. What a sensor sees of a pane is looked at once for all hours.
 *
 * Most panes are in full view of a sensor, and wholly in the sun or in shade. If 64 stratified
 * points of a pane agree on it, no more rays are traced for that sensor, or for that sun. An
 * obstacle that hides a share f of the pane is missed with the probability (1 - f)^64: that is 0.6
 * % of the light on average, at the most. Points behind the sensor's own plane do not count; if
 * only half of the points are left, that is 1.1 %, and with fewer points rays are traced. A pane is
 * probed for a sun when the first sensor asks for the two.
 *
 * Panes are ports of a sealed building. Immutable once made, but for the probes' results, which do
 * not depend on who asks first.
 */
#ifndef ORL_ANNUAL_PANELS_H
#define ORL_ANNUAL_PANELS_H

#include "annual/panel_draws.h"
#include "annual/scene.h"
#include "annual/sun_rows.h"
#include "annual/windows.h"

enum { ORL_PANEL_PROBING_SENSORS = 16 }; /* with fewer sensors, probes take longer than they save */

enum {
    ORL_PANEL_SIDE = 8, /* a pane's parts along an edge */
    ORL_PANEL_PARTS = ORL_PANEL_SIDE * ORL_PANEL_SIDE,
    ORL_PANEL_GROUPS = 8,      /* independent, for standard errors */
    ORL_PANEL_MOST_KINDS = 32, /* of material and normal */
};

struct orl_panel {
    struct orl_window window;
    struct orl_vec3 inward;
    uint32_t kind, part; /* part of the windows (scene.h) */
    double area;
};

struct orl_panels {
    const struct orl_world *world; /* borrowed, as suns are */
    const struct orl_year_suns *suns;
    struct orl_panel *at;
    size_t count;
    struct orl_panel_kind kinds[ORL_PANEL_MOST_KINDS];
    size_t n_kinds;
    struct orl_panel_draws *draws; /* [kind][sun] */
    uint64_t seed;
    /* [pane][sun]: share of the sun's light that comes to all points of the pane; -1: not the same
     * share to all; -2: not probed yet. NULL: no pane is probed. */
    _Atomic float *sunlit;
};

/* Returns 0, ORL_ERR_NOMEM, _LIMIT (too many kinds) or _CANCELLED; orl_panels_done in either case.
 */
int orl_panels_init(struct orl_panels *panels, const struct orl_annual_scene *scene,
                    const struct orl_year_suns *suns, size_t n_sensors, uint64_t seed,
                    struct orl_crew *crew);
void orl_panels_done(struct orl_panels *panels);

/* Adds to direct sunlight, for every sun that is wanted, what comes by panels, and the square of
 * its standard error. name: of the sensor. The crew is asked before each pane if the job is
 * cancelled, and then the rest is left out; NULL: it never is. */
void orl_panels_add(const struct orl_panels *panels, const struct orl_place *place, uint64_t name,
                    const struct orl_crew *crew, const struct orl_sun_rows *rows);

#endif

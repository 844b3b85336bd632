/*
 * Matrices of the three- and five-phase methods (McNeil and Lee 2013; McNeil 2013, "The five-phase
 * method for simulating complex fenestration with Radiance"), in the form that other programs
 * multiply: irradiance at sensors = view x transmission x daylight x sky, summed over windows.
 *
 * A window is the set of ports of a sealed building that share a material and an orientation.
 * Directions are the cells of LBNL's full Klems basis about the inward normal. "Up" is that of the
 * BSDF, or else that of the scene. Outgoing light is numbered by its direction, incoming light by
 * its direction of travel, as in WINDOW and Radiance. Light that passes straight through keeps its
 * cell.
 * - view: sensors x cells; irradiance by radiance 1 that leaves all of the windows in a cell.
 * - transmission: cells out x cells in; radiance of a cell by radiance 1 in another; a BSDF's own
 *   matrix if it has one in that basis, else means over both cells.
 * - daylight: cells x ORL_ANNUAL_PATCHES; mean radiance that reaches the windows in a cell by
 *   radiance 1 in a patch.
 * - direct view, direct daylight: the same without any reflection, for the part that five
 *   phases subtract.
 * - suns: sensors x ORL_PHASES_SUNS; irradiance, direct or through panes and BSDFs, by a disc of
 *   0.533 degrees and radiance 1 in the middle of each patch of Reinhart's sky MF:6; the first
 *   column, the ground's, is 0.
 *
 * Differences from the annual run: panes reflect nothing back into the room, because paths end
 * there so that another transmission can replace this one; and values are constant within a cell.
 * Values are grey (luma). Errors are those of the paths, with as many per sensor as in the year;
 * they are not reported.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_PHASES_H
#define ORIEL_ANNUAL_ANNUAL_PHASES_H

#include <oriel/annual/annual.h>

enum {
    ORL_PHASES_CELLS = 145,
    ORL_PHASES_SUNS = 5186,
    ORL_PHASES_MOST_WINDOWS = 32,
    ORL_PHASES_MOST_SENSORS = 1 << 14
};

struct orl_phase_window {
    char *name; /* material name, with suffix -2 and so on for further orientations */
    size_t n_panes;
    float *transmission;               /* [cell out][cell in] */
    float *daylight, *direct_daylight; /* [cell][patch] */
    float *view, *direct_view;         /* [sensor][cell] */
};

struct orl_phase_matrices {
    struct orl_phase_window *windows;
    size_t n_windows;
    float *suns; /* [sensor][ORL_PHASES_SUNS], sr */
};
void orl_phase_matrices_done(struct orl_phase_matrices *phases); /* zeros are fine */

/* Computes the matrices for the request's scene, sensors, samples and seed, with shades open.
 * Errors are those of orl_annual_run, and ORL_ERR_UNSUPPORTED if light has other ways in than
 * windows, or sensors stand outdoors. */
int orl_phase_matrices_compute(const struct orl_annual_request *request,
                               const struct orl_run_env *run, struct orl_phase_matrices *ret_phases,
                               struct orl_error *err);

#endif

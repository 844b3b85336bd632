/*
 * Matrices of the three- and five-phase methods (McNeil and Lee 2013; McNeil 2013, "The five-phase
 * method for simulating complex fenestration with Radiance"), as others multiply them: irradiance
 * at sensors = view x transmission x daylight x sky, summed over windows.
 *
 * Windows are the ports of a sealed building, those of one material that face one way together.
 * Directions are the cells of LBNL's full Klems basis about the way they face inwards, "up" being
 * the BSDF's, or the scene's: light that leaves by its direction, light that comes in by the way in
 * which it travels, as WINDOW and Radiance number them. What goes straight on keeps its cell.
 *   view          sensors x cells: irradiance, of radiance 1 that leaves all of the windows in a
 * cell transmission  cells out x cells in: radiance of a cell, of radiance 1 in another; a BSDF's
 * own matrix where it has one in that basis, else means over cells of both daylight      cells x
 * ORL_ANNUAL_PATCHES: mean radiance that comes to the windows in a cell, of radiance 1 in a patch
 *   straight view, daylight: the same without any reflection, for what five phases take off
 *   suns          sensors x ORL_PHASES_SUNS: irradiance straight from, or through panes and BSDFs,
 * a disc of 0.533 degrees and radiance 1 in the middle of each patch of Reinhart's sky MF:6; the
 * first column, the ground's, is 0
 *
 * What differs from the year itself: panes reflect nothing back into the room (they are where paths
 * end, so that another transmission can take the place of this one), and within a cell all is one.
 * Grey: by luma. Errors are those of the paths, as many a sensor as the year's; they are not told.
 */
#ifndef ORIEL_ANNUAL_PHASES_H
#define ORIEL_ANNUAL_PHASES_H

#include <oriel/annual.h>

enum {
    ORL_PHASES_CELLS = 145,
    ORL_PHASES_SUNS = 5186,
    ORL_PHASES_MOST_WINDOWS = 32,
    ORL_PHASES_MOST_SENSORS = 1 << 14
};

struct orl_phase_window {
    char *name; /* the material's, and -2 and so on where it faces more ways */
    size_t n_panes;
    float *transmission;                 /* [cell out][cell in] */
    float *daylight, *straight_daylight; /* [cell][patch] */
    float *view, *straight_view;         /* [sensor][cell] */
};

struct orl_annual_phases {
    struct orl_phase_window *windows;
    size_t n_windows;
    float *suns; /* [sensor][ORL_PHASES_SUNS], sr */
};
void orl_annual_phases_done(struct orl_annual_phases *phases); /* zeros are fine */

/* Of the request's scene, sensors, samples and seed, shades being open. Errors: orl_annual_run's,
 * and ORL_ERR_UNSUPPORTED where light has other ways in than windows, or sensors stand outdoors. */
int orl_annual_phases_find(const struct orl_annual_request *request, const struct orl_run_env *run,
                           struct orl_annual_phases *ret_phases, struct orl_error *err);

#endif

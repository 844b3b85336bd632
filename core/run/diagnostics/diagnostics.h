/* Checks of a run's scene and results, which add warnings to the result. */
#ifndef ORL_RUN_DIAGNOSTICS_DIAGNOSTICS_H
#define ORL_RUN_DIAGNOSTICS_DIAGNOSTICS_H

#include "run/run_state.h"

/* Adds the faults of the scene's files to the result's health. */
void orl_run_count_scene_faults(struct orl_run_state *state, const struct orl_scene *scene);

/* Warns of panes of the scene that lie on an opaque surface. */
void orl_run_warn_of_covered_panes(struct orl_run_state *state);
/* Warns of BSDF panes whose front is outdoors, if their data change when turned round. */
void orl_run_warn_of_turned_panes(struct orl_run_state *state);

/* Marks a sensor as unreliable. */
void orl_run_mark_unreliable(struct orl_run_state *state, size_t sensor, enum orl_doubt doubt);
/* Treats an accuracy as not met if sensors are unreliable; called after all checks. */
void orl_run_apply_unreliable(struct orl_run_state *state);

/* Returns true, and warns, if no light reaches any sensor or view of the job, so that tracing
 * photons is useless. */
bool orl_run_is_dark(struct orl_run_state *state);

/* In the plan stage: warns of eyes inside a solid, in a wall or on a surface. */
void orl_run_diagnose_views(struct orl_run_state *state);

/* At the end: warns of sensors and views without light if others have some. If none has any it
 * returns ORL_ERR_UNLIT, unless the job expects that or it is night. */
int orl_run_diagnose_dark(struct orl_run_state *state, struct orl_error *err);

/* At the end: warns of light that the backward technique has missed, because its paths hit it only
 * by chance. */
int orl_run_diagnose_missed_light(struct orl_run_state *state, struct orl_error *err);

/* At the end: compares sensors with plain path tracing, into result->cross_check. If they differ by
 * more than both errors it widens intervals and warns. */
int orl_run_cross_check(struct orl_run_state *state, struct orl_error *err);

/* At the end: issues the warnings that the result's health requires. */
void orl_run_diagnose_health(struct orl_run_state *state);

#endif

/* The clock and the progress of a run's stages. */
#ifndef ORL_RUN_ESTIMATE_STAGE_PROGRESS_H
#define ORL_RUN_ESTIMATE_STAGE_PROGRESS_H

#include "run/run_state.h"

/* Begins a stage: records the time of the one before, and reports progress. */
void orl_run_begin_stage(struct orl_run_state *state, enum orl_stage stage);
/* Records the time since the current stage began. */
void orl_run_end_stage(struct orl_run_state *state);
/* Moves seconds just spent from the current stage to another. */
void orl_run_move_time(struct orl_run_state *state, enum orl_stage stage, double seconds);
void orl_run_report_progress(const struct orl_run_state *state, double fraction);
/* Begins a phase of the stage, between two fractions of it, at the time of the last progress
 * report. */
void orl_run_begin_phase(const struct orl_run_state *state, double from, double to);
/* Begins the work of a stage after its set-up. */
void orl_run_begin_work(const struct orl_run_state *state);
/* Values for a report of progress: the share and the seconds, elapsed and left, of the run itself,
 * which may be a part of something larger. */
struct orl_progress_report {
    double share, elapsed_s, left_s;
};
void orl_progress_report(const struct orl_run_env *env, enum orl_stage stage, double fraction,
                         const struct orl_progress_report *report);

#endif

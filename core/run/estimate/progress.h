/*
 * Time of a run: the clock and progress of its stages, estimates of time and memory, and the
 * remaining time.
 */
#ifndef ORL_RUN_ESTIMATE_PROGRESS_H
#define ORL_RUN_ESTIMATE_PROGRESS_H

#include <oriel/job/run.h>

#include "run/run_state.h"

/*
 * Remaining time of a run, and the share that is done.
 *
 * The remaining time of the current stage is its estimate, replaced gradually by an extrapolation
 * of its own progress. For later stages it is their estimate, scaled by the ratio of actual to
 * estimated time so far. If a pilot has traced photons, all estimates are already for this machine,
 * and earlier stages do not scale later ones. A stage that overruns always keeps some remaining
 * time.
 *
 * A stage may have phases, each of one kind of work. The remaining time of the current phase
 * follows from its own progress, that of later ones from the whole stage so far.
 *
 * The reported share grows at a rate that reaches 1 when the remaining time is over. If the
 * remaining time was right from the start it is a share of time, elapsed / (elapsed + left). It
 * never decreases and never stands still, however estimates change.
 *
 * All functions depend on their arguments alone; they read no clock.
 */

struct orl_remaining_time {
    double estimated_s[ORL_STAGE_COUNT]; /* estimate for each stage, by the whole thread pool */
    double spent_s[ORL_STAGE_COUNT];     /* time of the stages before the current one */
    enum orl_stage stage;                /* current stage */
    double fraction;                     /* reported progress of the stage; 0: none */
    double stage_elapsed_s;              /* time since the stage began */
    /* Current phase, as shares of the stage; both 0: there is only one. */
    double phase_from, phase_to;
    double phase_elapsed_s; /* time since the phase began */
};

/* Returns the seconds until the last stage ends. */
double orl_remaining_time_s(const struct orl_remaining_time *remaining);

/* Returns the share that is done, 0..1: since_s after it was `before`, with left_s remaining. */
double orl_remaining_time_share(double before, double since_s, double left_s);

/* Estimates of a run's time and memory. */

/* Returns a rough estimate of the job's seconds on one core, without knowledge of its scene or of
 * its errors. Not valid with a deadline, or with sensors in a file that is not read yet. */
double orl_run_estimate_core_s(const struct orl_job *job);
/* Returns a rough estimate of the job's memory in bytes, besides the scene. */
uint64_t orl_run_estimate_bytes(const struct orl_job *job);

/* Estimates the job's stages into state->clock.cost_s; called when the sensors are known, and again
 * when the photons are. */
void orl_run_estimate_stages(struct orl_run_state *state);
/* Reduces the sensors' estimate: earlier jobs have read that share of the global map. */
void orl_run_discount_map_reads(struct orl_run_state *state, double share);
/* Returns true if earlier parts of the job have measured the stages, which is more accurate than a
 * plan's estimate. */
bool orl_run_is_measured(const struct orl_run_state *state);
/* Returns the photons that could be traced and put into maps, by rough costs, in the time of all
 * views by maps; for a pilot, of the whole job's views. */
double orl_run_photons_in_view_time(const struct orl_run_state *state);
/* Returns the share of a view's time for painting; the rest is for writing files. */
double orl_run_painting_share(const struct orl_run_state *state,
                              const struct orl_view_request *view);
/* Returns the share of the sensors' time for a share of their samples. */
double orl_run_sensors_time_share(const struct orl_run_state *state, double taken);
/* Returns the sensors' share of the render stage. */
double orl_run_sensors_share(const struct orl_run_state *state);

/* The clock and the progress of a run's stages. */

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

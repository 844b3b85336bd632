/*
 * The cost of work: samples of a goal, time and size of rounds, and the pilot's curve of
 * accuracy over time.
 */
#ifndef ORL_RUN_ESTIMATE_ROUND_COST_H
#define ORL_RUN_ESTIMATE_ROUND_COST_H

#include <oriel/job/run.h>

#include "run/goals/percentile.h"
#include "run/run_state.h"

/* Estimates the work of a job for an accuracy before its errors are known. */

/* Returns the total samples of a sensor, as rounds count them, by backward or by
 * maps. of_round: samples of a round, for goals of a DGP error. NaN: limited only by a deadline. */
double orl_goal_estimate_samples(const struct orl_goal *goal, bool paths, double of_round);

/*
 * The cost of work: samples, their meaning for each technique, their time and their effect.
 *
 * The size of a round (rounds.h) is a number of samples of every sensor, or their mean if sensors
 * get different numbers (percentile.h). 4096 of them correspond to the photons, or virtual
 * lights, that the planner chooses. A job with only few sensors gets fewer lights, because their
 * cost is shared by few. 64 samples correspond to one sample of every pixel. Variances are
 * inversely proportional to samples.
 *
 * The schedule of rounds is defined here, because it also determines the cost of another digit: a
 * small round to measure, then one meant to reach the goal, then the remainder.
 */

/* The work that a number of samples causes in one job. */
struct orl_work {
    enum orl_technique technique;
    bool of_views; /* true if there are views, possibly with sensors */
    /* True if sensors may get different samples: backward, no views. */
    bool by_noise;
    uint64_t photons[ORL_SHOT_KINDS]; /* chosen by the planner */
    double least, most;               /* limits of a round's samples */
    /* For views by maps: the part of their usual time that is proportional to samples, because
     * their rays are. 0: the time is constant for every round. */
    double ray_time_share;
};

struct orl_work orl_work_of(const struct orl_run_state *state);

/* Return the photons of a kind, and the samples of a pixel, that correspond to samples of a
 * sensor. */
uint64_t orl_work_photons(const struct orl_work *work, int kind, double samples);
uint32_t orl_work_pixel_samples(double samples);

/* Returns true if the time of views does not depend on samples: by photon maps, unless their rays
 * follow the samples. */
bool orl_work_view_time_is_fixed(const struct orl_work *work);

/* Returns the factor of view rays in a round, as in struct orl_painting (render/image/image.h). */
double orl_work_view_rays(const struct orl_work *work, double samples);

/* Returns the samples of the round after `done` of them, if `wanted` in total suffice; by counts
 * alone. */
double orl_work_next(const struct orl_work *work, double done, double wanted);

/* Sets kernel areas of a round of `samples` after `before` others, relative to the maps' choice
 * (rounds.h). */
void orl_work_bandwidths(double samples, double before, double ret_bandwidths[ORL_MAP_KINDS]);

/* Returns the maximum total samples of a job with a goal. */
double orl_work_limit(void);

/* Measured work so far, and its seconds. */
struct orl_throughput {
    double setup_s;           /* time until the first photon */
    double photons, photon_s; /* traced and added to maps; virtual lights count as well */
    double samples, render_s;
    double views_s;         /* part of render_s for views, if their rays follow the samples */
    double rounds, other_s; /* number of rounds; time that belongs to none of the above */
};

/* Return the seconds of a round, and of a whole run in rounds until `wanted` samples are taken. */
double orl_throughput_round_s(const struct orl_throughput *throughput, const struct orl_work *work,
                              double samples);
double orl_throughput_run_s(const struct orl_throughput *throughput, const struct orl_work *work,
                            double wanted);
/* Returns the seconds of the rounds that remain after `done` samples; 0: none. */
double orl_throughput_remaining_s(const struct orl_throughput *throughput,
                                  const struct orl_work *work, double done, double wanted);
/* Sets the seconds of the stages from photons on; leaves the others unchanged. */
void orl_throughput_stage_s(const struct orl_throughput *throughput, const struct orl_work *work,
                            double samples, double estimated_s[ORL_STAGE_COUNT]);
/* Returns the samples of a round that lasts `seconds`: at least the minimum, at most `most` or the
 * limit for rounds. */
double orl_throughput_samples(const struct orl_throughput *throughput, const struct orl_work *work,
                              double seconds, double most);

/* Outputs of a job, its sensors and its views, that have errors, borrowed; the worst one counts. */
struct orl_output_estimates {
    const struct orl_estimates *outputs;
    size_t count;
    double at;
};
double
orl_output_estimates_error(const struct orl_output_estimates *outputs); /* NaN if one is unknown */
/* Returns the total work for an error of `target`, relative to the work so far; NaN if unknown. */
double orl_output_estimates_work(const struct orl_output_estimates *outputs, double target);

/* Sets the predictions and the counts in the result's cost, from the time so far. */
void orl_run_predict_cost(struct orl_run_state *state, const struct orl_throughput *throughput,
                          const struct orl_work *work, const struct orl_output_estimates *outputs);

/* Computes the curve of accuracy over time, from the current state on. */
void orl_run_compute_curve(const struct orl_run_state *state,
                           const struct orl_throughput *throughput, const struct orl_work *work,
                           const struct orl_output_estimates *outputs,
                           struct orl_accuracy_curve *ret_curve);

/* Compute the cost of a job without rounds. orl_run_store_pixels stores some thousand pixels of
 * each finished view; a view is left out of the error if memory is exhausted. */
void orl_run_store_pixels(struct orl_run_state *state, size_t index, const struct orl_film *film);
void orl_run_compute_cost(struct orl_run_state *state);
void orl_run_free_pixels(struct orl_run_state *state);

/*
 * The pilot of a job: predicts time over accuracy from a short run (oriel/job/run.h,
 * orl_plan_accuracy_curve). Seconds are those of the whole job: the pilot's sensors and views are
 * scaled by the ratio of numbers. By photon maps the pilot's rounds have as many of the plan's
 * photons as one or two seconds trace; the job's rounds have all.
 */

enum { ORL_PILOT_ROUNDS = 2 };

struct orl_pilot {
    /* Ratio of the job's sensors, and views' work, to the pilot's. */
    double sensor_factor, view_factor;
    double samples;                   /* samples of its rounds; 0: the minimum of a job */
    struct orl_accuracy_curve *curve; /* out */
};

/* Returns the pilot's job, whatever goal `job` has. Borrows from job. */
struct orl_job orl_pilot_job(const struct orl_job *job, enum orl_technique technique);

/* Returns the reason why no accuracy of the job can be predicted, a constant; NULL if a pilot can
 * predict them. Call it after the plan is made. */
const char *orl_run_no_curve_reason(const struct orl_run_state *state);

/* Runs the pilot after its plan is made; fills state->pilot->curve. */
int orl_run_pilot(struct orl_run_state *state, struct orl_error *err);

#endif

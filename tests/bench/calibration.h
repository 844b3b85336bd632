/*
 * `make calibration`: whether errors that Oriel states are the errors that it makes. Five tables:
 *   coverage   how often interval_95_lx holds the reference, by scene and technique
 *   pixels     the error maps of views, against a converged picture
 *   goals      jobs by relative error: how often they keep to it, and what they cost beside the
 *              best of fixed settings
 *   deadlines  jobs by deadline: total time and error
 *   next       predicted seconds to halve the error, and what it then takes
 *
 * The reference of a scene is a closed form, or the mean of several long runs of backward with
 * seeds of their own, whose spread gives its standard error. Errors are relative, over max(r, 0.1 %
 * of the mean reference), as in oriel/study.h.
 */
#ifndef ORL_TESTS_BENCH_CALIBRATION_H
#define ORL_TESTS_BENCH_CALIBRATION_H

#include "bench/bench.h"
#include "bench/office.h"

enum { CALIBRATION_SCENES = 4, CALIBRATION_MOST_SENSORS = 64 };

struct calibration_knobs {
    uint32_t seeds, goal_seeds, deadline_seeds, next_seeds;
    uint64_t photons;
    uint32_t backward_samples, gather_samples; /* of a sensor */
    uint32_t reference_runs, reference_samples;
    uint32_t width, pixel_samples, pixel_runs; /* of the views; runs of their reference */
    struct bench_list errors, deadlines_s;
    uint32_t threads;
    bool by_cpu; /* seconds are the processor's, but for deadlines */
};

struct calibration_scene {
    const char *name;
    const struct orl_files *files;
    char *const *names; /* of the main files */
    size_t n_names;
    char *sensors_file; /* or else: */
    const struct orl_sensor *sensors;
    size_t n_sensors; /* either way */
    const char *view; /* 4 to 3; NULL: none */
    double known_lx;  /* of every sensor; 0: there is no closed form */
    /* Made when they are first asked for: */
    bool referred;
    double reference_lx[CALIBRATION_MOST_SENSORS], error_lx[CALIBRATION_MOST_SENSORS];
    double mean_lx; /* of the reference */
};

struct calibration {
    struct calibration_knobs knobs;
    struct office office;
    struct orl_memory_files texts[2];
    struct orl_files of_texts[2];
    struct calibration_scene scenes[CALIBRATION_SCENES];
    uint64_t wanted; /* bit i: scene i */
    struct orl_crew *crew;
    char output[BENCH_PATH], maps[BENCH_PATH + 8];
};

/* In place. Scenes: the office with its panel, with glass, an integrating sphere, a room behind a
 * pane of a matrix in Klems' manner. */
void calibration_open(struct calibration *calibration);
void calibration_close(struct calibration *calibration);

/* Whether the scene's name was asked for. */
bool calibration_wants(const struct calibration *calibration, size_t scene);

/* A job of the scene's sensors, nothing else asked; owns nothing: not for orl_job_done. */
void calibration_job(const struct calibration_scene *scene, struct orl_job *ret_job);

/* Pixels of a view as a run has them: luminance and its standard error, cd/m2. */
struct calibration_pixels {
    double *values, *errors; /* owned; errors NULL: not known */
    size_t n;
};
void calibration_pixels_done(struct calibration_pixels *pixels);

/* Runs a job without maps from before. ret_pixels: of the job's first view; may be NULL. */
void calibration_run(const struct calibration *calibration, const struct calibration_scene *scene,
                     const struct orl_job *job, struct orl_result *ret_result,
                     struct calibration_pixels *ret_pixels);

/* Fills in the scene's reference, and says so on stderr. */
void calibration_refer(const struct calibration *calibration, struct calibration_scene *scene);

/* Relative errors of a result's sensors. */
struct calibration_error {
    double rms, p95, bias;
};
struct calibration_error calibration_judge(const struct calibration_scene *scene,
                                           const double *illuminance_lx);

/* The share of values at which `share` of them lie below or there. Reorders values. */
double calibration_percentile(double *values, size_t n, double share);

/* The tables. */
void calibration_coverage(struct calibration *calibration);
void calibration_pixel_errors(struct calibration *calibration);
void calibration_goals(struct calibration *calibration);
void calibration_deadlines(struct calibration *calibration);
void calibration_next(struct calibration *calibration);

#endif

/*
 * `make calibration`: compares the errors that Oriel states with its actual errors. Five tables:
 *
 * coverage   how often interval_95_lx holds the reference, by scene and technique
 * pixels     the error maps of views, against a converged picture
 * goals      jobs by relative error: how often they meet it, and their cost compared with the
 *            best of fixed settings
 * deadlines  jobs by deadline: total time and error
 * next       predicted seconds to halve the error, and the actual ones
 *
 * The reference of a scene is a closed form, or the mean of several long runs of backward with
 * separate seeds, whose spread gives its standard error. Errors are relative, over max(r, 0.1 % of
 * the mean reference), as in oriel/job/study.h.
 */
#ifndef ORL_TESTS_BENCH_CALIBRATION_H
#define ORL_TESTS_BENCH_CALIBRATION_H

#include "bench/bench.h"
#include "bench/office.h"

enum { CALIBRATION_SCENES = 4, CALIBRATION_MOST_SENSORS = 64 };

struct calibration_knobs {
    uint32_t seeds, goal_seeds, deadline_seeds, next_seeds;
    uint64_t photons;
    uint32_t backward_samples, gather_samples; /* per sensor */
    uint32_t reference_runs, reference_samples;
    uint32_t width, pixel_samples,
        pixel_runs; /* pixels; samples per pixel; runs of the views' reference */
    struct bench_list errors, deadlines_s;
    uint32_t threads;
    bool by_cpu; /* processor seconds, except for deadlines */
};

struct calibration_scene {
    const char *name;
    const struct orl_files *files;
    char *const *names; /* names of the main files */
    size_t n_names;
    char *sensors_file; /* NULL: use `sensors` */
    const struct orl_sensor *sensors;
    size_t n_sensors; /* number of sensors in either case */
    const char *view; /* aspect ratio 4 to 3; NULL: none */
    double known_lx;  /* illuminance of every sensor; 0: no closed form */
    /* Reference, computed on first use: */
    bool referred;
    double reference_lx[CALIBRATION_MOST_SENSORS], error_lx[CALIBRATION_MOST_SENSORS];
    double mean_lx; /* mean of the reference over the sensors */
};

struct calibration {
    struct calibration_knobs knobs;
    struct office office;
    struct orl_memory_files texts[2];
    struct orl_files of_texts[2];
    struct calibration_scene scenes[CALIBRATION_SCENES];
    uint64_t wanted; /* bit i: scene i */
    struct orl_thread_pool *pool;
    char output[BENCH_PATH], maps[BENCH_PATH + 8];
};

/* Opens in place. Scenes: the office with its panel, the office with glass, an integrating sphere,
 * and a room behind a pane with a Klems matrix. */
void calibration_open(struct calibration *calibration);
void calibration_close(struct calibration *calibration);

/* Returns true if the scene was requested by name. */
bool calibration_wants(const struct calibration *calibration, size_t scene);

/* Fills a job of the scene's sensors only. The job owns nothing: do not call orl_job_done. */
void calibration_job(const struct calibration_scene *scene, struct orl_job *ret_job);

/* Pixels of a view as a run reports them: luminance and its standard error, cd/m2. */
struct calibration_pixels {
    double *values, *errors; /* owned; errors is NULL if unknown */
    size_t n;
};
void calibration_pixels_done(struct calibration_pixels *pixels);

/* Runs a job without cached maps. ret_pixels: those of the job's first view; may be NULL. */
void calibration_run(const struct calibration *calibration, const struct calibration_scene *scene,
                     const struct orl_job *job, struct orl_result *ret_result,
                     struct calibration_pixels *ret_pixels);

/* Fills in the scene's reference and reports this on stderr. */
void calibration_refer(const struct calibration *calibration, struct calibration_scene *scene);

/* Relative errors of a result's sensors. */
struct calibration_error {
    double rms, p95, bias;
};
struct calibration_error calibration_judge(const struct calibration_scene *scene,
                                           const double *illuminance_lx);

/* Returns the value at the quantile `share`. Reorders values. */
double calibration_percentile(double *values, size_t n, double share);

/* Print the tables. */
void calibration_coverage(struct calibration *calibration);
void calibration_pixel_errors(struct calibration *calibration);
void calibration_goals(struct calibration *calibration);
void calibration_deadlines(struct calibration *calibration);
void calibration_next(struct calibration *calibration);

#endif

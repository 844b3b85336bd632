/*
 * Studies of accuracy over time. A scene with sensors or views is computed by several techniques,
 * at several numbers of photons and samples, each with several seeds. All runs are compared with
 * one long run of the unbiased technique.
 *
 * Measures. For sensor or pixel i, with value x_i in a run and r_i in the reference,
 *     e_i = (x_i - r_i) / max(r_i, floor)
 * where floor is 0.1 % of the mean reference for sensors (it guards against unlit ones) and 10 %
 * for pixels (a dark pixel's error is not seen next to bright ones). Then
 *     rms^2 = mean of e_i^2 over i and seeds, less the reference's own share, mean of s_i^2
 *     bias  = mean of e_i over i and seeds
 *     noise^2 = mean over i of the variance of e_i between seeds; needs two seeds
 *     p95   = 95th percentile of |e_i| over i and seeds, the reference's share included
 *     peak  = largest |e_i| of the brightest percent of pixels, mean over seeds; views only
 * with s_i the standard error of r_i, relative as e_i is. The reference is the mean of several runs
 * with separate seeds, whose spread gives s_i. With one run, for sensors, s_i is that run's own
 * estimate. Several runs are better than one with as many samples: all samples of a run share its
 * virtual lamps, and more samples do not reduce the error of the lamps. Subtracting the reference's
 * share from rms^2 is right on average, since its seeds are independent of all others. If that
 * share is more than a quarter of rms^2, the point is marked as inaccurate. Sensors whose reference
 * is not known to 1 % are excluded from all measures. Relative errors are fractions: 0.01 is 1 %.
 *
 * Time is the time that a user waits: every run starts without photon maps, and loads the scene.
 * Measurements from another machine are compared in ray-times: seconds times the rays per second
 * that Embree alone answers there in the same scene.
 *
 * In a distributed study (oriel/job/job_tasks.h) each run is a task. All numbers except times equal
 * those of a study in one process. Times are those of the process that made the run, so they differ
 * between unequal machines.
 *
 * Ownership: a request and a study own all that they point to. Threads: the calling thread leads
 * the pool; nothing is stored between calls. Errors as in error.h.
 */
#ifndef ORIEL_JOB_STUDY_H
#define ORIEL_JOB_STUDY_H

#include <oriel/job/job_tasks.h>
#include <oriel/job/run.h>

/* Parameters that a study varies. 0: the technique ignores the parameter. */
struct orl_study_setting {
    enum orl_technique technique;
    uint64_t photons; /* per map */
    uint32_t samples; /* per sensor or pixel */
};

/* Measurement of another program, for comparison. */
struct orl_study_external {
    char *name;
    double seconds, rms;
    double rays_per_s; /* rate of its machine, as orl_study.rays_per_s; 0: not known */
    double here_s;     /* results only: seconds converted to this machine by both rates */
};

struct orl_study_request {
    struct orl_job job; /* scene, sky, overrides, sensors or views, first seed; varied parameters
                           are ignored */
    enum orl_technique *techniques;
    size_t n_techniques;
    uint64_t *photons;
    size_t n_photons;
    uint32_t *samples;
    size_t n_samples;
    uint32_t repeats;           /* seeds per setting */
    uint32_t reference_samples; /* per sensor or pixel, over all reference runs */
    uint32_t reference_runs;    /* number of seeds of the reference */
    char *title, *note;         /* free text; NULL: none. note: source of the given points */
    struct orl_study_external *external;
    size_t n_external;
};
void orl_study_request_init(struct orl_study_request *request);
void orl_study_request_done(struct orl_study_request *request); /* NULL, half-filled: fine */

/* Checks everything that needs no scene, and the number of runs. Errors name the member of the
 * study document (study_json.h) at fault in orl_error.primitive. */
int orl_study_request_validate(const struct orl_study_request *request, struct orl_error *err);

/* Returns the number of settings, which is the number of points. */
size_t orl_study_count_settings(const struct orl_study_request *request);
/* Returns a rough estimate of the single-core seconds for a number of sensors, without knowledge of
 * the scene. */
double orl_study_core_s(const struct orl_study_request *request, double sensors);
/* Returns ORL_ERR_LIMIT if there are more than `most` runs, including the reference's. */
int orl_study_check_runs(const struct orl_study_request *request, uint32_t most,
                         struct orl_error *err);

/* Return true if the technique uses the parameter, for views or for sensors. Sensors in mid-air are
 * also gathered for by ORL_TECHNIQUE_DIRECT and _PRECOMPUTED, with a job's default number of
 * samples. */
bool orl_study_uses_photons(enum orl_technique technique);
bool orl_study_uses_samples(enum orl_technique technique, bool of_views);

/* ---- Results --------------------------------------------------------------------------------- */

struct orl_study_point {
    struct orl_study_setting setting;
    uint32_t seeds;
    double stages_s[ORL_STAGE_COUNT], total_s; /* means over seeds */
    double total_error_s;                      /* standard error of that mean */
    double rms, rms_error;   /* rms_error: standard error, from the spread between seeds */
    double bias, bias_error; /* bias_error: of seeds and reference */
    double noise;            /* NaN with one seed */
    double p95;
    double peak;          /* NaN without views */
    uint64_t map_bytes;   /* photon maps of one seed, bytes */
    bool reference_shows; /* true: the reference's noise is more than a quarter of rms^2 */
    bool on_front;        /* true: no other point is both faster and more accurate */
};

struct orl_study_reference {
    uint32_t samples, runs;
    size_t values, left_out; /* sensors or pixels compared, and those excluded */
    double standard_error;   /* rms of s_i over those compared */
    double worst;            /* largest s_i of those compared */
    double seconds;
};

/*
 * Model of a technique's error over its settings, N photons and S samples:
 *     rms^2 = kernel + spread / N + bias / N^2 + samples / S
 * core/study/study_errors.h derives it. A term that the settings cannot separate from the others is
 * absent: NaN.
 */
enum orl_fit_term { ORL_FIT_KERNEL, ORL_FIT_SPREAD, ORL_FIT_BIAS, ORL_FIT_SAMPLES, ORL_FIT_TERMS };
const char *orl_fit_term_name(enum orl_fit_term term); /* "kernel", "spread", ... */

struct orl_study_fit {
    enum orl_technique technique;
    size_t points;
    double terms[ORL_FIT_TERMS];  /* not negative, or NaN */
    double errors[ORL_FIT_TERMS]; /* standard deviation over refits to redrawn data */
    double chi2;     /* sum of squared relative residuals, over the degrees of freedom */
    double residual; /* rms of ln(rms^2 / fitted): 0.2 is 20 % of rms^2 */
};

/* Returns the fitted rms at a setting; NaN if it needs a term that is absent. */
double orl_study_fit_predict(const struct orl_study_fit *fit,
                             const struct orl_study_setting *setting);

struct orl_study {
    uint32_t threads;  /* per run */
    double rays_per_s; /* rays per second of Embree alone in this scene, on one thread, to convert
                          seconds between machines. NaN: not known */
    bool of_views;
    struct orl_study_reference reference;
    struct orl_study_point *points; /* by technique, photons, samples, in the request's order */
    size_t n_points;
    struct orl_study_fit *fits; /* one per technique that has enough points */
    size_t n_fits;
    struct orl_study_external *external; /* copied from the request */
    size_t n_external;
    char **warnings; /* warnings of the runs, without repetition */
    size_t n_warnings;
};
void orl_study_done(struct orl_study *study); /* NULL and all zeros are fine */

/* ---- Running --------------------------------------------------------------------------------- */

/* Progress of a study: the current run of the reference or of a setting. */
struct orl_study_step {
    bool reference; /* true: `setting` is the reference's */
    struct orl_study_setting setting;
    bool in_parts; /* true: other processes make all runs; `run` is then the approximate number of
                      complete ones */
    uint32_t run, runs; /* current seed, from 1, and number of seeds */
    double fraction;    /* completed share of the study, by the estimated cost of its runs */
    double left_s;      /* estimated seconds left, from the runs so far */
};
/* "reference", "parts", "gather"... */
const char *orl_study_step_name(const struct orl_study_step *step);

struct orl_study_env {
    struct orl_thread_pool *pool;  /* borrowed; the calling thread leads it */
    const struct orl_files *files; /* borrowed */
    const char *work_folder;       /* exists; a subfolder is made in it and removed again */
    /* Borrowed: the study is distributed, with its tasks in that store. NULL: one process. */
    const struct orl_job_tasks *tasks;
    const struct orl_map_store *store;
    atomic_bool *cancel;        /* borrowed */
    double (*now_s)(void *ctx); /* monotonic clock, seconds */
    /* Called by the lead thread from time to time. May be NULL. */
    void (*progress)(void *ctx, const struct orl_study_step *step);
    /* Called when a point is complete except for on_front. May be NULL. */
    void (*point_ready)(void *ctx, const struct orl_study_point *point);
    /* Called at the end of every run, also after errors, as in orl_run_env. May be NULL. */
    void (*spent)(void *ctx, const struct orl_result *spent);
    void *ctx;
};

/* Runs the study. Returns 0 and fills ret_study (owned by the caller), or a negative orl_err. */
int orl_study_run(const struct orl_study_request *request, const struct orl_study_env *env,
                  struct orl_study *ret_study, struct orl_error *err);

/* Range of values that a logarithmic axis can show. */
#define ORL_STUDY_LEAST 1e-12
#define ORL_STUDY_MOST 1e12
bool orl_study_can_show(double value);

/* ---- Files ----------------------------------------------------------------------------------- */

/* Writes a header line and one line per point; whole or absent. */
int orl_study_write_csv(const struct orl_study *study, const char *path, struct orl_error *err);

#endif

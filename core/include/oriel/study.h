/*
 * Studies: what accuracy costs in time. A scene and its sensors, or its views, are computed by
 * several techniques, at several numbers of photons and samples, each with several seeds; all of
 * them are compared with one long run of the unbiased technique.
 *
 * Measures. Of sensor or pixel i, with value x_i in a run and r_i in the reference,
 *     e_i = (x_i - r_i) / max(r_i, floor)
 * where floor is 0.1 % of the mean reference for sensors (it guards against unlit ones) and 10 %
 * for pixels (a dark pixel's error is not seen next to bright ones). Then
 *     rms^2 = mean of e_i^2 over i and seeds, less the reference's own share, mean of s_i^2
 *     bias  = mean of e_i over i and seeds
 *     noise^2 = mean over i of the variance of e_i between seeds; needs two seeds
 *     p95   = 95th percentile of |e_i| over i and seeds, the reference's share included
 *     peak  = largest |e_i| of the brightest percent of pixels, mean over seeds; views only
 * with s_i the standard error of r_i, relative as e_i is. The reference is the mean of several runs
 * with seeds of their own, whose spread gives s_i; of one run, for sensors, it is what the run
 * itself knew. Several are better than one of as many samples: a run's virtual lamps are shared by
 * all its samples, so that no number of these mends what the lamps lack. Taking its share out of
 * rms^2 is right on average, since the reference's seeds are independent of all others; where that
 * share is more than a quarter of rms^2 the point is marked: its error is known badly. Sensors
 * whose reference is not known to 1 % are left out of everything. Relative errors are fractions:
 * 0.01 is 1 %.
 *
 * Time is what a user waits: every run starts without photon maps, and loads the scene. What was
 * measured on another machine is compared in ray-times: seconds times the rays that Embree alone
 * answers there in the same scene.
 *
 * A study that is shared (oriel/pieces.h) has each run as a piece: all numbers but times are those
 * of a study in one piece. Times are of whoever made the run; of nodes that differ, of each its
 * own.
 *
 * Ownership: a request and a study own what they point to. Threads: the calling thread leads the
 * crew; nothing is kept between calls. Errors as in error.h.
 */
#ifndef ORIEL_STUDY_H
#define ORIEL_STUDY_H

#include <oriel/pieces.h>
#include <oriel/run.h>

/* What a study varies. 0: the technique takes no notice of it. */
struct orl_study_setting {
    enum orl_technique technique;
    uint64_t photons; /* of each kind */
    uint32_t samples; /* of a sensor, or of a pixel */
};

/* A measurement of some other program, for comparison. */
struct orl_study_given {
    char *name;
    double seconds, rms;
    double rays_per_s; /* of the machine it was made on, as orl_study.rays_per_s; 0: not known */
    double here_s;     /* in results: seconds as they would be here, by both rates */
};

struct orl_study_request {
    struct orl_job job; /* scene, sky, wishes, sensors or views, first seed; what is varied is not
                           looked at */
    enum orl_technique *techniques;
    size_t n_techniques;
    uint64_t *photons;
    size_t n_photons;
    uint32_t *samples;
    size_t n_samples;
    uint32_t repeats;           /* seeds of every setting */
    uint32_t reference_samples; /* of a sensor, or of a pixel: of all its runs together */
    uint32_t reference_runs;    /* seeds that these are shared among */
    char *title, *note;         /* for people; NULL: none. note: where given points come from */
    struct orl_study_given *given;
    size_t n_given;
};
void orl_study_request_init(struct orl_study_request *request);
void orl_study_request_done(struct orl_study_request *request); /* NULL, half-filled: fine */

/* Checks what can be checked without the scene, and how many runs it comes to. Errors name the
 * member of a study document (study_json.h) that would have to change, as orl_error.primitive. */
int orl_study_request_validate(const struct orl_study_request *request, struct orl_error *err);

/* How many settings it comes to: the points of the study. */
size_t orl_study_count_settings(const struct orl_study_request *request);
/* Seconds of one core that it takes, roughly, with so many sensors: nothing of its scene is known.
 */
double orl_study_core_s(const struct orl_study_request *request, double sensors);
/* ORL_ERR_LIMIT when it comes to more runs than that, the reference's included. */
int orl_study_check_runs(const struct orl_study_request *request, uint32_t most,
                         struct orl_error *err);

/* Which settings the technique takes notice of, when it computes views or sensors. Sensors in
 * mid-air are gathered for by direct and precomputed too, with a job's default of samples. */
bool orl_study_heeds_photons(enum orl_technique technique);
bool orl_study_heeds_samples(enum orl_technique technique, bool of_views);

/* ---- Results --------------------------------------------------------------------------------- */

struct orl_study_point {
    struct orl_study_setting setting;
    uint32_t seeds;
    double stages_s[ORL_STAGE_COUNT], total_s; /* means over seeds */
    double total_error_s;                      /* standard error of that mean */
    double rms, rms_error;                     /* rms_error: standard error, by the seeds' spread */
    double bias, bias_error;                   /* bias_error: of seeds and reference */
    double noise;                              /* NaN with one seed */
    double p95;
    double peak;          /* NaN without views */
    uint64_t map_bytes;   /* photon maps, of one seed */
    bool reference_shows; /* the reference's noise is more than a quarter of rms^2 */
    bool on_front;        /* no other point is both faster and more accurate */
};

struct orl_study_reference {
    uint32_t samples, runs;
    size_t values, left_out; /* sensors or pixels compared, and those known too badly */
    double standard_error;   /* rms of s_i over those compared */
    double worst;            /* largest s_i of those compared */
    double seconds;
};

/*
 * A technique's error by its settings, N photons and S samples:
 *     rms^2 = kernel + spread / N + bias / N^2 + samples / S
 * See core/study/fit.h for where that comes from. A term that the settings cannot tell from the
 * others is absent: NaN.
 */
enum orl_fit_term { ORL_FIT_KERNEL, ORL_FIT_SPREAD, ORL_FIT_BIAS, ORL_FIT_SAMPLES, ORL_FIT_TERMS };
const char *orl_fit_term_name(enum orl_fit_term term); /* "kernel", "spread", ... */

struct orl_study_fit {
    enum orl_technique technique;
    size_t points;
    double terms[ORL_FIT_TERMS];  /* not negative, or NaN */
    double errors[ORL_FIT_TERMS]; /* standard deviation over refits to redrawn data */
    double chi2;                  /* of relative residuals, over the degrees of freedom */
    double residual;              /* rms of ln(rms^2 / fitted): 0.2 is 20 % of rms^2 */
};

/* The fitted rms at a setting; NaN where it needs a term that is absent. */
double orl_study_fit_predict(const struct orl_study_fit *fit,
                             const struct orl_study_setting *setting);

struct orl_study {
    uint32_t threads;  /* of a run */
    double rays_per_s; /* single rays that Embree alone answers in this scene, on one thread: what
                          seconds here are worth elsewhere. NaN: not known */
    bool of_views;
    struct orl_study_reference reference;
    struct orl_study_point *points; /* by technique, photons, samples, in the request's order */
    size_t n_points;
    struct orl_study_fit *fits; /* one per technique that has enough points */
    size_t n_fits;
    struct orl_study_given *given; /* the request's */
    size_t n_given;
    char **warnings; /* of the runs, each once */
    size_t n_warnings;
};
void orl_study_done(struct orl_study *study); /* NULL and all zeros are fine */

/* ---- Running --------------------------------------------------------------------------------- */

/* Where a study has got to: a run of the reference or of a setting. */
struct orl_study_step {
    bool reference; /* then setting is the reference's */
    struct orl_study_setting setting;
    bool in_parts; /* all runs at once, by others: then run is about how many of them are made */
    uint32_t run, runs; /* the seed it is at, from 1, and how many there are */
    double fraction;    /* of the whole study, by what its runs are thought to cost */
    double left_s;      /* of it, likewise, from what they took so far */
};
const char *
orl_study_step_name(const struct orl_study_step *step); /* "reference", "parts", "gather"... */

struct orl_study_env {
    struct orl_crew *crew;         /* borrowed; the calling thread leads it */
    const struct orl_files *files; /* borrowed */
    const char *work_folder;       /* exists; a folder is made in it and removed again */
    /* Borrowed: the study is shared, its pieces are in that store. NULL: it is not. */
    const struct orl_pieces *pieces;
    const struct orl_map_store *store;
    atomic_bool *cancel;        /* borrowed */
    double (*now_s)(void *ctx); /* a steady clock */
    /* Called by the lead thread, now and then. May be NULL. */
    void (*progress)(void *ctx, const struct orl_study_step *step);
    /* A point is settled, but for whether it is on the front. May be NULL. */
    void (*point_ready)(void *ctx, const struct orl_study_point *point);
    /* At the end of every run, however it ends, as in orl_run_env. May be NULL. */
    void (*spent)(void *ctx, const struct orl_result *spent);
    void *ctx;
};

/* Returns 0 and fills ret_study, the caller's, or a negative orl_err. */
int orl_study_run(const struct orl_study_request *request, const struct orl_study_env *env,
                  struct orl_study *ret_study, struct orl_error *err);

/* What can be shown on a logarithmic axis that ends somewhere. */
#define ORL_STUDY_LEAST 1e-12
#define ORL_STUDY_MOST 1e12
bool orl_study_can_show(double value);

/* ---- Files ----------------------------------------------------------------------------------- */

/* A line per point, one of names above them; whole or absent. */
int orl_study_write_csv(const struct orl_study *study, const char *path, struct orl_error *err);

#endif

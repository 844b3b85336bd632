/*
 * Runs one job from its document to its results. This is the only way into the renderer, both for
 * the daemon's workers and for `oriel run`.
 *
 * A run has the stages load -> bvh -> plan -> photons -> maps -> render. It owns nothing of the
 * caller's. Files come from a provider. Photon maps and loaded BSDFs are read from and written to a
 * store. The caller lends the threads (a pool) and a callback that reads the time. Images are
 * written below an output folder. The same job, files and seed give the same bytes for any number
 * of threads.
 */
#ifndef ORIEL_JOB_RUN_H
#define ORIEL_JOB_RUN_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>
#include <oriel/base/input_checks.h>
#include <oriel/base/memory_cache.h>
#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>
#include <oriel/job/glare.h>
#include <oriel/job/job_tasks.h>
#include <oriel/job/picture.h>
#include <oriel/job/plan.h>
#include <oriel/job/sky.h>

/* ---- The job --------------------------------------------------------------------------------- */

struct orl_sensor {
    struct orl_vec3 position;  /* scene units */
    struct orl_vec3 direction; /* need not be unit */
};

/* Named group of sensors. Results of the group carry the name. */
struct orl_grid_request {
    char *name; /* letters, digits, '-', '_', '.', and '/' between folders; unique in the job */
    char *file; /* file of sensors in the format of sensors_file; NULL: the range below of the job's
                   sensors */
    size_t first, count;
};

struct orl_view_request {
    char *name;  /* file name stem: letters, digits, '-', '_', '.'; unique in the job */
    char *view;  /* Radiance view options, "-vtv -vp ... "; NULL: read them from file */
    char *file;  /* name of a scene file with lines of view options */
    char *entry; /* line in file: its number from 1, or its name; NULL: the only one */
    uint32_t width, height;
    bool irradiance;     /* irradiance of visible surfaces, W/m2, instead of radiance (rpict -i) */
    double pixel_aspect; /* above 0: the image shrinks in one direction to reach it (rpict -pa) */
    uint32_t formats;    /* bits of enum orl_picture_format; 0: ORL_PICTURES_DEFAULT */
    struct orl_display display;
    struct orl_false_color false_color;
    uint32_t metrics; /* bits of enum orl_glare_metric; 0: no glare results */
    struct orl_glare_settings glare;
};

/*
 * Goal of a job that leaves the sample counts to the run: an accuracy or a time, not both. The run
 * goes in rounds (run/goals/rounds.h) until the goal is met or cannot be met.
 */
struct orl_goal {
    double relative_error; /* 0: none. |x - truth| / truth, with study.h's floors */
    double at;             /* share of sensors or pixels that must meet relative_error; 0..1 */
    double dgp_error;      /* 0: none. Half the 95 % interval of DGP, for every view with metrics */
    double deadline_s;     /* 0: none. Limit for the whole run, from its start */
};

/* A job. It owns its strings and arrays; orl_job_done frees them. */
struct orl_job {
    char **scene_files; /* names of the main files, in order, for the provider */
    size_t n_scene_files;
    enum orl_technique technique;
    enum orl_effect_override overrides[ORL_EFFECT_COUNT];
    uint64_t seed;
    uint64_t photons_global, photons_caustic; /* targets, or ORL_PHOTONS_BY_PLAN; ignored for a map
                                                 that the plan does without */
    bool photons_exact;         /* true: the caustic count is not limited by the caustics' yield
                                   (plan/plan.h) */
    uint32_t gather_samples;    /* per sensor; 0 = default */
    uint32_t pixel_samples;     /* per pixel, backward technique only; 0 = default */
    struct orl_goal goal;       /* replaces photon and sample counts */
    bool dark_expected;         /* true: results without any light are no error */
    struct orl_sky_request sky; /* job's own sky; the scene must then have no distant sources */
    /* Alternative to sky: skies rendered one after the other (oriel/job/skies.h). */
    struct orl_named_sky *skies;
    size_t n_skies;
    char *sensors_file; /* NULL, or a file of "x y z dx dy dz" lines */
    struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_grid_request *grids; /* alternative to sensors_file; `sensors` holds those of the
                                       grids without a file, in grid order */
    size_t n_grids;
    struct orl_heat_map_request heat_map; /* heat map of the sensors */
    /* true: also without a request, a table of all sensors and a map of each grid, or of the
     * sensors, are written */
    bool sensor_files;
    struct orl_sequence_request sequence; /* one per view, over the skies */
    struct orl_view_request *views;
    size_t n_views;
};

#define ORL_PHOTONS_BY_PLAN UINT64_MAX
enum {
    ORL_DEFAULT_PHOTONS = 2000000,
    ORL_DEFAULT_GATHER_SAMPLES = 4096,
    ORL_DEFAULT_PIXEL_SAMPLES = 64,
    ORL_DEFAULT_GLARE_PIXEL_SAMPLES = 16 /* for a job with metrics */
};

void orl_job_init(struct orl_job *job); /* sets the defaults and clears the rest */
/* Returns true if at least one view has metrics. */
bool orl_job_asks_for_glare(const struct orl_job *job);
void orl_job_done(struct orl_job *job); /* frees what job owns; NULL and half-filled are fine */

/*
 * Reads the options of one view from the lines of a file. `entry` is the view's number from 1 or
 * its name; NULL: the only view of the file. A view line begins with VIEW=, rpict, rvu or rview (as
 * pictures and programs write them), with view= and a name (as in rad's files), or with an option.
 * Other lines are skipped. *ret_text is owned by the caller. Returns ORL_ERR_NOT_FOUND,
 * ORL_ERR_INVALID, or the error of the options, with the line.
 */
int orl_view_file_read(const char *name, const char *text, size_t size, const char *entry,
                       char **ret_text, struct orl_error *err);
/* Joins two lists of options. An option in `more` overrides the same option in `options`; `more`
 * may be NULL. Returns an owned string, or NULL when memory runs out. */
char *orl_view_text_join(const char *options, const char *more);

/* Returns the image size that a view's options -x and -y ask for; 0 for a missing option. */
int orl_view_text_size(const char *text, uint32_t *ret_width, uint32_t *ret_height,
                       struct orl_error *err);

/* Returns true if a view's options give a fisheye picture of a whole hemisphere or more. */
bool orl_view_text_is_fisheye(const char *text);

/* Checks everything that needs no scene: counts, limits, names, view strings. */
int orl_job_validate(const struct orl_job *job, struct orl_error *err);

/* ---- Photon map store ------------------------------------------------------------------------ */

enum { ORL_DIGEST_HEX = 64 };

struct orl_map_info {
    /* "global", "caustic" or "precomputed" for photon maps. A store also has other kinds. "bsdf" is
     * a BSDF as it is after loading; `stored` counts its values, and nothing is emitted. "scene" is
     * the parsed content of a scene's files; `stored` counts surfaces. "annual" holds data of
     * annual runs. "made" is a BSDF made from geometry or measurements (oriel/bsdf/bsdf_store.h);
     * `emitted` counts its paths or rows. "pilot" is what a pilot of photons measured of a scene
     * and its lights. */
    char kind[16];
    char key[ORL_DIGEST_HEX + 1]; /* digest of all inputs that determine the map, lower-case hex */
    /* Digest of the same inputs without the target: of two maps of one family the larger continues
     * the smaller. Empty: the map is always built as a whole. */
    char family[ORL_DIGEST_HEX + 1];
    uint64_t target; /* requested photons */
    uint64_t emitted, stored, bytes;
    uint64_t reused;  /* stored photons taken over from a smaller map */
    double seconds;   /* total build time, including the smaller map's where it is known */
    double earlier_s; /* part of `seconds` that earlier jobs spent */
    bool cached;      /* true: this job found the map ready */
};

/*
 * Store of photon maps, and BSDFs and scenes that are slow to load, between jobs. All calls come
 * from the run's lead thread.
 */
struct orl_map_store {
    void *ctx;
    /*
     * Requests a map. Returns 0. On a hit *ret_hit is true, ret_path names a complete file, and
     * *ret_info holds the committed data. On a miss *ret_hit is false, and the caller must create
     * the file at ret_path. May wait while another job builds the same key; returns
     * ORL_ERR_CANCELLED once *cancel is set. A hit stays pinned until release.
     */
    int (*acquire)(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                   char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                   struct orl_error *err);
    /* Commits the file after a miss. The file at ret_path is complete but not synced. It becomes
     * visible, and stays pinned until release. */
    int (*commit)(void *ctx, const struct orl_map_info *info, struct orl_error *err);
    /* Drops the file after a failed miss, or after a hit that proved corrupt. */
    void (*abandon)(void *ctx, const char *kind, const char *key);
    /* Unpins a map after a hit, a commit, or a smaller map found. */
    void (*release)(void *ctx, const char *kind, const char *key);
    /*
     * Looks for the largest complete map of the family that was built for fewer photons than
     * target. Returns 0. If *ret_found, ret_path names its file, *ret_info holds the committed
     * data, and the map stays pinned until release. A NULL callback disables topping up.
     */
    int (*find_smaller)(void *ctx, const char *kind, const char *family, uint64_t target,
                        char ret_path[4096], bool *ret_found, struct orl_map_info *ret_info,
                        struct orl_error *err);
};

/* State of a store with maps as <folder>/<kind>-<key>.opm, for one process at a time. */
struct orl_folder_store {
    char folder[4096];
};
struct orl_map_store orl_map_store_in_folder(struct orl_folder_store *state);

/* Checks that the photon map at `path` is intact; reads the whole file. Returns 0, ORL_ERR_IO,
 * _CORRUPT or _VERSION. Files of kinds "bsdf" and "scene" are not checked: a job that opens one
 * verifies all of it. */
int orl_map_verify(const char *kind, const char *path, struct orl_error *err);

/* ---- Results --------------------------------------------------------------------------------- */

enum orl_stage {
    ORL_STAGE_LOAD,
    ORL_STAGE_BVH,
    ORL_STAGE_PLAN,
    ORL_STAGE_PHOTONS,
    ORL_STAGE_MAPS,
    ORL_STAGE_RENDER,
    ORL_STAGE_COUNT
};
const char *orl_stage_name(enum orl_stage stage); /* "load", "bvh", "plan", ... */

/* Value at a labelled point, in the unit of the view's false colours; NaN where the view sees
 * nothing. */
struct orl_point_value {
    char name[ORL_PICTURE_LABEL_MAX];
    double value;
};

/* Sensor result files, as names below the output folder. */
struct orl_sensor_files {
    char *csv, *res; /* all sensors, one line each; NULL: not requested */
    struct {
        char *png, *svg; /* svg: NULL without a request for heat maps */
        char *dat; /* Radiance data file; NULL: not requested, or the sensors are no full grid */
        size_t sensors;
    } maps[ORL_HEAT_MAPS]; /* one per plane, planes with the most sensors first */
    size_t n_maps;
};
void orl_sensor_files_done(struct orl_sensor_files *files);

/* Result files of a grid, as names below the output folder. Owned. */
struct orl_grid_result {
    char *name;
    size_t first, count; /* range of the result's sensors */
    char *res, *npy;     /* text with one value a line; NumPy array */
    char *map;           /* PNG; NULL: not requested, or too few sensors lie in one plane */
};
enum { ORL_GRID_MAPS = 256 }; /* largest number of grids with maps */

struct orl_view_result {
    char *name;
    char *files[ORL_PICTURES];      /* names below the output folder; NULL: no such file */
    double scale;                   /* top value of the false colours; 0: there are none */
    struct orl_point_value *points; /* labelled points; owned */
    size_t n_points;
    struct orl_glare *glare; /* owned; NULL: no metrics requested */
    uint32_t metrics;        /* requested metrics, bits of enum orl_glare_metric */
    double seconds;
    bool black; /* true: no pixel has any light */
};

/* Classes of light at a sensor, by the path that the light takes. */
enum orl_light_class {
    ORL_LIGHT_STRAIGHT,  /* suns and lamps, directly or through panes */
    ORL_LIGHT_MIRRORED,  /* suns and lamps, by flat mirrors and panes */
    ORL_LIGHT_OUTDOORS,  /* sky, outdoor objects and glow sources, without diffuse reflection */
    ORL_LIGHT_REFLECTED, /* reflected diffusely, indoors or by surfaces beside the sensor */
    ORL_LIGHT_CLASSES
};
const char *orl_light_class_name(enum orl_light_class light); /* "reflected light", ... */

/* Comparison of sensors with plain path tracing (run/diagnostics/cross_check.c). */
struct orl_cross_check {
    uint64_t paths; /* 0: no sensors were compared */
    size_t sensors; /* sensors with enough paths for a comparison */
    /* Sensors that differ by more than both errors; their intervals are widened. */
    size_t sensors_off;
    /* Class of light that fits the difference best, if sensors_off > 0. */
    enum orl_light_class differs_in;
    double ratio, ratio_error; /* light found by paths over light found by the run, over all
                                  sensors, and the standard error of the former; NaN: not known, or
                                  paths find less where they cannot find all */
};

/* Reasons why a sensor's value is unreliable, as flags. Its interval was widened to include the
 * value that another method found. The remaining error beyond that is not known. */
enum orl_doubt {
    ORL_DOUBT_CROSS_CHECK =
        1, /* plain path tracing finds a different value (run/diagnostics/cross_check.c) */
    ORL_DOUBT_MISSED_LIGHT =
        2 /* photons carry light that paths hardly ever find (run/diagnostics/missed_light.c) */
};
enum { ORL_DOUBTS = 2 };
const char *orl_doubt_name(enum orl_doubt doubt); /* "cross-check", "missed-light" */

/* Outcome of a job with a goal. */
enum { ORL_ERROR_HISTORY = 48 };
struct orl_outcome {
    bool asked, met;
    struct orl_goal goal; /* copy of the job's goal */
    uint32_t rounds;
    double achieved;       /* estimated relative error at the goal's share; NaN: not known */
    char why[ORL_WHY_MAX]; /* reason for the end of the run, and advice where the goal is not met */
    /* Error after rounds, with the seconds since the run's start. The first and the latest round
     * are always included. When the array is full, every second entry is dropped. */
    struct {
        double seconds, error;
    } error_history[ORL_ERROR_HISTORY];
    uint32_t n_error_history;
};

/* Work that the run took, besides its times, and the estimated seconds of whole runs with a smaller
 * error. */
struct orl_cost {
    uint64_t rays, photons;
    double error;   /* relative error, at the goal's share or 0.95; basis of the two times below */
    double halve_s; /* run time for half of `error`; NaN: out of reach, or not known */
    double one_percent_s;    /* run time for an error of 1 %; 0: already reached */
    char model[ORL_WHY_MAX]; /* one sentence on how the times are estimated */
};

/* Predicted seconds of a job by `technique` for a series of relative errors, at the goal's share or
 * 0.95, on `threads` threads. The series starts at the pilot's own error and falls. */
enum { ORL_ACCURACY_CURVE_POINTS = 10 };
struct orl_accuracy_curve {
    enum orl_technique technique;
    uint32_t threads;
    struct {
        double seconds, error;
    } points[ORL_ACCURACY_CURVE_POINTS];
    uint32_t n_points;       /* 0: not known */
    char model[ORL_WHY_MAX]; /* method, as in orl_cost, or the reason why there is no curve */
};

enum { ORL_RESULT_MAPS = 3 };

struct orl_result {
    uint32_t threads;
    uint64_t seed;
    struct orl_plan plan; /* simulated effects, with reasons */
    const char *no_curve; /* set by orl_plan_job: why no accuracy can be predicted; NULL: a pilot
                             can predict it */
    double timings_s[ORL_STAGE_COUNT];
    double total_s;
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    /* Arrays with one entry per sensor; base/statistics/estimate.h defines the quantities. */
    double *illuminance_lx;
    double *standard_error_lx;   /* standard error of photons and rays together */
    double *bias_estimate_lx;    /* estimated bias due to kernel bandwidth */
    double (*interval_95_lx)[2]; /* low, high */
    unsigned char *doubts;       /* bits of enum orl_doubt; NULL: all values are reliable */
    size_t n_sensors;
    struct orl_grid_result *grids;
    size_t n_grids;
    char *grids_info; /* file name: grid list for Honeybee's tools; NULL: none */
    struct orl_sensor_files sensor_files;
    struct orl_view_result *views;
    size_t n_views;
    bool sky_given; /* true: the job has a sky */
    bool sky_dark;  /* true: that sky gives no light (night, or no measurements) */
    struct orl_outcome outcome;
    struct orl_cross_check cross_check;
    struct orl_cost cost;
    struct orl_health health; /* numerical health counters of this run */
    char **warnings;
    size_t n_warnings;
};
void orl_view_result_done(struct orl_view_result *view);
void orl_result_done(struct orl_result *result);

/* Figures of a range of a result's sensors. Values that are not finite are left out. */
struct orl_sensor_summary {
    size_t sensors; /* sensors with a value; 0: all other members are NaN */
    double mean_lx, minimum_lx, maximum_lx;
    /* Mean of the sensors' interval bounds. It contains the interval of the mean, also where the
     * errors of all sensors are alike, as those of photon maps may be. */
    double interval_95_lx[2];
    double uniformity; /* minimum over mean (EN 12464-1); NaN if the mean is 0 */
    double share_300;  /* share of sensors with 300 lx or more, 0..1 */
};
struct orl_sensor_summary orl_sensor_summary_of(const struct orl_result *result, size_t first,
                                                size_t count);

/* ---- Running --------------------------------------------------------------------------------- */

struct orl_run_env {
    struct orl_thread_pool *pool;      /* borrowed; the calling thread leads it */
    const struct orl_files *files;     /* borrowed */
    const struct orl_map_store *store; /* borrowed; NULL: maps are dropped with the run */
    /* Borrowed; set if several processes share the run (oriel/job/job_tasks.h); NULL: one
     * process. */
    const struct orl_job_tasks *tasks;
    struct orl_memory_cache
        *memory_cache;         /* borrowed; in-memory cache shared with later jobs; may be NULL */
    const char *files_id;      /* identity of the job's files, whatever their names; jobs with equal
                                  identities share scenes in the memory cache. NULL: no sharing */
    const char *output_folder; /* exists; images are written here */
    const char *file_prefix;   /* prefix of the names of files written there; NULL: none */
    double part_from, part; /* offset and share of this run within a larger job, for progress; 0: it
                               is the whole job */
    double part_after_s; /* estimated time of the work after this run; 0: estimated in proportion to
                            the shares */
    const double *part_stages_s; /* estimated seconds by stage (enum orl_stage), from earlier parts;
                                    borrowed; NULL: defaults of any job */
    atomic_bool *cancel;         /* borrowed; polled per batch and tile */
    double (*now_s)(void *ctx);  /* monotonic clock, seconds */
    /* Called by the lead thread from time to time, with the fraction 0..1 of the stage and of the
     * job, and the estimated seconds left. The job's fraction never falls, and reaches 1 at the
     * end. The seconds left may rise (oriel/base/eta.h). */
    void (*progress)(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                     double left_s);
    /* Called by the lead thread once the plan is complete. May be NULL. */
    void (*plan_ready)(void *ctx, const struct orl_plan *plan);
    /* Called by the lead thread for each warning, possibly several times with the same text. The
     * text is valid during the call. May be NULL. */
    void (*warned)(void *ctx, const char *warning);
    /* Called by the lead thread when a map is ready (hit or built). May be NULL. */
    void (*map_ready)(void *ctx, const struct orl_map_info *info);
    /* Called by the lead thread when a view is rendered. `pixels` holds W/sr/m2, row by row from
     * the top left. `errors` holds the standard errors of their luma (NULL: not known). Both are
     * valid during the call. May be NULL. */
    void (*view_ready)(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                       size_t count);
    /*
     * For jobs without a goal. Called by the lead thread before a view is rendered. Returns true if
     * an earlier run of the same job left the view's files in the output folder. Then *ret_view is
     * filled, its strings allocated by malloc for the run to free, and rendering is skipped. May be
     * NULL.
     */
    bool (*view_kept)(void *ctx, size_t index, struct orl_view_result *ret_view);
    /* Called by the lead thread once the files of a view are written. The view is valid during the
     * call. May be NULL. */
    void (*view_written)(void *ctx, size_t index, const struct orl_view_result *view);
    /*
     * Counterpart of view_kept for all sensors together. The result has room for the sensor arrays,
     * from illuminance_lx to interval_95_lx; no other field is set yet. May be NULL.
     */
    bool (*sensors_kept)(void *ctx, struct orl_result *result);
    void (*sensors_done)(void *ctx, const struct orl_result *result);
    /*
     * Called by the lead thread after each round of a job with a goal, with the intermediate result
     * and its files. The result is valid during the call. May be NULL.
     */
    void (*round_ready)(void *ctx, const struct orl_result *result);
    /*
     * Called by the lead thread at the end of a run, also after errors. Only timings_s, total_s and
     * health are set, for the work done. The result is valid during the call. May be NULL.
     */
    void (*spent)(void *ctx, const struct orl_result *spent);
    void *ctx;
};

/*
 * Builds the job's plan without rendering: loads the scene and runs the pilot. Returns 0 and fills
 * ret_result as orl_run does, except for maps, sensors and views. The store is used for BSDFs only.
 */
int orl_plan_job(const struct orl_job *job, const struct orl_run_env *env,
                 struct orl_result *ret_result, struct orl_error *err);

/*
 * Predicts the run time over accuracy for the job on this machine. `technique` is the plan's; the
 * job's own settings are ignored. Renders two small rounds and applies the model of orl_cost. Their
 * maps are not stored. Otherwise the same as orl_plan_job.
 */
int orl_plan_accuracy_curve(const struct orl_job *job, const struct orl_run_env *env,
                            enum orl_technique technique, struct orl_accuracy_curve *ret_curve,
                            struct orl_error *err);

/*
 * Runs the job, which has at most one sky. Returns 0 and fills ret_result (owned by the caller), or
 * returns a negative orl_err. Returns ORL_ERR_UNLIT if all requested results are black, unless the
 * job expects that or its sky gives no light.
 */
int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err);

/* ---- Checks before a job is accepted --------------------------------------------------------- */

struct orl_scene_summary {
    uint64_t surfaces, materials, sources, triangles, bsdfs;
    uint64_t placed_surfaces; /* surfaces of instances, counted once for each placement */
    double bounds_min[3], bounds_max[3];
    char digest[ORL_DIGEST_HEX + 1];
    char **referenced; /* names of files that the scene includes beyond its main ones */
    size_t n_referenced;
};

/*
 * Allocates the per-thread state of libraries in a thread that builds scenes. If memory runs out
 * during this allocation, the libraries may end the process; later they only fail. Call it once in
 * each thread that must survive, while memory is available. Scenes can be built without it. A child
 * process inherits the state from the thread that forks. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_prepare_thread(struct orl_error *err);

/* Parses the scene and all files it refers to, as a job would, and returns a summary. Returns
 * ORL_ERR_CANCELLED once *cancel is set; cancel may be NULL. */
int orl_scene_check(const char *const *main_files, size_t n_files, const struct orl_files *files,
                    const atomic_bool *cancel, struct orl_scene_summary *ret_summary,
                    struct orl_error *err);
void orl_scene_summary_done(struct orl_scene_summary *summary);

/*
 * Guesses the scene files of a folder. These are the Radiance files (.rad) at its top that no
 * command line (one that starts with '!', such as !xform) of another Radiance file in the folder
 * names. The top is the folder with Radiance files that is nested least deep. If several folders
 * are equally deep, no file is chosen. Sets ret_main for each name. Returns ORL_ERR_LIMIT for far
 * too many commands, or the error of files->open.
 */
int orl_scene_guess_main(const char *const *names, size_t count, const struct orl_files *files,
                         bool *ret_main, struct orl_error *err);

/*
 * Reads a file of sensors, for `oriel run`, `oriel submit` and the daemon. Each line has six
 * numbers, x y z dx dy dz, separated by blanks, commas or semicolons; '#' begins a comment. Calls
 * `take` for each sensor; `take` returns a negative number when memory runs out, and then the
 * function returns ORL_ERR_NOMEM.
 */
int orl_sensors_read(const char *name, const char *text, size_t size,
                     int (*take)(void *ctx, const double v[6]), void *ctx, struct orl_error *err);

/* Checks that a job would accept the bytes as a sensor file or a weather file; returns the number
 * of sensors. Errors are those of the job, with file and line. No sensors stay in memory. */
int orl_sensors_check(const char *name, const char *text, size_t size, size_t *ret_count,
                      struct orl_error *err);
int orl_weather_check(const char *name, const char *text, size_t size, int year,
                      struct orl_error *err);
/* Reads the files that the job's views name (view lines and glare masks), as the job would. */
int orl_views_check(const struct orl_job *job, const struct orl_files *files,
                    struct orl_error *err);

#endif

/*
 * One job from its document to its results: the only way into the renderer, for the daemon's
 * workers, for `oriel run`, and for whatever comes later.
 *
 * A run goes load -> bvh -> plan -> photons -> maps -> render. It owns nothing of the caller's:
 * files come from a provider, photon maps and loaded BSDFs go to and come from a store, threads are
 * lent by the caller (a crew), time is read through a callback, images are written below an output
 * folder.
 * Given the same job, files and seed the results are the same bytes for any crew size.
 */
#ifndef ORIEL_RUN_H
#define ORIEL_RUN_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/crew.h>
#include <oriel/error.h>
#include <oriel/files.h>
#include <oriel/glare.h>
#include <oriel/health.h>
#include <oriel/picture.h>
#include <oriel/pieces.h>
#include <oriel/plan.h>
#include <oriel/sequence.h>
#include <oriel/shelf.h>
#include <oriel/sky.h>
#include <oriel/vec.h>

/* ---- The job --------------------------------------------------------------------------------- */

struct orl_sensor {
    struct orl_vec3 position;  /* scene units */
    struct orl_vec3 direction; /* need not be unit */
};

/* Sensors that belong together: results keep their name. */
struct orl_grid_request {
    char *name; /* letters, digits, '-', '_', '.', and '/' between folders; unique in the job */
    char *file; /* of such sensors as sensors_file has; NULL: some of the job's, namely ... */
    size_t first, count;
};

struct orl_view_request {
    char *name;  /* file name stem: letters, digits, '-', '_', '.'; unique in the job */
    char *view;  /* Radiance view options, "-vtv -vp ... "; or NULL, and then: */
    char *file;  /* one of the scene's, with lines of such */
    char *entry; /* which of them: its number from 1, or its name; NULL: the only one */
    uint32_t width, height;
    bool irradiance;     /* of the surfaces seen, W/m2, instead of their radiance (rpict -i) */
    double pixel_aspect; /* above 0: the image is made as much smaller as that takes (rpict -pa) */
    uint32_t formats;    /* of orl_picture_format, as bits; 0: ORL_PICTURES_USUAL */
    struct orl_display display;
    struct orl_false_color false_color;
    uint32_t metrics; /* of enum orl_glare_metric, as bits; 0: nothing is told of its glare */
    struct orl_glare_settings glare;
};

/*
 * What a job wants of its results when it leaves the settings to the run: an accuracy or a time,
 * not both. The run goes in rounds (run/rounds.h) until the goal is met or cannot be.
 */
struct orl_goal {
    double relative_error; /* 0: none. |x - truth| / truth, with study.h's floors */
    double at;             /* the share of sensors, or of pixels, that is to keep to it; 0..1 */
    double dgp_error;      /* 0: none. Half the 95 % interval of DGP, of every view with metrics */
    double deadline_s;     /* 0: none. Of the whole run, from its start */
};

/* What to compute. Strings and arrays are owned; orl_job_done frees them. */
struct orl_job {
    char **scene_files; /* names of the main files, in order, for the provider */
    size_t n_scene_files;
    enum orl_technique technique;
    enum orl_wish wishes[ORL_EFFECT_COUNT];
    uint64_t seed;
    uint64_t photons_global, photons_caustic; /* targets, or ORL_PHOTONS_BY_PLAN; of a map that the
                                                 plan does without there is none */
    bool photons_exact; /* caustic ones are not bounded by what they are worth (plan/budget.h) */
    uint32_t gather_samples;     /* per sensor; 0 = default */
    uint32_t pixel_samples;      /* of the backward technique; 0 = default */
    struct orl_goal goal;        /* instead of the three above */
    bool dark_expected;          /* results without any light are no error */
    struct orl_sky_request sky;  /* beside a scene without distant sources */
    struct orl_named_sky *skies; /* instead, one after the other: oriel/skies.h */
    size_t n_skies;
    char *sensors_file; /* NULL, or a file of "x y z dx dy dz" lines */
    struct orl_sensor *sensors;
    size_t n_sensors;
    struct orl_grid_request *grids; /* instead of sensors_file; sensors are those of the grids that
                                       have no file, in the same order */
    size_t n_grids;
    struct orl_heat_map_request heat_map; /* of the sensors */
    struct orl_sequence_request sequence; /* of each view under the skies */
    struct orl_view_request *views;
    size_t n_views;
};

#define ORL_PHOTONS_BY_PLAN UINT64_MAX
enum {
    ORL_DEFAULT_PHOTONS = 2000000,
    ORL_DEFAULT_GATHER_SAMPLES = 4096,
    ORL_DEFAULT_PIXEL_SAMPLES = 64,
    ORL_DEFAULT_GLARE_PIXEL_SAMPLES = 16 /* of a job that asks for metrics */
};

void orl_job_init(struct orl_job *job); /* defaults, nothing else set */
/* Whether some view of it has metrics. */
bool orl_job_asks_for_glare(const struct orl_job *job);
void orl_job_done(struct orl_job *job); /* frees what job owns; NULL and half-filled are fine */

/*
 * A view among the lines of a file, by its number from 1 or by its name; NULL: the only one. A line
 * begins with VIEW=, rpict, rvu or rview as pictures and programs write them, with view= and a name
 * as rad's files have it, or with an option; other lines are passed over. *ret_text is owned.
 * ORL_ERR_NOT_FOUND, ORL_ERR_INVALID, or what is wrong with the options, with the line.
 */
int orl_view_file_read(const char *name, const char *text, size_t size, const char *entry,
                       char **ret_text, struct orl_error *err);
/* Options, then more of them, whose word is the last; more may be NULL. Owned; NULL: no memory. */
char *orl_view_text_join(const char *options, const char *more);

/* The size that a view's options ask for, by -x and -y; 0 of what they do not say. */
int orl_view_text_size(const char *text, uint32_t *ret_width, uint32_t *ret_height,
                       struct orl_error *err);

/* Checks what can be checked without the scene: counts, limits, names, view strings. */
int orl_job_validate(const struct orl_job *job, struct orl_error *err);

/* ---- Photon map store ------------------------------------------------------------------------ */

enum { ORL_DIGEST_HEX = 64 };

struct orl_map_info {
    /* "global", "caustic" or "precomputed"; in a store also "bsdf": no photon map, but a BSDF kept
     * as it is after loading, in which stored counts values and nothing is emitted; "scene", what a
     * scene's files say, in which it counts surfaces; "annual"; and "made": a BSDF made of geometry
     * or measurements (oriel/bsdf_kept.h), whose paths, or rows, are emitted. */
    char kind[16];
    char key[ORL_DIGEST_HEX + 1]; /* digest of all that determines the map, lower-case hex */
    /* Digest of all of that but the target: of two maps of one family the larger continues the
     * smaller. Empty: the map is made as a whole. */
    char family[ORL_DIGEST_HEX + 1];
    uint64_t target; /* photons asked for */
    uint64_t emitted, stored, bytes;
    uint64_t reused;  /* of those stored, how many were taken over from a smaller map */
    double seconds;   /* what building it took in all, with the smaller map, where that is known */
    double earlier_s; /* of these, what jobs before this one spent */
    bool cached;      /* true when this job found it ready */
};

/*
 * Where maps, and BSDFs and scenes that take time to load, live between jobs. All calls come from
 * the run's lead thread.
 */
struct orl_map_store {
    void *ctx;
    /*
     * Asks for the map. Returns 0 with ret_path naming a complete file (ret_hit true, and *ret_info
     * filled with what was committed) or a path at which the caller is to create it (ret_hit
     * false). May wait while another job builds the same key; gives up with ORL_ERR_CANCELLED when
     * *cancel. A hit stays pinned until release.
     */
    int (*acquire)(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                   char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                   struct orl_error *err);
    /* After a miss: the file at that path is complete, not synced. It becomes visible, and pinned.
     */
    int (*commit)(void *ctx, const struct orl_map_info *info, struct orl_error *err);
    /* After a miss that failed, or a hit that proved corrupt: drops the file. */
    void (*abandon)(void *ctx, const char *kind, const char *key);
    /* Unpins after a hit, a commit, or a smaller map found. */
    void (*release)(void *ctx, const char *kind, const char *key);
    /*
     * Looks for the largest complete map of the family that was made for fewer photons than target.
     * Returns 0; where *ret_found, ret_path names its file, *ret_info holds what was committed, and
     * it stays pinned until release. NULL: maps are never topped up.
     */
    int (*find_smaller)(void *ctx, const char *kind, const char *family, uint64_t target,
                        char ret_path[4096], bool *ret_found, struct orl_map_info *ret_info,
                        struct orl_error *err);
};

/* A store that keeps maps as <folder>/<kind>-<key>.opm, for one process at a time. */
struct orl_folder_store {
    char folder[4096];
};
struct orl_map_store orl_map_store_in_folder(struct orl_folder_store *state);

/* Is a photon map, at that path, as it was written? All of it is read. ORL_ERR_IO, _CORRUPT,
 * _VERSION. Of the kinds "bsdf" and "scene" nothing is said: a job that opens one looks at all of
 * it. */
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

/* What false colours show at a point: in their unit; NaN where the view sees nothing. */
struct orl_point_value {
    char name[ORL_PICTURE_LABEL_MAX];
    double value;
};

/* The files of sensors, names below the output folder. */
struct orl_sensor_files {
    char *csv, *res; /* all sensors, a line each; NULL: not asked for */
    struct {
        char *png, *svg;
        char *dat; /* Radiance's data file; NULL: the sensors are no full grid */
        size_t sensors;
    } maps[ORL_HEAT_MAPS]; /* of planes, those of the most sensors first */
    size_t n_maps;
};
void orl_sensor_files_done(struct orl_sensor_files *files);

/* What came of a grid; names below the output folder. Owned. */
struct orl_grid_result {
    char *name;
    size_t first, count; /* of the result's sensors */
    char *res, *npy;     /* a value a line; NumPy's array */
};

struct orl_view_result {
    char *name;
    char *files[ORL_PICTURES];      /* names below the output folder; NULL: there is none */
    double scale;                   /* the top of its false colours; 0: there are none */
    struct orl_point_value *points; /* that were named; owned */
    size_t n_points;
    struct orl_glare *glare; /* owned; NULL: no metrics are asked for */
    uint32_t metrics;        /* that are */
    double seconds;
    bool black; /* no pixel has any light */
};

/* Light by how it comes to a sensor. */
enum orl_light_class {
    ORL_LIGHT_STRAIGHT, /* of suns and lamps, straight or through panes */
    ORL_LIGHT_MIRRORED, /* of suns and lamps, by way of flat mirrors and panes */
    ORL_LIGHT_OUTDOORS, /* of the sky, of what stands outdoors and of glows; not reflected diffusely
                         */
    ORL_LIGHT_REFLECTED, /* reflected diffusely, indoors or by what is beside the sensor */
    ORL_LIGHT_CLASSES
};
const char *orl_light_class_name(enum orl_light_class light); /* "reflected light", ... */

/* Sensors compared with plain path tracing (run/cross_check.c). */
struct orl_cross_check {
    uint64_t paths;     /* 0: none were compared */
    size_t sensors;     /* of which enough is known by paths to compare */
    size_t sensors_off; /* by more than the errors of both: their intervals are widened */
    enum orl_light_class differs_in; /* what the difference is most like, if sensors are off */
    double ratio, ratio_error; /* light by paths over light found, all together, and the standard
                                  error of the former; NaN: not known, or paths find less
                                  where they cannot find all */
};

/* Why a sensor's value is unreliable. Its interval was widened to include what another method
 * found; how far off the value is beyond that is not known. Flags. */
enum orl_doubt {
    ORL_DOUBT_CROSS_CHECK = 1, /* plain path tracing finds other light (run/cross_check.c) */
    ORL_DOUBT_MISSED_LIGHT = 2 /* photons bring light that paths hardly ever meet (run/chance.c) */
};
enum { ORL_DOUBTS = 2 };
const char *orl_doubt_name(enum orl_doubt doubt); /* "cross-check", "missed-light" */

/* How a job with a goal ended. */
enum { ORL_COURSE = 48 };
struct orl_outcome {
    bool asked, met;
    struct orl_goal goal; /* the job's */
    uint32_t rounds;
    double achieved;       /* relative error at the goal's share, as estimated; NaN: not known */
    char why[ORL_WHY_MAX]; /* why it ended, and what would help where the goal is not met */
    /* How the error fell: after rounds, the first and the latest among them, seconds since the
     * run's start. Where there are more than fit every second one is left out. */
    struct {
        double seconds, error;
    } course[ORL_COURSE];
    uint32_t n_course;
};

/* What the run took, beside its times, and what more would: seconds of whole runs like it. */
struct orl_cost {
    uint64_t rays, photons;
    double error;         /* what the two below are about: relative, at the goal's share or 0.95 */
    double halve_s;       /* until that is half of it; NaN: out of reach, or not known */
    double one_percent_s; /* until that is 1 %; 0 when it is met */
    char model[ORL_WHY_MAX]; /* what they are worked out from, in a sentence */
};

/* What an accuracy takes: seconds of a job by `technique` with such a relative error, at the goal's
 * share or 0.95, on as many threads as it was made by. From the pilot's own error down. */
enum { ORL_CURVE = 10 };
struct orl_curve {
    enum orl_technique technique;
    uint32_t threads;
    struct {
        double seconds, error;
    } points[ORL_CURVE];
    uint32_t n_points;       /* 0: not known */
    char model[ORL_WHY_MAX]; /* as in orl_cost, or why not */
};

enum { ORL_RESULT_MAPS = 3 };

struct orl_result {
    uint32_t threads;
    uint64_t seed;
    struct orl_plan plan; /* what was simulated, and why */
    const char *no_curve; /* of orl_plan_job: why no accuracy can be predicted; NULL: a pilot can */
    double timings_s[ORL_STAGE_COUNT];
    double total_s;
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    /* One per sensor each; what they are made of: base/estimate.h. */
    double *illuminance_lx;
    double *standard_error_lx;   /* of photons and rays together */
    double *bias_estimate_lx;    /* what bandwidths are thought to add */
    double (*interval_95_lx)[2]; /* low, high */
    unsigned char *doubts;       /* of enum orl_doubt; NULL: all values are reliable */
    size_t n_sensors;
    struct orl_grid_result *grids;
    size_t n_grids;
    char *grids_info; /* a file: what Honeybee's tools know the grids by; NULL: there are none */
    struct orl_sensor_files sensor_files;
    struct orl_view_result *views;
    size_t n_views;
    bool sky_given; /* by the job */
    bool sky_dark;  /* and it gives no light: night, or none was measured */
    struct orl_outcome outcome;
    struct orl_cross_check cross_check;
    struct orl_cost cost;
    struct orl_health health; /* of what this run did */
    char **warnings;
    size_t n_warnings;
};
void orl_view_result_done(struct orl_view_result *view);
void orl_result_done(struct orl_result *result);

/* ---- Running --------------------------------------------------------------------------------- */

struct orl_run_env {
    struct orl_crew *crew;             /* borrowed; the calling thread leads it */
    const struct orl_files *files;     /* borrowed */
    const struct orl_map_store *store; /* borrowed; NULL: maps go with the run */
    const struct orl_pieces *pieces;   /* borrowed: the run is shared (pieces.h); NULL: it is not */
    struct orl_shelf *shelf;   /* borrowed: what one job works out for the next; may be NULL */
    const char *files_id;      /* of a job on a shelf: what its files are, whatever their names: by
                                  equal ones jobs share scenes. NULL: they do not */
    const char *output_folder; /* exists; images are written here */
    const char *file_prefix;   /* in front of the names of files written there; NULL: none */
    double part_from, part; /* the job's share in a larger one, for progress; 0: it is the whole */
    double part_after_s; /* what comes after it is thought to take; 0: as long, share for share */
    const double *part_stages_s; /* what its stages (enum orl_stage) are thought to take, by parts
                                    before it; borrowed; NULL: as any job's */
    atomic_bool *cancel;         /* borrowed; polled per batch and tile */
    double (*now_s)(void *ctx);  /* a steady clock */
    /* Called by the lead thread, now and then, with fraction 0..1 of the stage and of the job, and
     * the seconds that are thought to be left of it. The job's fraction never falls, and gets to 1
     * when they are over; they may rise (oriel/eta.h). */
    void (*progress)(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                     double left_s);
    /* Called by the lead thread once the plan is made. May be NULL. */
    void (*plan_ready)(void *ctx, const struct orl_plan *plan);
    /* Called by the lead thread when there is a warning, maybe more than once with the same; the
     * text is valid during the call. May be NULL. */
    void (*warned)(void *ctx, const char *warning);
    /* Called by the lead thread when a map is settled (hit or built). May be NULL. */
    void (*map_ready)(void *ctx, const struct orl_map_info *info);
    /* Called by the lead thread when a view of the job is rendered: its pixels in W/sr/m2, from the
     * top left, row by row, and the standard errors of their luma (NULL: not known); valid during
     * the call. May be NULL. */
    void (*view_ready)(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                       size_t count);
    /*
     * Of a job without a goal. Called by the lead thread before a view is rendered: have its files
     * been left in the output folder by an earlier run of the same job? True: *ret_view is filled,
     * its strings by malloc for the run to free, and the view is not rendered again. May be NULL.
     */
    bool (*view_kept)(void *ctx, size_t index, struct orl_view_result *ret_view);
    /* Likewise once the files of a view are written; the view is valid during the call. */
    void (*view_written)(void *ctx, size_t index, const struct orl_view_result *view);
    /*
     * The same of its sensors, all together: the result has room for their numbers, illuminance to
     * interval, and for nothing else yet. May be NULL.
     */
    bool (*sensors_kept)(void *ctx, struct orl_result *result);
    void (*sensors_done)(void *ctx, const struct orl_result *result);
    /*
     * Called by the lead thread after each round of a job with a goal: the result as it stands,
     * files included; valid during the call. May be NULL.
     */
    void (*round_ready)(void *ctx, const struct orl_result *result);
    /*
     * Called by the lead thread at the end of a run, however it ends: timings_s, total_s and health
     * are of what was done, and nothing else of the result is to be looked at; valid during the
     * call. May be NULL.
     */
    void (*spent)(void *ctx, const struct orl_result *spent);
    void *ctx;
};

/*
 * Makes the job's plan without rendering: loads the scene and runs the pilot. Returns 0 and fills
 * ret_result as orl_run does, but for maps, sensors and views. The store is asked for BSDFs only.
 */
int orl_plan_job(const struct orl_job *job, const struct orl_run_env *env,
                 struct orl_result *ret_result, struct orl_error *err);

/*
 * What accuracies of the job would take here by the technique, which is its plan's, whatever its
 * own settings: by two small rounds of it that are rendered, and the model of orl_cost. Maps of
 * these are kept nowhere. As orl_plan_job otherwise.
 */
int orl_plan_curve(const struct orl_job *job, const struct orl_run_env *env,
                   enum orl_technique technique, struct orl_curve *ret_curve,
                   struct orl_error *err);

/*
 * Runs the job, which has no more than one sky. Returns 0 and fills ret_result (owned by the
 * caller) or a negative orl_err; ORL_ERR_UNLIT when all that was asked for came out black, unless
 * the job expects that, or its sky gives no light.
 */
int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err);

/* ---- Checks before a job is taken ------------------------------------------------------------ */

struct orl_scene_summary {
    uint64_t surfaces, materials, sources, triangles, bsdfs;
    uint64_t placed_surfaces; /* those of instances that are kept once counted in each place */
    double bounds_min[3], bounds_max[3];
    char digest[ORL_DIGEST_HEX + 1];
    char **referenced; /* names of files the scene pulled in beyond its main ones */
    size_t n_referenced;
};

/*
 * What libraries keep for a thread that builds scenes is made now: where memory ends within that
 * they may end the process, later they only fail. For threads that others count on, once each,
 * while there is room; scenes are built without it, too. A process inherits it from the thread that
 * forks. ORL_ERR_NOMEM.
 */
int orl_prepare_thread(struct orl_error *err);

/* Parses the scene and everything it refers to, as a job would, and says what is in it. Gives up
 * with ORL_ERR_CANCELLED when *cancel; NULL: never. */
int orl_scene_check(const char *const *main_files, size_t n_files, const struct orl_files *files,
                    const atomic_bool *cancel, struct orl_scene_summary *ret_summary,
                    struct orl_error *err);
void orl_scene_summary_done(struct orl_scene_summary *summary);

/*
 * Which files of a folder are the scene, when nobody says so: the Radiance files (.rad) at its top
 * that no command (a line with '!' in front, such as !xform) of another of its Radiance files
 * names. The top is the one folder that holds Radiance files and lies in the fewest others; when
 * several lie equally deep, no file is. Sets ret_main of each name. ORL_ERR_LIMIT: far too many
 * commands; or what files->open says.
 */
int orl_scene_guess_main(const char *const *names, size_t count, const struct orl_files *files,
                         bool *ret_main, struct orl_error *err);

/*
 * Reads a file of sensors, which is what `oriel run`, `oriel submit` and the daemon read one by:
 * lines of six numbers, x y z dx dy dz, between blanks, commas or semicolons; '#' begins a remark.
 * take is given each, and returns a negative number where it has no memory for it: ORL_ERR_NOMEM.
 */
int orl_sensors_read(const char *name, const char *text, size_t size,
                     int (*take)(void *ctx, const double v[6]), void *ctx, struct orl_error *err);

/* Whether a job would take these bytes for sensors, and how many there are; or for a weather file.
 * Errors: those of the job, with file and line. Of sensors nothing is kept in memory. */
int orl_sensors_check(const char *name, const char *text, size_t size, size_t *ret_count,
                      struct orl_error *err);
int orl_weather_check(const char *name, const char *text, size_t size, int year,
                      struct orl_error *err);
/* Reads what the job's views name, lines of views and masks of glare, as the job would. */
int orl_views_check(const struct orl_job *job, const struct orl_files *files,
                    struct orl_error *err);

#endif

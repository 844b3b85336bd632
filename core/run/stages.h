/* State shared by run.c and the stages of a run. */
#ifndef ORL_RUN_STAGES_H
#define ORL_RUN_STAGES_H

#include <oriel/job/run.h>

#include "base/statistics/estimate.h"
#include "photon/emission/emit.h"
#include "render/gather/gather.h"
#include "render/image/paint.h"
#include "scene/material_override.h"

/* A round of sensors by backward, which continues the sample sequences of earlier rounds. */
struct orl_sensor_round {
    uint64_t seed; /* seed of the samples of all rounds */
    /* Samples of each sensor, in this round and in all earlier ones. */
    const uint32_t *samples, *before;
    double *batches; /* out, [sensor][ORL_MAP_BATCHES]: mean of each batch, lux */
};

/* Last reported share and its time; the current phase (remaining_time.h) and its start. */
struct orl_progress {
    double share, at_s;
    double phase_from, phase_to, phase_s;
    bool rounds_unknown; /* true if the number of rounds after the current one is unknown */
};

struct orl_pilot;

struct orl_run_state {
    const struct orl_job *job;
    const struct orl_run_env *env;
    struct orl_result *result;  /* result, being filled */
    struct orl_sensor *sensors; /* the job's, or read from its file; owned if sensors_owned */
    size_t n_sensors;
    bool sensors_owned;
    /* True in the sensors' own run of a job with views (sensor_run.h). */
    bool only_sensors;
    bool only_plan; /* true if only a plan is requested, without rendering */
    struct orl_pilot
        *pilot; /* set if the accuracy curve is requested (accuracy_curve.h); else NULL */
    const struct orl_material_overrides
        *material_overrides; /* changed materials of the scene; NULL: none */
    /* Reference-counted, released at the end of the run, like lights. */
    struct orl_scene *scene;
    struct orl_lights *lights;
    struct orl_lit_scene *lit_scene; /* made of scene and lights by the plan; owned */
    struct orl_emission *emission;   /* set when photons are first needed, for all rounds */
    /* Likewise, for that technique; its virtual lights are each round's. */
    struct orl_backward *backward;
    struct orl_photon_map *maps[ORL_MAP_KINDS];
    bool pinned[ORL_MAP_KINDS]; /* true if a pin of the store must be released */
    char keys[ORL_MAP_KINDS][ORL_DIGEST_HEX + 1];
    struct orl_search *searches; /* one per crew member */
    double map_share_read;       /* share of the global map that earlier jobs have read */
    double
        cost_s[ORL_STAGE_COUNT]; /* estimate for the run or the current round (remaining_time.h) */
    double after_s;              /* estimate for the rounds after it */
    struct orl_progress *progress; /* progress of the whole run */
    /* Plans and renders a job's sensors in a run of their own (sensor_run.h). */
    int (*run_sensors)(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene *scene, struct orl_result *ret_result,
                       struct orl_error *err);
    enum orl_stage stage;
    double stage_started;
    double started_s;     /* start of the run */
    double deadline_at_s; /* deadline, until the last round of a job with one; else 0 */
    double shift[2];      /* offset of view rays in this round, pixels (paint.h) */
    /* Factor of view rays over the usual number by maps, in this round (paint.h); 0: 1. */
    double view_rays;
    const double *bandwidths; /* by kind of map, in this round (gather.h); NULL: the usual ones */
    const struct orl_sensor_round *sensor_round; /* NULL: samples are the job's */
    /* Contributions of single rays to the sensors, lux, for rare light; owned. */
    struct orl_ray_moments *rays;
    double samples; /* mean samples of a sensor in all rounds so far; 0: the job's */
    struct orl_estimates *stored_pixels; /* by view, for the cost of a job without rounds; owned */
    /* In rounds: receives finished pictures instead of files. */
    int (*receive_film)(void *ctx, size_t index, const struct orl_film *film,
                        struct orl_error *err);
    void *receive_ctx;
};

/* Returns true if the job has an accuracy or a deadline (rounds.h). */
bool orl_goal_is_set(const struct orl_goal *goal);

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
void orl_run_warn(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Warns unless the result already has the same warning, such as from an earlier round. */
void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Parses a file of sensors, like orl_sensors_read, into an array that the caller frees. */
int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);
/* Reads the sensors of a file. Polls cancel, which may be NULL; returns ORL_ERR_CANCELLED then. */
int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* Load stage: returns the sky that the job requests, if any; sets result->sky_given. Returns
 * ORL_ERR_INVALID if the scene then has distant sources of its own. */
int orl_run_load_sky(struct orl_run_state *state, const struct orl_parsed_scene *parsed_scene,
                     struct orl_daylight *ret_daylight, struct orl_error *err);

/* Resolves the job's views: those in files are read, and sizes follow the pixel aspect. *ret_views
 * has as many as the job and owns what differs; free it by orl_run_views_done. */
int orl_run_resolve_views(const struct orl_job *job, const struct orl_files *files,
                          struct orl_view_request **ret_views, struct orl_error *err);
void orl_run_views_done(const struct orl_job *job, struct orl_view_request *views);

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
/* Describes sensors in the plane of a surface that they do not face: how many, the first of them,
 * that surface, and what to do. Returns false if there are none, or if cancelled. */
bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_thread_pool *pool, char *ret_text,
                                        size_t size);
bool orl_run_lies_in_plane(const struct orl_scene *scene, const struct orl_sensor *sensor);

/* Sensors that belong together; name: NULL for a job without grids. */
struct orl_sensor_range {
    const char *name;
    size_t first, count;
};
/* A check for sensors outdoors, in solids or in other rooms than most of their range, and for
 * sensors below floors. */
struct orl_sensor_check {
    const struct orl_scene *scene;
    const struct orl_sensor *sensors;
    const struct orl_sensor_range *ranges;
    size_t n_ranges;
    struct orl_thread_pool *pool;
    /* Called at most 20 times with the numbers of such sensors. Called once more with the names of
     * ranges that are not checked in full because the limit of rays was reached. */
    void (*warn)(void *ctx, const char *text);
    void *ctx;
    /* Limit for the searches, besides some for each range and sensor; 0: the default. */
    uint64_t most_rays;
    uint64_t rays; /* out: rays traced by the searches */
};
/* Runs the check. The warnings do not depend on the crew's size. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_run_check_sensor_spaces(struct orl_sensor_check *check);

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

/* Creates state->emission, where photons start, unless it exists. */
int orl_run_ensure_emission(struct orl_run_state *state, struct orl_error *err);
/* Creates state->backward, the backward technique's data of the world, unless it exists. */
int orl_run_ensure_backward(struct orl_run_state *state, struct orl_error *err);
void orl_run_free_backward(struct orl_run_state *state);

/* Photons and maps stages: loads every map that the job needs into state->maps, or makes it. */
int orl_run_prepare_maps(struct orl_run_state *state, struct orl_error *err);
void orl_run_release_maps(struct orl_run_state *state);

/* Result of a sensor. */
struct orl_sensor_estimate {
    struct orl_estimate estimate;
    /* 1: it receives caustics otherwise than by density (render/gather/gather.h) */
    uint64_t in_free_space;
};

/* Callbacks of a technique for the render stage. */
struct orl_renderer {
    void *ctx;
    /* Computes a sensor and records it; called by any member of the crew. */
    void (*sensor)(void *ctx, size_t index, uint32_t member, struct orl_sensor_estimate *ret_found);
    /* Records a sensor that another process has computed. */
    void (*sensor_loaded)(void *ctx, size_t index, const struct orl_sensor_estimate *found);
    /* Work for all sensors together, after all of them; may be NULL. */
    int (*sensors)(void *ctx, struct orl_error *err);
    int (*view)(void *ctx, const struct orl_painting *painting, struct orl_error *err);
};

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index);

/* Stores a sensor's value and errors in the result, in lux. */
void orl_run_store_sensor(const struct orl_run_state *state, size_t index,
                          const struct orl_estimate *estimate);

/* Widens errors and intervals by the light that sensors have missed by chance, as the other sensors
 * show (base/statistics/sparse_events.h). Call it after all are recorded. */
void orl_run_add_sparse_errors(struct orl_result *result, const struct orl_sensor *sensors,
                               const struct orl_ray_moments *rays);

/* Writes a view's files and names them in the result. */
int orl_run_write_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                       struct orl_error *err);

/* Reads the luminances of the mask that a view with metrics names; the caller owns *ret_mask, which
 * is NULL if there is no mask. Fails if the picture cannot be read or has another size. */
int orl_run_read_mask(const struct orl_files *files, const struct orl_view_request *view,
                      float **ret_mask, struct orl_error *err);

/* Stores the glare of a view with metrics in the result. */
int orl_run_evaluate_glare(struct orl_run_state *state, size_t index, const struct orl_film *film,
                           struct orl_error *err);
/* Stores the errors of that glare, from the view's batches; call it after orl_run_evaluate_glare.
 */
struct orl_view_batches;
int orl_run_evaluate_glare_errors(struct orl_run_state *state, size_t index,
                                  const struct orl_film *film,
                                  const struct orl_view_batches *batches, struct orl_error *err);

/* Returns the paths per pixel of a job without rounds, by backward. */
uint32_t orl_run_pixel_samples(const struct orl_run_state *state);
/* Returns the number of equal rounds that a job without a goal is divided into to estimate the
 * errors of its glare; 1: none. */
uint32_t orl_run_count_batches(const struct orl_run_state *state);

/* At the end: writes the requested maps and tables of the sensors. */
int orl_run_write_sensors(struct orl_run_state *state, struct orl_error *err);

/* Render stage: computes sensors and views into the result and the output folder. */
int orl_run_render(struct orl_run_state *state, const struct orl_renderer *renderer,
                   struct orl_error *err);

/* Plan stage: stores technique and effects in the result's plan, and makes state->world without the
 * plan's omissions. */
int orl_run_plan(struct orl_run_state *state, struct orl_error *err);

/* Returns a rough estimate of the job's seconds on one core, without knowledge of its scene or of
 * its errors. Not valid with a deadline, or with sensors in a file that is not read yet. */
double orl_run_estimate_core_s(const struct orl_job *job);
/* Returns a rough estimate of the job's memory in bytes, besides the scene. */
uint64_t orl_run_estimate_bytes(const struct orl_job *job);

/* Estimates the job's stages into state->cost_s; called when the sensors are known, and again when
 * the photons are. */
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
/* Predicts the time of the whole job, into the forecast of its plan. */
void orl_run_estimate_from_pilot(struct orl_run_state *state);

/* Returns the limit of emissions for photons to sensors in mid-air. */
uint64_t orl_run_sensor_flux_limit(const struct orl_run_state *state);

/* Run the photons, maps and render stages; orl_run_technique chooses by the plan. */
int orl_run_backward(struct orl_run_state *state, struct orl_error *err);
int orl_run_gather(struct orl_run_state *state, struct orl_error *err);
int orl_run_technique(struct orl_run_state *state, struct orl_error *err);

#endif

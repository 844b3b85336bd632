/*
 * The stages of a run, shared by run.c and its parts: the state that passes from one to the next.
 */
#ifndef ORL_RUN_STAGES_H
#define ORL_RUN_STAGES_H

#include <oriel/run.h>

#include "base/estimate.h"
#include "photon/flight/emit.h"
#include "render/gather/gather.h"
#include "render/image/paint.h"
#include "scene/swap.h"

/* A round of sensors by backward: their samples go on where those of earlier rounds ended. */
struct orl_sensor_round {
    uint64_t seed;                    /* of the samples of all rounds */
    const uint32_t *samples, *before; /* of each, in this round and in all earlier ones */
    double *groups; /* out, [sensor][ORL_MAP_BATCHES]: what each group found, lux */
};

/* The share that was told last, and when; the phase under way (ahead.h), and when it began. */
struct orl_told {
    double share, at_s;
    double phase_from, phase_to, phase_s;
    bool open; /* what comes after the round under way nobody knows yet */
};

struct orl_pilot;

struct orl_run_state {
    const struct orl_job *job;
    const struct orl_run_env *env;
    struct orl_result *result;  /* being filled */
    struct orl_sensor *sensors; /* of the job, or of its file; owned when sensors_owned */
    size_t n_sensors;
    bool sensors_owned;
    bool only_sensors;             /* of a job that has views, too (sensor_run.h) */
    bool only_plan;                /* nothing is to be rendered: what it would take is asked for */
    struct orl_pilot *pilot;       /* what accuracies would take is (curve.h); else NULL */
    const struct orl_swaps *swaps; /* of the scene's materials; NULL: none */
    struct orl_scene *scene;       /* held, as the next two are */
    struct orl_lights *lights;
    struct orl_world *world;       /* of both, by the plan; owned */
    struct orl_emission *emission; /* once photons are wanted: of all rounds */
    struct orl_backward *backward; /* likewise, by that technique; its lamps are each round's */
    struct orl_photon_map *maps[ORL_MAP_KINDS];
    bool held[ORL_MAP_KINDS]; /* the store's pin is ours to release */
    char keys[ORL_MAP_KINDS][ORL_DIGEST_HEX + 1];
    struct orl_search *searches; /* one per crew member */
    double read_before;          /* share of the global map that jobs before this one have read */
    double cost_s[ORL_STAGE_COUNT]; /* foreseen, of the run or of the round under way (ahead.h) */
    double after_s;                 /* likewise, of the rounds after it */
    struct orl_told *told;          /* of the whole run */
    /* Plans and renders a job's sensors by a run of their own (sensor_run.h). */
    int (*run_sensors)(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene *scene, struct orl_result *ret_result,
                       struct orl_error *err);
    enum orl_stage stage;
    double stage_started;
    double started_s; /* of the run */
    double ends_s;    /* of a job for a deadline, until its last round: the deadline; else 0 */
    double shift[2];  /* of views' rays, pixels, in rounds (paint.h) */
    double view_rays; /* by maps, over the usual number, in rounds (paint.h); 0: that one */
    const double *bandwidths; /* by kind of map, in rounds (gather.h); NULL: as usual */
    const struct orl_sensor_round *sensor_round; /* NULL: as the job has it */
    struct orl_rays *rays; /* of the sensors, in lux, for what is rare; owned */
    double samples;        /* of a sensor on average, in all rounds so far; 0: as the job has it */
    struct orl_estimates *noted_pixels; /* by view, for the cost of a job in one piece; owned */
    /* In rounds: where a finished picture goes instead of into files. */
    int (*take_film)(void *ctx, size_t index, const struct orl_film *film, struct orl_error *err);
    void *take_ctx;
};

/* Whether the job wants an accuracy, or has a deadline (rounds.h). */
bool orl_goal_is_set(const struct orl_goal *goal);

/* Begins a stage: books the time of the one before, and reports. */
void orl_run_enter(struct orl_run_state *state, enum orl_stage stage);
/* Books the time since the stage under way began. */
void orl_run_leave(struct orl_run_state *state);
/* Books seconds of the stage under way, just spent, to that one instead. */
void orl_run_book(struct orl_run_state *state, enum orl_stage stage, double seconds);
void orl_run_progress(const struct orl_run_state *state, double fraction);
/* Begins a phase of the stage, from that fraction of it to that one, at the last progress. */
void orl_run_phase(const struct orl_run_state *state, double from, double to);
/* The stage has set up what it needs, and begins. */
void orl_run_begin_work(const struct orl_run_state *state);
/* Tells whoever waits; the share and the seconds, gone by and left, are of the run itself, which
 * may be a part of something larger. */
struct orl_run_report {
    double share, elapsed_s, left_s;
};
void orl_run_report(const struct orl_run_env *env, enum orl_stage stage, double fraction,
                    const struct orl_run_report *report);
void orl_run_warn(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* The same, unless the result has that very warning, of an earlier round say. */
void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reads a file of sensors, as orl_sensors_read, into an array that the caller frees. */
int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);
/* Reads the sensors of a file. Polls cancel, or NULL: ORL_ERR_CANCELLED. */
int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* Load stage: the sky that the job asks for, if any; result->sky_given says whether. The scene has
 * no distant sources of its own then, or it is ORL_ERR_INVALID. */
int orl_run_sky(struct orl_run_state *state, const struct orl_description *description,
                struct orl_daylight *ret_daylight, struct orl_error *err);

/*
 * The job's views as they are to be rendered: those of files read, sizes as pixels' aspects have
 * them. *ret_views has as many as the job, and owns what differs; orl_run_views_done.
 */
int orl_run_views(const struct orl_job *job, const struct orl_files *files,
                  struct orl_view_request **ret_views, struct orl_error *err);
void orl_run_views_done(const struct orl_job *job, struct orl_view_request *views);

/* What the scene's files had wrong, into the result's health. */
void orl_run_count_scene(struct orl_run_state *state, const struct orl_scene *scene);

/* Warns of panes of the scene that lie on an opaque surface. */
void orl_run_warn_of_covered_panes(struct orl_run_state *state);
/* Warns of BSDF panes whose front is outdoors, if their data are not the same when turned round. */
void orl_run_warn_of_turned_panes(struct orl_run_state *state);

/* Marks a sensor as unreliable. */
void orl_run_doubt(struct orl_run_state *state, size_t sensor, enum orl_doubt doubt);
/* After all checks: an accuracy counts as not met if sensors are unreliable. */
void orl_run_heed_doubts(struct orl_run_state *state);

/* Whether no light comes to any sensor or view of the job: then photons are not worth tracing. Says
 * so in a warning. */
bool orl_run_is_dark(struct orl_run_state *state);

/* In the plan stage: warns of eyes inside a solid, in a wall or on a surface. */
void orl_run_judge_views(struct orl_run_state *state);
/* Describes sensors in the plane of a surface that they do not face: how many, the first of them,
 * that surface, and what to do. Returns false when there are none, or when cancelled. */
bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_crew *crew, char *ret_text, size_t size);
bool orl_run_lies_in_plane(const struct orl_scene *scene, const struct orl_sensor *sensor);

/* Sensors that belong together; name: NULL of a job without grids. */
struct orl_sensor_range {
    const char *name;
    size_t first, count;
};
/* The check of a job's sensors for those outdoors, in solids or in other rooms than most of their
 * range, and those below floors. */
struct orl_sensor_check {
    const struct orl_scene *scene;
    const struct orl_sensor *sensors;
    const struct orl_sensor_range *ranges;
    size_t n_ranges;
    struct orl_crew *crew;
    /* Called with the numbers of such sensors, at most 20 times, and once more with the names of
     * ranges that are not checked in full because the limit of rays was reached. */
    void (*warn)(void *ctx, const char *text);
    void *ctx;
    uint64_t most_rays; /* of the searches, beside some for each range and sensor; 0: the default */
    uint64_t rays;      /* out: traced by the searches */
};
/* The warnings do not depend on the crew's size. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_run_check_sensor_spaces(struct orl_sensor_check *check);

/* At the end: warns of sensors and views without light among others; without any it is an error,
 * ORL_ERR_UNLIT, unless the job expects that, or it is night. */
int orl_run_judge_darkness(struct orl_run_state *state, struct orl_error *err);

/* At the end: warns of light that the backward technique has missed, because its paths would have
 * had to happen on it. */
int orl_run_judge_chance(struct orl_run_state *state, struct orl_error *err);

/* At the end: compares sensors with plain path tracing, into result->cross_check. Where they differ
 * by more than both errors intervals are widened, and a warning says so. */
int orl_run_cross_check(struct orl_run_state *state, struct orl_error *err);

/* At the end: warnings where the result's health calls for them. */
void orl_run_judge_health(struct orl_run_state *state);

/* Where photons start, into state->emission if it is not there yet. */
int orl_run_need_emission(struct orl_run_state *state, struct orl_error *err);
/* What the backward technique knows of the world, into state->backward, likewise. */
int orl_run_need_backward(struct orl_run_state *state, struct orl_error *err);
void orl_run_forget_backward(struct orl_run_state *state);

/* Photons and maps stages: every map the job needs is in state->maps, from the store or new. */
int orl_run_maps(struct orl_run_state *state, struct orl_error *err);
void orl_run_release_maps(struct orl_run_state *state);

/* What came of a sensor, for whoever puts the job together. */
struct orl_sensor_found {
    struct orl_estimate estimate;
    uint64_t in_air; /* 1: caustics come to it otherwise than by density (render/gather/gather.h) */
};

/* A technique at work: what the render stage asks of it. */
struct orl_renderer {
    void *ctx;
    /* Computes a sensor and books it; called by any member of the crew. */
    void (*sensor)(void *ctx, size_t index, uint32_t member, struct orl_sensor_found *ret_found);
    /* Books one that others have computed. */
    void (*sensor_found)(void *ctx, size_t index, const struct orl_sensor_found *found);
    /* After all sensors: what is done for all of them together; or NULL. */
    int (*sensors)(void *ctx, struct orl_error *err);
    int (*view)(void *ctx, const struct orl_painting *painting, struct orl_error *err);
};

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index);

/* Into the result: the sensor's value and errors, in lux. */
void orl_run_book_sensor(const struct orl_run_state *state, size_t index,
                         const struct orl_estimate *estimate);

/* Once all are booked: widens errors and intervals by what sensors have missed by chance, as others
 * of them tell (base/rare.h). */
void orl_run_mind_rare_light(struct orl_result *result, const struct orl_sensor *sensors,
                             const struct orl_rays *rays);

/* Writes a view's files and names them in the result. */
int orl_run_write_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                       struct orl_error *err);

/* The luminances of the mask that a view with metrics names, owned; *ret_mask is NULL where it
 * names none. Errors are those of a picture that cannot be read, or has another size. */
int orl_run_read_mask(const struct orl_files *files, const struct orl_view_request *view,
                      float **ret_mask, struct orl_error *err);

/* The glare of a view that asks for metrics, into the result. */
int orl_run_rate_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                      struct orl_error *err);
/* After that: what the view's batches tell of its errors. */
struct orl_view_batches;
int orl_run_rate_errors(struct orl_run_state *state, size_t index, const struct orl_film *film,
                        const struct orl_view_batches *batches, struct orl_error *err);

/* Paths a pixel of a job in one piece, by backward. */
uint32_t orl_run_pixel_samples(const struct orl_run_state *state);
/* In how many rounds of equal size a job in one piece is done, lest nothing be known of the errors
 * of its glare; 1: in none. */
uint32_t orl_run_batches(const struct orl_run_state *state);

/* At the end: maps and tables of the sensors, where the job asks for them. */
int orl_run_write_sensors(struct orl_run_state *state, struct orl_error *err);

/* Render stage: sensors and views, into the result and the output folder. */
int orl_run_render(struct orl_run_state *state, const struct orl_renderer *renderer,
                   struct orl_error *err);

/* Plan stage: technique and effects into the result's plan, and state->world without what the plan
 * leaves out. */
int orl_run_plan(struct orl_run_state *state, struct orl_error *err);

/* Seconds of one core that the job is going to take, roughly, by itself alone: nothing of its scene
 * is known, and of one for an accuracy nothing of its errors. Not for a deadline, nor for one whose
 * sensors are in a file, as long as they are not read. */
double orl_run_guess_core_s(const struct orl_job *job);
/* And bytes of memory beside the scene. */
uint64_t orl_run_guess_bytes(const struct orl_job *job);

/* What the job is going to cost, roughly, once its sensors are known; and again when its photons
 * are: into state->cost_s. */
void orl_run_guess_costs(struct orl_run_state *state);
/* That share of the global map was read by jobs before: sensors take less. */
void orl_run_know_reads(struct orl_run_state *state, double share);
/* Whether parts before this one have told what stages take: better than what a plan foresees. */
bool orl_run_is_measured(const struct orl_run_state *state);
/* Photons that are traced and put into maps, by rough costs, in the time that all views take by
 * maps; of a pilot, those of the whole job. */
double orl_run_photons_as_views(const struct orl_run_state *state);
/* Of the time of a view of the job that is painted and written, the part until it is painted. */
double orl_run_painting_share(const struct orl_run_state *state,
                              const struct orl_view_request *view);
/* Of the sensors' time, what such a share of their samples takes. */
double orl_run_sensors_time(const struct orl_run_state *state, double taken);
/* The part of the render stage that is the sensors'. */
double orl_run_sensors_share(const struct orl_run_state *state);
/* And so what the whole of it will take, into the foresight of its plan. */
void orl_run_foresee(struct orl_run_state *state);

/* Emissions of photons that fly to sensors in mid-air, at the most. */
uint64_t orl_run_most_in_air(const struct orl_run_state *state);

/* Photons, maps and render stages, by the technique of the plan. */
int orl_run_backward(struct orl_run_state *state, struct orl_error *err);
int orl_run_gather(struct orl_run_state *state, struct orl_error *err);
int orl_run_technique(struct orl_run_state *state, struct orl_error *err); /* either */

#endif

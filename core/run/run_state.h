/* State of a run, shared by run.c and the stages. */
#ifndef ORL_RUN_RUN_STATE_H
#define ORL_RUN_RUN_STATE_H

#include <oriel/job/run.h>

#include "base/statistics/estimate.h"
#include "photon/emission/emit.h"
#include "photon/shooting/shoot.h"
#include "render/technique/technique.h"
#include "scene/surfaces.h"

/* A round of sensors by backward, which continues the sample sequences of earlier rounds. */
struct orl_sensor_round {
    uint64_t seed; /* seed of the samples of all rounds */
    /* Samples of each sensor, in this round and in all earlier ones. */
    const uint32_t *samples, *before;
    double *batches; /* out, [sensor][ORL_MAP_BATCHES]: mean of each batch, lux */
};

/* Last reported share and its time; the current phase (progress.h) and its start. */
struct orl_progress {
    double share, at_s;
    double phase_from, phase_to, phase_s;
    bool rounds_unknown; /* true if the number of rounds after the current one is unknown */
};

/* Photon pilot of the state's emission, kept with it (cache/emission_cache.h). */
struct orl_pilot_of_emission {
    bool known;
    uint32_t threads; /* size of the pool that measured its seconds */
    struct orl_photon_pilot result;
};

struct orl_film;
struct orl_pilot;

/* Which stages of a job run. */
enum orl_run_mode {
    ORL_RUN_ALL,
    ORL_RUN_SENSORS, /* the sensors' own run of a job with views (orl_sensor_run_start) */
    ORL_RUN_PLAN,    /* only the plan, without rendering */
    ORL_RUN_PILOT    /* a small run that measures what accuracy costs (round_cost.h) */
};

/* Settings of a refinement round (rounds.h) that differ from its run; all zero for a run without
 * rounds. */
struct orl_round_overrides {
    double shift[2]; /* offset of view rays, pixels (image.h) */
    /* Factor of view rays over the usual number by maps (image.h); 0: 1. */
    double view_rays;
    const double *bandwidths; /* by kind of map (gather.h); NULL: the usual ones */
    const struct orl_sensor_round *sensor_round; /* NULL: samples are the job's */
    /* Receives finished pictures instead of files; NULL: files are written. */
    int (*receive_film)(void *ctx, size_t index, const struct orl_film *film,
                        struct orl_error *err);
    void *receive_ctx;
};

/* The current stage, and estimates of time (progress.h). Times are those of env->now_s. */
struct orl_run_clock {
    enum orl_stage stage;
    double stage_started;
    double started_s;               /* start of the run */
    double deadline_at_s;           /* deadline, until the last round of a job with one; else 0 */
    double cost_s[ORL_STAGE_COUNT]; /* estimate for the run or the current round */
    double after_s;                 /* estimate for the rounds after it */
};

struct orl_run_state {
    const struct orl_job *job;
    const struct orl_run_env *env;
    struct orl_result *result;  /* result, being filled */
    struct orl_sensor *sensors; /* the job's, or read from its file; owned if sensors_owned */
    size_t n_sensors;
    bool sensors_owned;
    enum orl_run_mode mode;
    struct orl_round_overrides round;
    struct orl_run_clock clock;
    struct orl_pilot *pilot; /* set if the accuracy curve is requested (round_cost.h); else NULL */
    const struct orl_material_overrides
        *material_overrides; /* changed materials of the scene; NULL: none */
    /* Reference-counted, released at the end of the run, like lights. */
    struct orl_scene *scene;
    struct orl_lights *lights;
    struct orl_lit_scene *lit_scene; /* made of scene and lights by the plan; owned */
    struct orl_emission *emission;   /* set when photons are first needed, for all rounds */
    struct orl_pilot_of_emission pilot_of_emission;
    struct orl_renderer renderer; /* likewise: the plan's technique, for the lit scene */
    struct orl_photon_map *maps[ORL_MAP_KINDS];
    bool pinned[ORL_MAP_KINDS]; /* true if a pin of the store must be released */
    char keys[ORL_MAP_KINDS][ORL_DIGEST_HEX + 1];
    struct orl_search *searches;   /* one per thread */
    double map_share_read;         /* share of the global map that earlier jobs have read */
    struct orl_progress *progress; /* progress of the whole run */
    /* Plans and renders a job's sensors in a run of their own (run_stages.h). */
    int (*run_sensors)(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene *scene, struct orl_result *ret_result,
                       struct orl_error *err);
    /* Contributions of single rays to the sensors, lux, for rare light; owned. */
    struct orl_ray_moments *rays;
    double samples; /* mean samples of a sensor in all rounds so far; 0: the job's */
    struct orl_estimates *stored_pixels; /* by view, for the cost of a job without rounds; owned */
};

/* Returns true if the job has an accuracy or a deadline (rounds.h). */
bool orl_goal_is_set(const struct orl_goal *goal);

#endif

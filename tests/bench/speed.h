/*
 * `make bench`: costs of the office in ray-times: seconds times the rate R at which Embree alone
 * answers incoherent single rays in the same scene, on as many threads. R is measured beside every
 * run, so that a busy or throttled machine distorts both alike, and figures are portable. Each is a
 * median of several runs.
 *
 * Times are those of an idle machine, by processor time (bench_pool_s). Radiance's rows use
 * processor time, and run once each.
 */
#ifndef ORL_TESTS_BENCH_SPEED_H
#define ORL_TESTS_BENCH_SPEED_H

#include "bench/office.h"
#include "bench/radiance.h"
#include "bench/reference.h"

enum {
    SPEED_ROWS = 7,
    SPEED_MOST_THREADS = 3,
    SPEED_FACTS = 20,
    SPEED_TRIALS = 64,
    SPEED_NOTE = 128
};

enum speed_row_id {
    SPEED_GLOBAL,
    SPEED_CAUSTIC,
    SPEED_PRECOMPUTED,
    SPEED_IMAGE_PRECOMPUTED,
    SPEED_IMAGE_GATHER,
    SPEED_SENSORS_5,
    SPEED_SENSORS_1
};

/* Method that measures a row's error. */
enum speed_judge { SPEED_NO_ERROR, SPEED_BY_SENSORS, SPEED_BY_IMAGE };

/* Settings of a job for sensors; 0: the technique does not use it. */
struct speed_setting {
    enum orl_technique technique;
    uint64_t photons; /* photons of each kind */
    uint32_t samples;
};

/* Measured cost and error of a setting, from a few seeds. */
struct speed_trial {
    struct speed_setting setting;
    double seconds, rms;
};

/* Medians of the runs; 0: not measured. */
struct speed_figure {
    double seconds, rays_per_s, ray_times;
};

struct speed_row {
    const char *key, *name;
    double target;       /* ray-times */
    double wanted_error; /* rms; 0: no requirement */
    enum speed_judge judge;
    struct speed_figure by_threads[SPEED_MOST_THREADS];
    /* Gain over the first number of threads in rays per time, counting every thread's rays in full:
     * 2 if two threads do twice as much; and its standard error. */
    double gains[SPEED_MOST_THREADS], gain_errors[SPEED_MOST_THREADS];
    struct bench_deviation error; /* pooled over the runs of the first number of threads */
    char note[SPEED_NOTE];        /* the choice made, or a remark */
    struct speed_setting setting; /* settings of sensors */
    struct speed_figure radiance;
    double radiance_error; /* rms */
};

/* A figure that is not work of photons or rays: milliseconds, bytes, ratios. */
struct speed_fact {
    const char *key, *unit;
    char name[SPEED_NOTE];
    double value, target; /* target: upper limit; 0: for information */
    double radiance;      /* Radiance's value; 0: not measured */
};

struct speed {
    /* Settings. */
    uint64_t photons;
    int runs;
    struct bench_list threads;
    bool radiance;
    struct office_reference reference;

    struct office office;
    char maps[BENCH_PATH + 16]; /* photon maps prepared for images */
    struct speed_row rows[SPEED_ROWS];
    struct speed_fact facts[SPEED_FACTS];
    int n_facts;
    struct speed_trial trials[SPEED_TRIALS];
    int n_trials;
    struct orl_thread_pool *pools[SPEED_MOST_THREADS],
        *pool;                             /* pool: the one of the current number of threads */
    struct orl_memory_cache *memory_cache; /* shared by successive jobs; or NULL */
    double (*now_s)(void *ctx);
};

/* Returns true if ORIEL_BENCH_ROWS names the row. */
bool speed_wants(const char *key);

/* Runs a job of the office with its maps in a folder. */
void speed_run(const struct speed *speed, const char *maps, const struct orl_job *job,
               struct orl_result *ret_result);

/*
 * Prepare a row once before its runs; run it: returns seconds, and judges the result as number
 * `merged` of the row unless it is negative.
 */
void speed_prepare(struct speed *speed, enum speed_row_id id);
double speed_work(struct speed *speed, enum speed_row_id id, uint64_t seed, int merged);

/* Finds the cheapest setting whose sensors meet the row's error, by three seeds. */
void speed_choose(struct speed *speed, struct speed_row *row);
double speed_sensors(struct speed *speed, const struct speed_setting *setting, uint64_t seed,
                     struct bench_deviation *ret_error);
/* Measures, as a fact, the cost of a job with that error as its goal. */
void speed_measure_goal(struct speed *speed, const struct speed_row *row);

/* Adds a deviation to pooled ones as number before + 1. */
void speed_merge(struct bench_deviation *pooled, const struct bench_deviation *error, int before);

/* Runs the same work with Radiance, once each. */
void speed_add_radiance(struct speed *speed);

/* Second views, bytes of maps; BSDF files. */
struct speed_fact *speed_add_fact(struct speed *speed, const char *key, const char *unit,
                                  double value, double target, const char *name, ...)
    __attribute__((format(printf, 6, 7)));
void speed_measure_maps(struct speed *speed);
void speed_measure_bsdf(struct speed *speed);
/* Measures outlier pixels of pictures against long references. */
void speed_measure_edges(struct speed *speed);
/* Measures the cost of DGP to 0.01. */
void speed_measure_glare(struct speed *speed);
/* Runs in a separate process: plans a job of the office with that panel and a store's cached data,
 * and writes the seconds of its load stage. known: the digests of files are known. */
int speed_load_bsdf(const char *panel, const char *store_folder, bool known);
/* Runs in a separate process: runs a program, and writes its peak memory, in bytes, to a file. */
int speed_measure_peak(const char *result, const char *input, const char *output,
                       const char *const *argv);

void speed_print(const struct speed *speed);
void speed_write_json(const struct speed *speed, const char *path);

#endif

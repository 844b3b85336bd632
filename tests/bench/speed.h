/*
 * `make bench`: what the office costs, in ray-times: seconds times the rate R at which Embree alone
 * answers incoherent single rays in the same scene, on as many threads. R is measured anew beside
 * every run, so that a busy or a throttled machine distorts both alike, and figures hold on any.
 * Each is a median of several runs.
 *
 * Time is what the work takes on an idle machine, by processor time (bench_crew_s). Radiance's is
 * processor time, and each of its works is done once.
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

/* How a row's errors are measured. */
enum speed_judge { SPEED_NO_ERROR, SPEED_BY_SENSORS, SPEED_BY_IMAGE };

/* Settings of a job for sensors; 0: the technique takes no notice. */
struct speed_setting {
    enum orl_technique technique;
    uint64_t photons; /* of each kind */
    uint32_t samples;
};

/* What a setting was found to take, and to be good to, by a few seeds. */
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
    double wanted_error; /* rms; 0: no matter */
    enum speed_judge judge;
    struct speed_figure by_threads[SPEED_MOST_THREADS];
    /* How many times the rays of the first number of threads, with every thread's rays counted in
     * full: 2 where two threads do twice as much; and its standard error. */
    double gains[SPEED_MOST_THREADS], gain_errors[SPEED_MOST_THREADS];
    struct bench_deviation error; /* of the runs of the first number of threads, pooled */
    char note[SPEED_NOTE];        /* what was chosen, or is to be known */
    struct speed_setting setting; /* of sensors */
    struct speed_figure radiance;
    double radiance_error; /* rms */
};

/* A figure that is no work of photons or rays: milliseconds, bytes, ratios. */
struct speed_fact {
    const char *key, *unit;
    char name[SPEED_NOTE];
    double value, target; /* at most; 0: for information */
    double radiance;      /* the same of Radiance; 0: not measured */
};

struct speed {
    /* Knobs. */
    uint64_t photons;
    int runs;
    struct bench_list threads;
    bool radiance;
    struct office_reference reference;

    struct office office;
    char maps[BENCH_PATH + 16]; /* photon maps that images find ready */
    struct speed_row rows[SPEED_ROWS];
    struct speed_fact facts[SPEED_FACTS];
    int n_facts;
    struct speed_trial trials[SPEED_TRIALS];
    int n_trials;
    struct orl_crew *crews[SPEED_MOST_THREADS], *crew; /* crew: of the threads at hand */
    struct orl_shelf *shelf;                           /* between jobs; or NULL */
    double (*now_s)(void *ctx);
};

/* Whether ORIEL_BENCH_ROWS names it. */
bool speed_wants(const char *key);

/* Runs a job of the office with its maps in a folder. */
void speed_run(const struct speed *speed, const char *maps, const struct orl_job *job,
               struct orl_result *ret_result);

/*
 * Once before a row's runs, and the runs: returns seconds; judges the result, as the merged-th of
 * the row, where it is not negative.
 */
void speed_prepare(struct speed *speed, enum speed_row_id id);
double speed_work(struct speed *speed, enum speed_row_id id, uint64_t seed, int merged);

/* The cheapest setting whose sensors keep to the row's error, by three seeds. */
void speed_choose(struct speed *speed, struct speed_row *row);
double speed_sensors(struct speed *speed, const struct speed_setting *setting, uint64_t seed,
                     struct bench_deviation *ret_error);
/* What a job takes that asks for that error itself, as a fact. */
void speed_measure_goal(struct speed *speed, const struct speed_row *row);

/* Adds a deviation as the (before + 1)-th to pooled ones. */
void speed_merge(struct bench_deviation *pool, const struct bench_deviation *error, int before);

/* The same works by Radiance, once each. */
void speed_add_radiance(struct speed *speed);

/* Second views, bytes of maps; files of BSDF. */
struct speed_fact *speed_add_fact(struct speed *speed, const char *key, const char *unit,
                                  double value, double target, const char *name, ...)
    __attribute__((format(printf, 6, 7)));
void speed_measure_maps(struct speed *speed);
void speed_measure_bsdf(struct speed *speed);
/* Pixels that stand out of pictures, against long computations of their own. */
void speed_measure_edges(struct speed *speed);
/* What DGP to 0.01 takes. */
void speed_measure_glare(struct speed *speed);
/* In a process of its own: plans a job of the office with that panel, with what a store keeps, and
 * writes the seconds of its load stage; with digests of files known or not. */
int speed_load_bsdf(const char *panel, const char *store_folder, bool known);
/* Likewise: runs a program, and writes its peak of memory, in bytes, to a file. */
int speed_measure_peak(const char *result, const char *input, const char *output,
                       const char *const *argv);

void speed_print(const struct speed *speed);
void speed_write_json(const struct speed *speed, const char *path);

#endif

/*
 * The paper's table 2 for the office of the examples: its rows, and what they are compared with.
 *
 * Times are seconds of processor time, one thread; ray-times are seconds times the rate at which
 * Embree alone answers incoherent rays in the same scene, measured in the same run.
 */
#ifndef ORL_TESTS_BENCH_TABLE2_H
#define ORL_TESTS_BENCH_TABLE2_H

#include <stdio.h>

#include "bench/office.h"
#include "bench/radiance.h"
#include "bench/reference.h"

/* In radiance_map's order. */
enum table_kind { TABLE_GLOBAL, TABLE_CAUSTIC, TABLE_PRECOMPUTED, TABLE_KINDS };
enum { TABLE_ROWS = 12 };

struct table_row {
    const char *name, *paper; /* "gather", "GCx" */
    bool radiance;
    /* Means of the runs. */
    double load_s;                /* scene, index and plan; Radiance's are in each program's time */
    double photon_s[TABLE_KINDS]; /* backward: virtual lamps, under global */
    double photons[TABLE_KINDS];  /* stored */
    double sensors_s, image_s;
    /* Pooled. */
    struct bench_deviation sensors, image;
    double image_bias; /* of its mean */
};

struct table {
    /* Knobs. */
    uint64_t photons;
    uint32_t sensor_samples, pixel_samples; /* of the techniques */
    int runs;
    bool radiance, radiance_backward;

    struct office office;
    double rate;                       /* Embree's rays a second */
    struct office_reference reference; /* its image is what all images are like */
    struct table_row rows[TABLE_ROWS]; /* the first is Oriel's backward */
    int n_rows;
};

/* Adds a run's row as the (run + 1)-th to the means. */
void table_merge(struct table_row *row, const struct table_row *of_run, int run);

/* Fills the deviations of a row from what it computed. */
void table_judge(const struct table *table, const double *lx, const double *luminances,
                 struct table_row *row);

/* Loading, photons and image. */
double table_total_s(const struct table_row *row);

/* Adds Radiance's rows, or says why not. */
void table_add_radiance(struct table *table);

/* Both tables, and how their figures come about. */
void table_print(const struct table *table);
/* The same as JSON; exits where it cannot be written. */
void table_write_json(const struct table *table, const char *path);

#endif

/*
 * The paper's table 2 for the example office: its rows, and their reference.
 *
 * Times are processor seconds of one thread; ray-times are seconds times the rate at which Embree
 * alone answers incoherent rays in the same scene, measured in the same run.
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
    double load_s; /* scene, index and plan; Radiance's are included in each program's time */
    double photon_s[TABLE_KINDS]; /* backward: virtual lamps, in the entry of global */
    double photons[TABLE_KINDS];  /* stored photons */
    double sensors_s, image_s;
    /* Deviations pooled over the runs. */
    struct bench_deviation sensors, image;
    double image_bias; /* bias of the image's mean */
};

struct table {
    /* Settings. */
    uint64_t photons;
    uint32_t sensor_samples, pixel_samples; /* samples of the techniques */
    int runs;
    bool radiance, radiance_backward;

    struct office office;
    double rate;                       /* Embree's rays per second */
    struct office_reference reference; /* images are compared with its image */
    struct table_row rows[TABLE_ROWS]; /* the first is Oriel's backward */
    int n_rows;
};

/* Adds a run's row to the means as number run + 1. */
void table_merge(struct table_row *row, const struct table_row *of_run, int run);

/* Fills in a row's deviations from its computed values. */
void table_judge(const struct table *table, const double *lx, const double *luminances,
                 struct table_row *row);

/* Returns the sum of loading, photons and image. */
double table_total_s(const struct table_row *row);

/* Adds Radiance's rows, or prints why not. */
void table_add_radiance(struct table *table);

/* Prints both tables, and notes on their figures. */
void table_print(const struct table *table);
/* Writes the tables as JSON; exits on failure. */
void table_write_json(const struct table *table, const char *path);

#endif

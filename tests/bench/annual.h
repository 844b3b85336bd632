/*
 * The office's year: its files, with its panel or with clear glass instead, a weather file, and
 * what backward says of some of its hours.
 */
#ifndef ORL_TESTS_BENCH_ANNUAL_H
#define ORL_TESTS_BENCH_ANNUAL_H

#include <oriel/annual.h>

#include "bench/office.h"

/* Some hours of a year, by backward: bright ones and dull ones, evenly drawn. */
struct annual_truth {
    size_t *steps; /* of the year */
    size_t n_hours;
    double *lx, *error_lx; /* [hour][sensor] */
};

enum annual_scene { ANNUAL_GLASS, ANNUAL_PANEL, ANNUAL_SCENES };

struct annual_bench {
    enum annual_scene scene; /* to be set between runs; the truth is then to be forgotten */
    struct office office;
    struct orl_files files; /* the office's, and the weather */
    struct orl_file weather;
    struct orl_sensor *sensors;
    struct orl_crew *crew;
    struct annual_truth truth;
};

void annual_open(struct annual_bench *bench);
void annual_close(struct annual_bench *bench);

/* A year by so many paths a sensor; returns the seconds that it takes one thread. */
double annual_run(struct annual_bench *bench, uint32_t samples, struct orl_annual_result *ret_year);

void annual_forget_truth(struct annual_bench *bench);
/* What backward says, made once for that year and kept in the build folder. */
void annual_need_truth(struct annual_bench *bench, const struct orl_annual_result *year);

#endif

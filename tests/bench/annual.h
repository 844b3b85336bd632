/*
 * The office's year: its files, with its panel or with clear glass instead, a weather file, what
 * backward says of some of its hours, and the rows of the table that are not of sensors' errors.
 */
#ifndef ORL_TESTS_BENCH_ANNUAL_H
#define ORL_TESTS_BENCH_ANNUAL_H

#include <stdio.h>

#include <oriel/annual.h>
#include <oriel/annual_glare.h>

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
    enum orl_annual_technique technique;
    struct office office;
    struct orl_files files; /* the office's, and the weather */
    struct orl_file weather;
    struct orl_sensor *sensors;
    struct orl_crew *crew;
    struct annual_truth truth;
};

void annual_open(struct annual_bench *bench);
void annual_close(struct annual_bench *bench);

/* The year's request, of the sensors given; borrowed of the bench and of them. */
struct orl_annual_request annual_request(const struct annual_bench *bench, uint32_t samples,
                                         struct orl_sensor *sensors, size_t n_sensors);
/* What a job or a year of the office has about it. */
struct orl_run_env annual_run_env(struct annual_bench *bench, const struct orl_map_store *store);
/* An hour as a job by backward; owns nothing. */
void annual_job(const struct annual_bench *bench, const struct orl_annual_step *step,
                struct orl_job *ret_job);
/* That job, run; the result is the caller's. */
void annual_run_job(struct annual_bench *bench, const struct orl_job *job,
                    struct orl_result *ret_result);

/* A year by so many paths a sensor; returns the seconds that it takes one thread. */
double annual_run(struct annual_bench *bench, uint32_t samples, struct orl_annual_result *ret_year);

/* A word that tells the weather file from others. */
enum { ANNUAL_WORD = 9 };
void annual_name_weather(const struct annual_bench *bench, char ret_word[ANNUAL_WORD]);

/* So many hours, two of three bright, into the truth. */
void annual_choose_hours(struct annual_truth *truth, const struct orl_annual_result *year,
                         size_t n);
void annual_forget_truth(struct annual_bench *bench);
/* What backward says, made once for that year and kept in the build folder. */
void annual_need_truth(struct annual_bench *bench, const struct orl_annual_result *year);

/* What backward says, into the build folder for annual_radiance.py: of the sensors, after
 * annual_need_truth; of a seat's pictures. */
void annual_tell_hours(const struct annual_bench *bench, double rate);
void annual_tell_seat(const struct annual_bench *bench, const struct orl_seat *seat,
                      const struct annual_truth *hours, const double *dgp);

/* A seat's DGP over the year beside pictures: prints a row for each seat (annual_glare.c). json: an
 * open list; first: nothing is in it yet. */
void annual_print_glare(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        double rate, const struct orl_annual_result *year);

/* The year with another weather file beside the first, likewise (annual_reuse.c). */
void annual_print_reuse(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        const struct orl_annual_result *year);

#endif

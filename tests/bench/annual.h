/*
 * The annual run of the office: its files (with its panel or clear glass), a weather file,
 * backward's reference for some hours, and the table rows other than sensor errors.
 */
#ifndef ORL_TESTS_BENCH_ANNUAL_H
#define ORL_TESTS_BENCH_ANNUAL_H

#include <stdio.h>

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_glare.h>

#include "bench/office.h"

/* Reference illuminances by backward for some hours of a year: bright and dull ones, evenly
 * sampled. */
struct annual_truth {
    size_t *steps; /* indices of the year's steps */
    size_t n_hours;
    double *lx, *error_lx; /* [hour][sensor] */
};

enum annual_scene { ANNUAL_GLASS, ANNUAL_PANEL, ANNUAL_SCENES };

struct annual_bench {
    enum annual_scene scene; /* set between runs; the caller then clears the truth */
    enum orl_annual_technique technique;
    struct office office;
    struct orl_files files; /* the office's files and the weather file */
    struct orl_file weather;
    struct orl_sensor *sensors;
    struct orl_thread_pool *pool;
    struct annual_truth truth;
};

void annual_open(struct annual_bench *bench);
void annual_close(struct annual_bench *bench);

/*
 * Fills the year's request for the given sensors; it borrows from the bench and from the sensors.
 */
struct orl_annual_request annual_request(const struct annual_bench *bench, uint32_t samples,
                                         struct orl_sensor *sensors, size_t n_sensors);
/* Returns the run environment of a job or an annual run of the office. */
struct orl_run_env annual_run_env(struct annual_bench *bench, const struct orl_map_store *store);
/* Fills a backward job of one hour; the job owns nothing. */
void annual_job(const struct annual_bench *bench, const struct orl_annual_step *step,
                struct orl_job *ret_job);
/* Runs that job; the caller owns the result. */
void annual_run_job(struct annual_bench *bench, const struct orl_job *job,
                    struct orl_result *ret_result);

/* Computes a year with that many paths per sensor. Returns the seconds on one thread. */
double annual_run(struct annual_bench *bench, uint32_t samples, struct orl_annual_result *ret_year);

/* A short hash that identifies the weather file. */
enum { ANNUAL_WORD = 9 };
void annual_name_weather(const struct annual_bench *bench, char ret_word[ANNUAL_WORD]);

/* Selects n hours, two of three bright, and stores them in the truth. */
void annual_choose_hours(struct annual_truth *truth, const struct orl_annual_result *year,
                         size_t n);
void annual_forget_truth(struct annual_bench *bench);
/* Reads backward's reference for that year from the build folder, or computes and stores it. */
void annual_need_truth(struct annual_bench *bench, const struct orl_annual_result *year);

/* Writes backward's results into the build folder for annual_radiance.py: those of the sensors
 * (after annual_need_truth), and those of a viewpoint's pictures. */
void annual_tell_hours(const struct annual_bench *bench, double rate);
void annual_write_viewpoint(const struct annual_bench *bench, const struct orl_viewpoint *viewpoint,
                            const struct annual_truth *hours, const double *dgp);

/* Compares DGP over the year with pictures; prints a row for each viewpoint (annual_glare.c). json:
 * an open list; *first: true while it is empty. */
void annual_print_glare(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        double rate, const struct orl_annual_result *year);

/* Measures the year with another weather file after the first, in the same way (annual_reuse.c). */
void annual_print_reuse(struct annual_bench *bench, FILE *json, bool *first, const char *title,
                        const struct orl_annual_result *year);

#endif

/*
 * What programs that measure share: clocks, medians, knobs from the environment, other programs
 * run without a shell, a folder that goes away, and one job run in this process.
 *
 * These are programs, not tests: where something does not succeed, they say so and exit.
 */
#ifndef ORL_TESTS_BENCH_BENCH_H
#define ORL_TESTS_BENCH_BENCH_H

#include <oriel/run.h>

#include "scene/geometry/geometry.h"

enum { BENCH_MOST_RUNS = 9, BENCH_MOST_NUMBERS = 8, BENCH_MOST_THREADS = 64, BENCH_PATH = 512 };

void bench_fail(const char *what, const struct orl_error *err) __attribute__((noreturn));

double bench_wall_s(void *ctx);
/* Of this process, all threads: other people's load does not count. Nor does waiting for a disk. */
double bench_cpu_s(void *ctx);
/* Wall time less what the calling thread has stood ready while others ran: for work of one thread,
 * the time that it takes on an idle machine, waiting for a disk included. */
double bench_own_s(void *ctx);
/*
 * The time that a crew's work takes on an idle machine, by processor time: what the lead, who asks,
 * does alone, and of what is done in the crew's loops, by whomever, each member's even share. That
 * one waits for another at the end of a loop is not in it, nor is waiting for a disk. For programs
 * that are linked with orl_crew_for and orl_crew_try wrapped (crew_clock.c).
 */
double bench_crew_s(void *ctx);
void bench_set_crew(uint32_t members);

/* Reorders values. */
double bench_median(double *values, int n);

/* The same, with its standard error by the values' scatter, were they normal. */
double bench_median_error(double *values, int n, double *ret_error);

/* A number from the environment, or otherwise. */
uint64_t bench_number(const char *variable, uint64_t otherwise);
/* Whether a list of words in the environment, parted by spaces or commas, has the word; a list that
 * is not there has all. */
bool bench_lists(const char *variable, const char *word);
/* A list of numbers in the environment, parted likewise, or otherwise. */
struct bench_list {
    double values[BENCH_MOST_NUMBERS];
    int n;
};
struct bench_list bench_numbers(const char *variable, const struct bench_list *otherwise);

/* The build folder: ORIEL_BUILD, or "build". */
const char *bench_build(void);
/* A path in its folder "bench", which is made when it is missing: what is kept between runs. */
void bench_kept(const char *name, char ret_path[BENCH_PATH]);

/* An empty folder below /tmp, and its end. */
void bench_make_folder(char ret_folder[BENCH_PATH]);
void bench_remove_folder(const char *folder);

/* What another program took. */
struct bench_use {
    double cpu_s;      /* user and system time of it and of what it ran */
    double peak_bytes; /* of its resident memory */
};
/*
 * Runs argv[0] (a path, or looked for on PATH) in a folder (NULL: here), its input and output from
 * and to files there (NULL: nothing, and ours). Returns the exit status, 127 when there is no such
 * program; ret_use may be NULL.
 */
int bench_spawn(const char *const *argv, const char *folder, const char *input, const char *output,
                struct bench_use *ret_use);

/* The peak of this process's own resident memory. A spawned one's bench_use counts, besides, what
 * its parent held when it was forked. */
double bench_peak_bytes(void);

/* Where and how jobs run. */
struct bench_env {
    const struct orl_files *files;
    struct orl_crew *crew;
    const char *maps;        /* folder of photon maps, made when it is missing */
    const char *output;      /* folder of images */
    struct orl_shelf *shelf; /* between jobs; or NULL */
    double (*now_s)(void *ctx);
    /* As in orl_run_env; NULL: nobody looks. ctx is for both. */
    void (*view_ready)(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                       size_t count);
    void *ctx;
};
/* The result is the caller's. */
void bench_run(const struct bench_env *env, const struct orl_job *job,
               struct orl_result *ret_result);

/* Single incoherent rays a second that Embree alone answers, as light takes them, on all members of
 * the crew at once; of each the median of runs, by bench_own_s. */
double bench_embree_rate(const struct orl_geometry *geometry, struct orl_crew *crew, int runs);

#endif

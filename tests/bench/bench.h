/*
 * Shared code of the benchmarks: clocks, medians, settings from the environment, other programs
 * started without a shell, temporary folders, and one job run in this process.
 *
 * These are programs, not tests: on failure they print a message and exit.
 */
#ifndef ORL_TESTS_BENCH_BENCH_H
#define ORL_TESTS_BENCH_BENCH_H

#include <oriel/job/run.h>

#include "scene/geometry/geometry.h"

enum { BENCH_MOST_RUNS = 9, BENCH_MOST_NUMBERS = 8, BENCH_MOST_THREADS = 64, BENCH_PATH = 512 };

void bench_fail(const char *what, const struct orl_error *err) __attribute__((noreturn));

double bench_wall_s(void *ctx);
/* Processor time of this process, all threads; excludes the load of other processes and waits for
 * disks. */
double bench_cpu_s(void *ctx);
/* Wall time less the time in which the calling thread was ready but other threads ran. For
 * single-threaded work: its time on an idle machine, disk waits included. */
double bench_own_s(void *ctx);
/*
 * Processor time that a thread pool's work takes on an idle machine: the lead thread's time outside
 * parallel loops, plus an even share per thread of all work in these loops. Excludes waits at the
 * end of a loop and for disks. The program must be linked with orl_parallel_for and
 * orl_parallel_try wrapped (pool_clock.c).
 */
double bench_pool_s(void *ctx);
void bench_set_pool(uint32_t members);

/* Reorders values. */
double bench_median(double *values, int n);

/* Returns the median and its standard error, from the scatter of the values assumed normal. */
double bench_median_error(double *values, int n, double *ret_error);

/* Returns a number from the environment, or `otherwise` if it is not set. */
uint64_t bench_number(const char *variable, uint64_t otherwise);
/* Returns true if a list in the environment, separated by spaces or commas, has the word, or if the
 * list is not set. */
bool bench_lists(const char *variable, const char *word);
/* A list of numbers in the environment, separated by spaces or commas, or `otherwise`. */
struct bench_list {
    double values[BENCH_MOST_NUMBERS];
    int n;
};
struct bench_list bench_numbers(const char *variable, const struct bench_list *otherwise);

/* Returns the build folder: ORIEL_BUILD, or "build". */
const char *bench_build(void);
/* Returns a path in the build folder's "bench", which stores files between runs. Creates the folder
 * if it is missing. */
void bench_kept(const char *name, char ret_path[BENCH_PATH]);

/* Create an empty folder below /tmp; remove it. */
void bench_make_folder(char ret_folder[BENCH_PATH]);
void bench_remove_folder(const char *folder);

/* Resource usage of another program. */
struct bench_use {
    double cpu_s;      /* user and system time of it and its children */
    double peak_bytes; /* peak of its resident memory */
};
/*
 * Runs argv[0] (a path, or a name on PATH) in a folder (NULL: the current one). Input and output
 * are files there (NULL: no input, and our own output). Returns the exit status, 127 if the program
 * is missing; ret_use may be NULL.
 */
int bench_spawn(const char *const *argv, const char *folder, const char *input, const char *output,
                struct bench_use *ret_use);

/* Returns the peak resident memory of this process. The bench_use of a spawned process also counts
 * the memory that its parent had at the fork. */
double bench_peak_bytes(void);

/* Environment in which jobs run. */
struct bench_env {
    const struct orl_files *files;
    struct orl_thread_pool *pool;
    const char *maps;                      /* folder of photon maps, created if it is missing */
    const char *output;                    /* folder of images */
    struct orl_memory_cache *memory_cache; /* shared by successive jobs; or NULL */
    double (*now_s)(void *ctx);
    /* Callback of orl_run_env; NULL: none. ctx is passed to both callbacks. */
    void (*view_ready)(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                       size_t count);
    void *ctx;
};
/* Runs a job; the caller owns the result. */
void bench_run(const struct bench_env *env, const struct orl_job *job,
               struct orl_result *ret_result);

/* Returns single incoherent rays per second that Embree alone traces, distributed like light, on
 * all threads of the pool at once: the sum over threads of each one's median of runs, by
 * bench_own_s. */
double bench_embree_rate(const struct orl_geometry *geometry, struct orl_thread_pool *pool,
                         int runs);

#endif

/*
 * The example office for benchmarks: its files, with a panel BSDF built separately.
 */
#ifndef ORL_TESTS_BENCH_OFFICE_H
#define ORL_TESTS_BENCH_OFFICE_H

#include "bench/bench.h"

enum { OFFICE_FILES = 6, OFFICE_SENSORS = 57 };

/* The first view of the example's job, aspect ratio 4 to 3. */
#define OFFICE_VIEW "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60"

extern const char office_source[]; /* the example's folder */
extern char *const office_names[OFFICE_FILES];
extern char office_sensors[];

struct office {
    char folder[BENCH_PATH]; /* temporary folder, empty at first */
    char panel[BENCH_PATH];  /* the panel's XML */
    struct orl_files files;  /* the example's files; every XML name yields the panel */
    struct orl_files of_source, of_panel;
    char panel_folder[BENCH_PATH];
    const char *panel_name;
    unsigned char digest[32]; /* digest of the panel's XML once computed */
    struct orl_scene *scene;  /* scene for office_rate, built on first use */
};

/* Returns the panel's BSDF file of 2^resolution directions per axis, built once and stored. */
void office_make_panel(int resolution, char ret_path[BENCH_PATH]);

/* Opens in place, since `files` points into it. panel: path of the panel's XML; NULL: 2^6
 * directions. */
void office_open(struct office *office, const char *panel);
/* Computes the panel's digest, so that later jobs need not read the file, as in a daemon. */
void office_learn_digest(struct office *office);
void office_close(struct office *office); /* removes its folder */

/* Fills a gather job of the office only. The job owns nothing: do not call orl_job_done. */
void office_job(struct orl_job *ret_job);

/* Returns bench_embree_rate in the office. */
double office_rate(struct office *office, struct orl_thread_pool *pool, int runs);

#endif

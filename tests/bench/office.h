/*
 * The example's office as programs measure it: its files, with a panel made for the occasion in a
 * folder of its own.
 */
#ifndef ORL_TESTS_BENCH_OFFICE_H
#define ORL_TESTS_BENCH_OFFICE_H

#include "bench/bench.h"

enum { OFFICE_FILES = 6, OFFICE_SENSORS = 57 };

/* The first view of its job, 4 to 3. */
#define OFFICE_VIEW "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60"

extern const char office_source[]; /* the folder of the example */
extern char *const office_names[OFFICE_FILES];
extern char office_sensors[];

struct office {
    char folder[BENCH_PATH]; /* ours, empty but for lcp.xml */
    struct orl_files files;  /* the example's folder, the panel's XML from ours */
    struct orl_files of_source, of_folder;
};

/* In place: files refers to it. Runs build/oriel-lcp. */
void office_open(struct office *office);
void office_close(struct office *office); /* removes its folder */

/* A job of the office by gather, nothing else asked; owns nothing: not for orl_job_done. */
void office_job(struct orl_job *ret_job);

/* bench_embree_rate in the office. */
double office_rate(const struct office *office, int runs, double (*now_s)(void *ctx));

#endif

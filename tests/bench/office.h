/*
 * The example's office as programs measure it: its files, with a panel's BSDF from elsewhere.
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
    char folder[BENCH_PATH]; /* ours, empty at first */
    char panel[BENCH_PATH];  /* the panel's XML */
    struct orl_files files;  /* the example's folder; any XML is the panel's */
    struct orl_files of_source, of_panel;
    char panel_folder[BENCH_PATH];
    const char *panel_name;
    unsigned char digest[32]; /* of the panel's XML, once it is known */
    struct orl_scene *scene;  /* for office_rate; made when it is first asked for */
};

/* The BSDF of the office's panel, of 2^resolution directions an axis: made once, kept. */
void office_make_panel(int resolution, char ret_path[BENCH_PATH]);

/* In place: files refers to it. With the panel of that path; NULL: of 2^6. */
void office_open(struct office *office, const char *panel);
/* From then on its files know the panel's digest without reading it, as a daemon's do. */
void office_learn_digest(struct office *office);
void office_close(struct office *office); /* removes its folder */

/* A job of the office by gather, nothing else asked; owns nothing: not for orl_job_done. */
void office_job(struct orl_job *ret_job);

/* bench_embree_rate in the office. */
double office_rate(struct office *office, struct orl_crew *crew, int runs);

#endif

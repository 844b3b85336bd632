/*
 * Annual runs of scenes given as text, and single hours as separate jobs. The weather is made up:
 * by day a clear sky, a veiled one and an overcast one in turns. Everything here fails the test on
 * error.
 */
#ifndef ORL_TESTS_SUPPORT_YEAR_H
#define ORL_TESTS_SUPPORT_YEAR_H

#include <oriel/annual/annual_report.h>
#include <oriel/job/job_tasks.h>

#include "support/room.h"

struct year_site {
    double latitude_deg, longitude_deg, time_zone_h; /* both positive to the east */
};

/* Progress that an annual run has reported. */
struct year_progress {
    double last, after_first_run; /* fractions of the job */
    unsigned runs, falls;         /* number of starts of a run, and of decreases of the fraction */
};

struct year_run {
    const char *scene;
    const char *resource_name, *resource_text; /* file of a BSDF or of a shade; or NULL */
    struct year_site site;
    const char *weather; /* text of a weather file; NULL: 22 March and 21 December, made up */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    const struct orl_annual_grid *grids; /* grids of the sensors; or NULL */
    size_t n_grids;
    const struct orl_window_group *groups; /* window groups with shades; or NULL */
    size_t n_groups;
    uint32_t samples, threads; /* 0: the default; 1 */
    uint32_t sun_halvings;
    enum orl_annual_technique technique;
    uint32_t photons; /* 0: derived from the scene */
    uint64_t seed;
    double north_deg;
    enum orl_sun_method sun_method; /* for the year, and for single hours */
    bool coefficients;
    const struct orl_annual_env *env;  /* source of callbacks; or NULL */
    struct year_progress *progress;    /* filled in; or NULL */
    const char *kept_in;               /* cache folder for other runs; NULL: none */
    const struct orl_job_tasks *tasks; /* distribution to other processes; or NULL */
    /* Runs until these results are certain. This field and the next may be NULL. */
    const struct orl_report_request *report_request;
    struct orl_annual_refinement *ret_refinement;
};

/* Runs the year; release the result with orl_annual_done. */
struct orl_annual_result year_run(const struct year_run *run);
/* Runs until that target is certain; other requests of the run are ignored. */
struct orl_annual_refinement year_refine(const struct year_run *run, const char *target);
/* Runs and expects failure: returns the error code. */
int year_run_fails(const struct year_run *run, struct orl_error *ret_err);

/* Computes that hour by a separate backward job: lux, and standard errors. */
void year_hour(const struct year_run *run, const struct orl_annual_step *step, uint32_t samples,
               double *ret_lx, double *ret_se);

/* Computes that hour with all results; release with orl_result_done. */
struct orl_result year_hour_result(const struct year_run *run, const struct orl_annual_step *step,
                                   uint32_t samples);

/* Computes glare at viewpoints in the requested columns of the run's year; release with
 * orl_viewpoint_hours_free. */
struct orl_viewpoint_hours *year_glare(const struct year_run *run,
                                       const struct orl_annual_result *year,
                                       const struct orl_viewpoint_request *viewpoint_request,
                                       const unsigned char *wanted);
/* Returns that hour's DGP of a square fisheye at a viewpoint, by backward; and the illuminance at
 * the eye. */
double year_dgp(const struct year_run *run, const struct orl_annual_step *step,
                const struct orl_viewpoint *viewpoint, uint32_t side, uint32_t samples,
                double *ret_eye_lx);

/* Appends a day's rows of a WEA file. */
void year_day(const struct year_site *site, int month, int day, char *text, size_t size);

#endif

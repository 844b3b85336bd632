/*
 * Years of light in scenes given as text, and hours of them as jobs of their own. The weather is
 * made up: by day a clear sky, a veiled one and a covered one in turns. Everything here fails the
 * test when it does not succeed.
 */
#ifndef ORL_TESTS_SUPPORT_YEAR_H
#define ORL_TESTS_SUPPORT_YEAR_H

#include <oriel/annual_report.h>
#include <oriel/pieces.h>

#include "support/room.h"

struct year_site {
    double latitude_deg, longitude_deg, time_zone_h; /* both east */
};

/* The progress that a year has reported. */
struct year_progress {
    double last, after_first_run; /* fractions of the job */
    unsigned runs, falls;         /* how often a run starts, and how often the fraction falls */
};

struct year_run {
    const char *scene;
    const char *resource_name, *resource_text; /* a BSDF's, or a shade's; or NULL */
    struct year_site site;
    const char *weather; /* a file's text; NULL: 22 March and 21 December, made up */
    const struct orl_sensor *sensors;
    size_t n_sensors;
    const struct orl_annual_grid *grids; /* of them; or none */
    size_t n_grids;
    const struct orl_window_group *groups; /* with shades; or none */
    size_t n_groups;
    uint32_t samples, threads; /* 0: the default; 1 */
    uint32_t sun_halvings;
    enum orl_annual_technique technique;
    uint32_t photons; /* 0: by the scene */
    uint64_t seed;
    double north_deg;
    enum orl_sun_method sun_method; /* of the year, and of hours by jobs of their own */
    bool coefficients;
    const struct orl_annual_env *env; /* whose callbacks are heeded; or NULL */
    struct year_progress *progress;   /* filled in; or NULL */
    const char *kept_in;              /* a folder for what others use again; NULL: nothing is */
    const struct orl_pieces *pieces;  /* whom it is shared with; NULL: with nobody */
    /* Until what they want is sure; or NULL, and the next too. */
    const struct orl_annual_wishes *wishes;
    struct orl_annual_refinement *ret_refinement;
};

/* The result is the caller's, for orl_annual_done. */
struct orl_annual_result year_run(const struct year_run *run);
/* Until that target is settled; what the run wishes otherwise is not heeded. */
struct orl_annual_refinement year_refine(const struct year_run *run, const char *target);
/* The same as year_run, expecting failure: returns the error code. */
int year_run_fails(const struct year_run *run, struct orl_error *ret_err);

/* That hour by a job of its own, by backward: lux, and standard errors. */
void year_hour(const struct year_run *run, const struct orl_annual_step *step, uint32_t samples,
               double *ret_lx, double *ret_se);

/* The same, with all that the run says; the caller's, for orl_result_done. */
struct orl_result year_hour_result(const struct year_run *run, const struct orl_annual_step *step,
                                   uint32_t samples);

/* Glare of seats in the columns that are wanted of the run's year; the caller's, for
 * orl_seat_hours_free. */
struct orl_seat_hours *year_glare(const struct year_run *run, const struct orl_annual_result *year,
                                  const struct orl_seats_wish *wish, const unsigned char *wanted);
/* That hour's DGP of a square fisheye from a seat, by backward; and the light at the eye. */
double year_dgp(const struct year_run *run, const struct orl_annual_step *step,
                const struct orl_seat *seat, uint32_t side, uint32_t samples, double *ret_eye_lx);

/* A day's rows of a WEA file, appended. */
void year_day(const struct year_site *site, int month, int day, char *text, size_t size);

#endif

/*
 * Glare over a year: the daylight glare probability (metrics: oriel/glare.h) of every hour in use,
 * for people who sit at a place and look in a direction.
 *
 * The light at the eye is that of a year's sensor there: sky, sun seen, sun by way of surfaces, all
 * of them. The sources are found as in a picture (threshold 2000 cd/m2, 0.2 rad, peaks above 50 000
 * cd/m2: what a view's `dgp` has by default), in one that is put together anew for each hour from
 * what each of its pixels sees, which is looked at once: sky and ground through panes, what BSDFs
 * scatter of sky and sun, and surfaces by the light on them, that of the sky and of other surfaces
 * in some places of each and the sun's in every pixel. The sun's disc, and its images in flat
 * mirrors, are sources of their own.
 *
 * Errors. low and high are those of the light at the eye, at 95 %; errors of one seat are
 * correlated over its hours, as a sensor's are. What the pixels' width leaves of DGP's error
 * (core/metrics and tests/bench tell how much) is not in them.
 *
 * Places in scene units; directions need not be unit, and must not be upright. Results are the same
 * bytes for any crew. Reference: Wienold and Christoffersen 2006 (metrics/dgp.h); EN 17037:2018,
 * annex E, for what a year's DGP is told by; spatial glare autonomy after Jones 2019, "Fast
 * climate-based glare analysis and spatial mapping", Building Simulation.
 */
#ifndef ORIEL_ANNUAL_GLARE_H
#define ORIEL_ANNUAL_GLARE_H

#include <oriel/annual.h>
#include <oriel/annual_metrics.h>
#include <oriel/seat.h>

enum { ORL_GLARE_WORST = 5, ORL_GLARE_BOUNDS = 3 };
extern const double orl_glare_bounds[ORL_GLARE_BOUNDS]; /* 0.35, 0.40, 0.45 */

/* Finite places, directions that are not upright, a year that glare is told of. ORL_ERR_RANGE,
 * ORL_ERR_UNSUPPORTED. */
int orl_seats_validate(const struct orl_seats_wish *wish, const struct orl_annual_request *request,
                       struct orl_error *err);

/* Of a seat, by the year's columns; NaN where DGP is not wanted. */
struct orl_seat_hours {
    float *dgp, *low, *high, *eye_lx; /* owned */
};
void orl_seat_hours_free(struct orl_seat_hours *hours, size_t n); /* NULL is fine */

/*
 * Of the request's year, and with its shades as that has them: a run of each combination of states
 * that is wanted, of at most ORL_SHADES_MOST_COMBINATIONS. wanted: of each of the result's columns.
 * The request's sensors are not looked at. Reads scene and weather, or finds them on the shelf.
 * *ret_hours: of each seat, owned. Errors: orl_annual_run's.
 */
int orl_annual_glare_find(const struct orl_seats_wish *wish,
                          const struct orl_annual_request *request,
                          const struct orl_annual_result *result, const unsigned char *wanted,
                          const struct orl_run_env *env, struct orl_seat_hours **ret_hours,
                          struct orl_error *err);

/* ---- What is told of it ---------------------------------------------------------------------- */

/* EN 17037, annex E: DGP is above the bound in at most 5 % of the time of use. */
enum orl_glare_protection {
    ORL_PROTECTED_LESS,
    ORL_PROTECTED_MINIMUM, /* 0.45 */
    ORL_PROTECTED_MEDIUM,  /* 0.40 */
    ORL_PROTECTED_HIGH     /* 0.35 */
};
const char *orl_glare_protection_name(enum orl_glare_protection level); /* "none", "minimum", ... */

struct orl_seat_hour {
    size_t step; /* of the year's result */
    struct orl_annual_value dgp;
    double eye_lx;
};

struct orl_seat_glare {
    struct orl_annual_value above[ORL_GLARE_BOUNDS]; /* % of the time of use, by orl_glare_bounds */
    struct orl_annual_value exceeded;                /* in 5 % of it: that DGP */
    enum orl_glare_protection level, lowest, highest; /* the latter two by intervals, or any
                                                         if the weather lacks hours of use */
    /* The worst hour of each of the worst days, sorted by DGP, then by eye_lx, largest first. */
    struct orl_seat_hour worst[ORL_GLARE_WORST];
    size_t n_worst;
};

#endif

/*
 * Annual glare: the daylight glare probability (metrics: oriel/job/glare.h) of every hour of use,
 * for people at given positions and view directions (viewpoints).
 *
 * The light at the eye is that of an annual sensor at the eye, with all of its parts: sky, visible
 * sun, and sun by reflection. Glare sources are found as in a picture (threshold 2000 cd/m2, 0.2
 * rad, peaks above 50 000 cd/m2: the defaults of a view's `dgp`). The picture is composed for each
 * hour from per-pixel data that are traced once: sky and ground through panes, sky and sun
 * scattered by BSDFs, and surfaces by their illuminance. Illuminance by the sky and by other
 * surfaces is computed at some points of each surface; sunlight is computed in every pixel. The
 * sun's disc, and its images in flat mirrors, are separate sources.
 *
 * Errors. low and high are the 95 % bounds due to the light at the eye. The errors of one viewpoint
 * are correlated over its hours, as a sensor's are. They do not include the error of DGP due to the
 * pixels' width (core/metrics and tests/bench give its size).
 *
 * Positions are in scene units; directions need not be unit, and must not be vertical. Results are
 * the same bytes for any number of threads. References: Wienold and Christoffersen 2006
 * (metrics/indices.h); EN 17037:2018, annex E, for the annual classification of DGP; spatial glare
 * autonomy after Jones 2019, "Fast climate-based glare analysis and spatial mapping", Building
 * Simulation.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_GLARE_H
#define ORIEL_ANNUAL_ANNUAL_GLARE_H

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_metrics.h>
#include <oriel/annual/annual_shades.h>

enum { ORL_GLARE_WORST = 5, ORL_GLARE_BOUNDS = 3 };
extern const double orl_glare_bounds[ORL_GLARE_BOUNDS]; /* 0.35, 0.40, 0.45 */

/* Checks that positions are finite, that directions are not vertical, and that the year supports
 * glare. Returns 0, ORL_ERR_RANGE or ORL_ERR_UNSUPPORTED. */
int orl_viewpoints_validate(const struct orl_viewpoint_request *viewpoint_request,
                            const struct orl_annual_request *request, struct orl_error *err);

/* Hourly values of a viewpoint, by the year's columns; NaN for hours without DGP. */
struct orl_viewpoint_hours {
    float *dgp, *low, *high, *eye_lx; /* owned */
};
void orl_viewpoint_hours_free(struct orl_viewpoint_hours *hours, size_t n); /* NULL is fine */

/*
 * Computes DGP at the viewpoints for the request's year. With shades there is one run for each
 * wanted combination of states, at most ORL_SHADES_MOST_COMBINATIONS. `wanted` has one flag per
 * column of the result. The request's sensors are not used. Reads scene and weather, or finds them
 * in the memory cache. *ret_hours has one owned entry per viewpoint. Errors are those of
 * orl_annual_run.
 */
int orl_annual_glare_compute(const struct orl_viewpoint_request *viewpoint_request,
                             const struct orl_annual_request *request,
                             const struct orl_annual_result *result, const unsigned char *wanted,
                             const struct orl_run_env *env, struct orl_viewpoint_hours **ret_hours,
                             struct orl_error *err);

/* ---- Evaluation ------------------------------------------------------------------------------ */

/* Levels of EN 17037, annex E: DGP exceeds the bound in at most 5 % of the time of use. */
enum orl_glare_protection {
    ORL_PROTECTED_NONE,
    ORL_PROTECTED_MINIMUM, /* 0.45 */
    ORL_PROTECTED_MEDIUM,  /* 0.40 */
    ORL_PROTECTED_HIGH     /* 0.35 */
};
const char *orl_glare_protection_name(enum orl_glare_protection level); /* "none", "minimum", ... */

struct orl_viewpoint_hour {
    size_t step; /* index in the year's result */
    struct orl_annual_value dgp;
    double eye_lx;
};

struct orl_viewpoint_glare {
    struct orl_annual_value above[ORL_GLARE_BOUNDS]; /* % of the time of use, by orl_glare_bounds */
    struct orl_annual_value exceeded; /* DGP that is exceeded in 5 % of the time of use */
    enum orl_glare_protection level, lowest, highest; /* the last two by the intervals */
    /* Worst hour of each of the worst days, sorted by DGP, then by eye_lx, largest first. */
    struct orl_viewpoint_hour worst[ORL_GLARE_WORST];
    size_t n_worst;
};

#endif

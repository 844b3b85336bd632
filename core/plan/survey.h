/*
 * What the planner knows of a scene before it decides: which materials are in use, how strong the
 * lights are, how much work the job is, and what a ray costs here. Facts, no decisions.
 *
 * Bounds. In a scene of passive surfaces no radiance is larger than that of the brightest light:
 * E <= pi L anywhere, mirrors, lenses and all. For domes and lamps that says enough. For a sun it
 * says next to nothing, so where nothing focuses its own irradiance is taken, and what follows from
 * it by diffuse reflection, 1 / (1 - rho).
 *
 * Tolerance: what is left on auto is skipped when it can cost no place more than this many lux:
 * 0.01, or a millionth of what all lights could give at most, where that is less.
 */
#ifndef ORL_PLAN_SURVEY_H
#define ORL_PLAN_SURVEY_H

#include "plan/plan.h"

struct orl_survey {
    const struct orl_plan_request *request;
    struct orl_world *world;
    uint32_t *surfaces;             /* per material: how many are of it */
    double sun_lx, sky_lx, lamp_lx; /* at most, at unfocused places */
    double tolerance_lx;
    bool sky_measured;  /* domes are taken out all or none: once is enough */
    double rho_diffuse; /* the largest of any surface */
    double rho;         /* the largest diffuse or glossy reflectance of a surface */
    double ray_s;       /* what one costs here, shading included */
    double pixels, sensor_rays;
    size_t n_clear; /* ports: see light/world.h */
};

/* Takes its facts; to be followed by orl_survey_done whatever it returns: 0 or ORL_ERR_NOMEM. */
int orl_survey_init(struct orl_survey *survey, const struct orl_plan_request *request,
                    struct orl_world *world);
void orl_survey_done(struct orl_survey *survey);

/* Measures the lights once more, and the reflectances: after something was left out. */
void orl_survey_measure(struct orl_survey *survey);

/* Illuminance that a reflectance rho makes of that direct one, by any number of reflections. */
double orl_survey_reflected_lx(const struct orl_survey *survey, double direct_lx);

/* The brightest of what a dome shows, W/sr/m2 of luma. */
double orl_survey_dome_peak(const struct orl_dome *dome);

/* How many surfaces of used materials pass a test. */
size_t orl_survey_count(const struct orl_survey *survey,
                        bool (*is)(const struct orl_material *material));

/* Whether a sensor or an eye of the job is, or may be, outside the building. */
bool orl_survey_asks_outside(const struct orl_survey *survey);

#endif

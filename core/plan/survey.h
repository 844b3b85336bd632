/*
 * Facts about a scene for the planner: materials in use, strength of the lights, size of the job,
 * cost of a ray. It makes no decisions.
 *
 * Bounds. In a scene of passive surfaces no radiance is larger than that of the brightest light: E
 * <= pi L anywhere, in spite of mirrors and lenses. For domes and lamps that bound is tight enough.
 * For a sun it is far too loose. If nothing focuses, the bound is the sun's irradiance and its
 * diffuse reflections, 1 / (1 - rho).
 *
 * Tolerance: an effect on auto is skipped if it changes no point by more than this many lux: 0.01,
 * or a millionth of the largest possible light of all sources, whichever is less.
 */
#ifndef ORL_PLAN_SURVEY_H
#define ORL_PLAN_SURVEY_H

#include "plan/plan.h"

struct orl_plan_survey {
    const struct orl_plan_request *request;
    struct orl_lit_scene *lit_scene;
    uint32_t *surfaces;             /* per material: number of surfaces */
    double sun_lx, sky_lx, lamp_lx; /* upper bounds, at unfocused points */
    double tolerance_lx;
    bool sky_measured;  /* true: sky_lx is final; domes are removed all or none */
    double rho_diffuse; /* largest diffuse reflectance of a surface */
    double rho;         /* largest diffuse or glossy reflectance of a surface */
    double ray_s;       /* seconds per ray, shading included */
    double pixels, sensor_rays;
    size_t n_clear; /* number of clear ports, see light/lit_scene.h */
};

/* Collects the facts. Returns 0 or ORL_ERR_NOMEM. Call orl_plan_survey_done in either case. */
int orl_plan_survey_init(struct orl_plan_survey *survey, const struct orl_plan_request *request,
                         struct orl_lit_scene *lit_scene);
void orl_plan_survey_done(struct orl_plan_survey *survey);

/* Measures lights and reflectances again, after something was left out. */
void orl_plan_survey_measure(struct orl_plan_survey *survey);

/* Returns the illuminance by any number of reflections of reflectance rho, for a direct
 * illuminance. */
double orl_plan_survey_reflected_lx(const struct orl_plan_survey *survey, double direct_lx);

/* Returns the largest radiance of a dome, W/sr/m2 of luma. */
double orl_plan_survey_dome_peak(const struct orl_dome *dome);

/* Returns the number of surfaces whose material passes the test. */
size_t orl_plan_survey_count(const struct orl_plan_survey *survey,
                             bool (*is)(const struct orl_material *material));

/* Returns true if a sensor or an eye of the job is, or may be, outside the building. */
bool orl_plan_survey_is_outdoor(const struct orl_plan_survey *survey);

#endif

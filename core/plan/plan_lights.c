/* Decides on suns, skies and lamps, by upper bounds of their light. */
#include <stdio.h>

#include "plan/decide.h"

enum { SUN_RAYS_A_SENSOR = 128, SUN_RAYS_A_PIXEL = 8 };

static double shadow_rays_s(const struct orl_plan_survey *survey, size_t lights)
{
    const double places =
        SUN_RAYS_A_SENSOR * (double)survey->request->n_sensors + SUN_RAYS_A_PIXEL * survey->pixels;
    return places * (double)lights * survey->ray_s;
}

/* Formats with four digits, or with all digits before the decimal point. */
static const char *format_lux(double lux, char ret_text[32])
{
    if (lux < 1000)
        snprintf(ret_text, 32, "%.4g lx", lux);
    else
        snprintf(ret_text, 32, "%.0f lx", lux);
    return ret_text;
}

/*
 * Decides on suns. The bound is the sun's irradiance plus its reflections. Only pi L decides
 * whether a sun is negligible, since that bounds it under any focusing.
 */
static void decide_sun(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    char lux[32];
    double focused = 0;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        focused += ORL_EFFICACY_LM_PER_W * ORL_PI * orl_luma(lit_scene->suns[i].radiance);
    const struct orl_finding finding = {
        .needed = focused > survey->tolerance_lx,
        .unit = ORL_BOUND_LX,
        .bound =
            fmin(survey->sun_lx + orl_plan_survey_reflected_lx(survey, survey->sun_lx), focused),
        .saved_s = shadow_rays_s(survey, lit_scene->n_suns)};
    if (!orl_decision_fill(&plan->effects[ORL_EFFECT_SUN], &finding,
                           lit_scene->n_suns == 0
                               ? "there are %zu suns"
                               : "suns: %zu; a plane that faces them gets %s where nothing focuses",
                           lit_scene->n_suns, format_lux(survey->sun_lx, lux)))
        orl_lit_scene_select_suns(lit_scene, NULL);
}

static void decide_sky(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    char lux[32];
    const struct orl_finding finding = {.needed = survey->sky_lx > survey->tolerance_lx,
                                        .unit = ORL_BOUND_LX,
                                        .bound = survey->sky_lx,
                                        .saved_s = survey->sensor_rays * survey->ray_s / 3};
    if (!orl_decision_fill(
            &plan->effects[ORL_EFFECT_SKY], &finding,
            "skies and other wide lights: %zu; the brightest direction of them all round "
            "would give %s",
            lit_scene->n_domes, format_lux(survey->sky_lx, lux)))
        lit_scene->n_domes = 0;
}

/* Lamps that are left out become black, so that rays that hit them see no light. */
static void blacken_lamps(struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        const uint32_t material =
            orl_facet_material(lit_scene->geometry, lit_scene->emitters[i].facet);
        lit_scene->materials[material].color = orl_gray(0);
    }
    lit_scene->n_emitters = 0;
}

static void decide_lamps(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    char lux[32];
    const struct orl_finding finding = {.needed = survey->lamp_lx > survey->tolerance_lx,
                                        .unit = ORL_BOUND_LX,
                                        .bound = survey->lamp_lx,
                                        .saved_s = shadow_rays_s(survey, lit_scene->n_emitters)};
    if (!orl_decision_fill(&plan->effects[ORL_EFFECT_LAMPS], &finding,
                           "shining surfaces: %zu; right before the brightest it is %s",
                           lit_scene->n_emitters, format_lux(survey->lamp_lx, lux)))
        blacken_lamps(lit_scene);
}

void orl_decide_lights(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    decide_sun(survey, plan);
    decide_sky(survey, plan);
    decide_lamps(survey, plan);
    orl_plan_survey_measure(survey);
}

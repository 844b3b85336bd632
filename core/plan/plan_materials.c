/* Decides on glossy reflection, and on absorption and refraction of dielectrics. */
#include "plan/decide.h"
#include "scene/material/bounds.h"
#include "scene/material/patterns/pattern.h"

/* ---- Glossy reflection ----------------------------------------------------------------------- */

/* Trans is excluded: its parts share one colour, and no other material could represent them. */
static bool is_glossy(const struct orl_material *m)
{
    return (m->kind == ORL_MATERIAL_PLASTIC || m->kind == ORL_MATERIAL_METAL) &&
           orl_material_has_lobes(m);
}

static double gloss_albedo(const struct orl_material *m)
{
    return orl_material_max_albedo(m, true, 1, ORL_LOBE_REFLECTED);
}

static const double least_pattern = 0.1;

/* Converts glossy reflection to diffuse reflection of the same energy. */
static void convert_gloss_to_diffuse(struct orl_material *m)
{
    /* Gloss has no pattern; the mean attenuation by the pattern is compensated. */
    const double left = m->pattern ? fmax(orl_luma(m->pattern->mean), least_pattern) : 1;
    if (m->kind == ORL_MATERIAL_PLASTIC)
        m->color =
            orl_rgb_add(orl_rgb_scale(m->color, 1 - m->specular), orl_gray(m->specular / left));
    m->specular = 0;
    m->roughness[0] = m->roughness[1] = 0;
}

static void decide_glossy(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    const size_t count = orl_plan_survey_count(survey, is_glossy);
    const double direct = survey->sun_lx + survey->sky_lx + survey->lamp_lx;
    double most = 0;
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (survey->surfaces[i] > 0 && is_glossy(&lit_scene->materials[i]))
            most = fmax(most, gloss_albedo(&lit_scene->materials[i]));
    const double bound = most * (direct + orl_plan_survey_reflected_lx(survey, direct));
    const struct orl_finding finding = {
        .needed = count > 0 && (survey->request->job->n_views > 0 || bound > survey->tolerance_lx),
        .unit = ORL_BOUND_LX,
        .bound = bound,
        .saved_s = most * (survey->sensor_rays + 4 * survey->pixels) * survey->ray_s};
    if (orl_decision_fill(&plan->effects[ORL_EFFECT_GLOSSY], &finding,
                          "surfaces with a rough gloss: %zu; they mirror %.3g %% at most", count,
                          100 * most))
        return;
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (is_glossy(&lit_scene->materials[i]))
            convert_gloss_to_diffuse(&lit_scene->materials[i]);
    lit_scene->omit.glossy = count > 0;
}

/* ---- Clear solids ---------------------------------------------------------------------------- */

static bool is_dielectric(const struct orl_material *m)
{
    return m->kind == ORL_MATERIAL_DIELECTRIC;
}

static double least_clear(const struct orl_material *m)
{
    double least = 1;
    for (int side = 0; side < 2; side++) {
        const struct orl_rgb t = m->media[side].transmissivity;
        least = fmin(least, fmin(t.r, fmin(t.g, t.b)));
    }
    return least;
}

static bool absorbs(const struct orl_material *m)
{
    return is_dielectric(m) && least_clear(m) < 1;
}

static void decide_media(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    const size_t count = orl_plan_survey_count(survey, absorbs);
    double least = 1;
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (survey->surfaces[i] > 0 && absorbs(&lit_scene->materials[i]))
            least = fmin(least, least_clear(&lit_scene->materials[i]));
    const double lost = count > 0 ? 1 - pow(least, 2 * lit_scene->geometry->radius) : 0;
    const struct orl_finding finding = {
        .needed = count > 0, .unit = ORL_BOUND_RELATIVE, .bound = lost};
    if (orl_decision_fill(
            &plan->effects[ORL_EFFECT_MEDIA], &finding,
            "surfaces of dielectrics that absorb: %zu; across the scene they would keep "
            "%.3g %% of the light",
            count, 100 * lost))
        return;
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        struct orl_material *m = &lit_scene->materials[i];
        if (is_dielectric(m))
            m->media[0].transmissivity = m->media[1].transmissivity = orl_gray(1);
    }
    lit_scene->omit.media = count > 0;
}

/* Refraction may focus: the bound is that of all lights, focused. */
static void decide_refraction(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    const size_t count = orl_plan_survey_count(survey, is_dielectric);
    double focused = survey->sky_lx + survey->lamp_lx;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        focused += ORL_EFFICACY_LM_PER_W * ORL_PI * orl_luma(lit_scene->suns[i].radiance);
    const struct orl_finding finding = {
        .needed = count > 0, .unit = ORL_BOUND_LX, .bound = count > 0 ? focused : 0};
    if (orl_decision_fill(&plan->effects[ORL_EFFECT_REFRACTION], &finding,
                          "surfaces of solid dielectrics: %zu", count))
        return;
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        struct orl_material *m = &lit_scene->materials[i];
        if (is_dielectric(m))
            m->media[0].ior = m->media[1].ior = 1;
    }
    lit_scene->omit.refraction = count > 0;
}

void orl_decide_materials(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    decide_glossy(survey, plan);
    decide_media(survey, plan);
    decide_refraction(survey, plan);
    orl_plan_survey_measure(survey);
}

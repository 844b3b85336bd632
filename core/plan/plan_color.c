/* Decides on colour, exactly: every used material and every light is checked. */
#include "plan/decide.h"
#include "scene/material/patterns/pattern.h"

static bool is_gray(struct orl_rgb c)
{
    return c.r == c.g && c.g == c.b;
}

static bool media_are_gray(const struct orl_material *m)
{
    return is_gray(m->media[0].transmissivity) && is_gray(m->media[1].transmissivity);
}

static bool has_coloured_bsdf(const struct orl_material *m)
{
    struct orl_bsdf_info info = {.colored = false};
    if (m->bsdf)
        orl_bsdf_describe(m->bsdf, &info);
    return info.colored;
}

static bool is_coloured(const struct orl_material *m);

/* Returns true for coloured data that cannot be converted to gray. */
static bool has_coloured_data(const struct orl_material *m)
{
    if (m->kind == ORL_MATERIAL_MIXTURE && (is_coloured(&m->mixed[0]) || is_coloured(&m->mixed[1])))
        return true;
    return has_coloured_bsdf(m) || (m->angles && m->angles->coloured) ||
           (m->pattern && m->pattern->coloured);
}

/* Fields that a material's kind does not use are zero, which is gray. */
static bool is_coloured(const struct orl_material *m)
{
    return !(is_gray(m->color) && is_gray(m->gloss) && is_gray(m->transmissivity) &&
             media_are_gray(m) && is_gray(m->front) && is_gray(m->back) && is_gray(m->through)) ||
           has_coloured_data(m);
}

static bool has_coloured_sky(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_domes; i++)
        if (lit_scene->domes[i].pattern && lit_scene->domes[i].pattern->coloured)
            return true;
    return false;
}

static size_t coloured_lights(const struct orl_lit_scene *lit_scene)
{
    size_t n = 0;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        n += !is_gray(lit_scene->suns[i].radiance);
    for (size_t i = 0; i < lit_scene->n_domes; i++)
        n += !is_gray(lit_scene->domes[i].radiance) ||
             (lit_scene->domes[i].pattern && lit_scene->domes[i].pattern->coloured);
    return n;
}

/* Returns the ratio of the largest channel to the luma. */
static double vividness(struct orl_rgb c)
{
    return orl_luma(c) > 0 ? orl_rgb_max(c) / orl_luma(c) : 1;
}

static double vividness_of(const struct orl_material *m)
{
    const struct orl_rgb colors[] = {m->color, m->transmissivity, m->front,
                                     m->back,  m->through,        m->gloss};
    double most = 1;
    for (size_t k = 0; k < sizeof colors / sizeof *colors; k++)
        most = fmax(most, vividness(colors[k]));
    for (int i = 0; m->mixed && i < 2; i++)
        most = fmax(most, vividness_of(&m->mixed[i]));
    return most;
}

static double most_vivid(const struct orl_plan_survey *survey)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    double most = 1;
    for (size_t i = 0; i < lit_scene->n_materials; i++)
        if (survey->surfaces[i] > 0)
            most = fmax(most, vividness_of(&lit_scene->materials[i]));
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        most = fmax(most, vividness(lit_scene->suns[i].radiance));
    for (size_t i = 0; i < lit_scene->n_domes; i++)
        most = fmax(most, vividness(lit_scene->domes[i].radiance));
    return most;
}

static struct orl_rgb gray_of(struct orl_rgb c)
{
    return is_gray(c) ? c : orl_gray(orl_luma(c));
}

/* Converts all colours to gray of the same luma. */
static void convert_to_gray(struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        struct orl_material *m = &lit_scene->materials[i];
        m->color = gray_of(m->color);
        m->gloss = gray_of(m->gloss);
        m->transmissivity = gray_of(m->transmissivity);
        m->front = gray_of(m->front);
        m->back = gray_of(m->back);
        m->through = gray_of(m->through);
        for (int k = 0; k < 2; k++)
            m->media[k].transmissivity = gray_of(m->media[k].transmissivity);
    }
    for (size_t i = 0; i < lit_scene->n_suns; i++) {
        lit_scene->suns[i].radiance = gray_of(lit_scene->suns[i].radiance);
        lit_scene->suns[i].irradiance = gray_of(lit_scene->suns[i].irradiance);
    }
    for (size_t i = 0; i < lit_scene->n_domes; i++)
        lit_scene->domes[i].radiance = gray_of(lit_scene->domes[i].radiance);
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        lit_scene->emitters[i].radiance = gray_of(lit_scene->emitters[i].radiance);
        lit_scene->emitters[i].most = gray_of(lit_scene->emitters[i].most);
    }
}

void orl_decide_color(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    struct orl_decision *decision = &plan->effects[ORL_EFFECT_COLOR];
    const size_t materials = orl_plan_survey_count(survey, is_coloured);
    const size_t lights = coloured_lights(lit_scene);
    const double vivid = most_vivid(survey);
    const struct orl_finding finding = {
        .needed = materials + lights > 0,
        .unit = ORL_BOUND_RELATIVE,
        /* Two reflections by the most coloured surface; further ones matter less. */
        .bound = materials + lights > 0 ? vivid * vivid - 1 : 0};
    orl_decision_fill(decision, &finding,
                      "surfaces that have a colour: %zu; lights that have one: %zu", materials,
                      lights);
    plan->channels = decision->simulated ? 3 : 1;
    if (!decision->simulated &&
        (orl_plan_survey_count(survey, has_coloured_data) > 0 || has_coloured_sky(lit_scene))) {
        /* Data cannot be converted to gray. */
        decision->simulated = true;
        plan->channels = 3;
        return;
    }
    if (!decision->simulated && materials + lights > 0) {
        convert_to_gray(lit_scene);
        lit_scene->omit.bleached = true;
    }
    lit_scene->omit.channels = plan->channels;
}

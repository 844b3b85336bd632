/* Names of effects, how a decision is filled in, and the decisions on materials, lights and
 * colour. */
#include "plan/decide.h"

#include <stdarg.h>
#include <stdio.h>

#include <oriel/job/plan.h>

#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"

const char *orl_effect_name(enum orl_effect effect)
{
    static const char *const names[ORL_EFFECT_COUNT] = {
        "sun",
        "sky",
        "exterior",
        "caustics_mirror",
        "caustics_bsdf",
        "caustics_glass",
        "interreflection",
        "glossy",
        "color",
        "media",
        "refraction",
        "lamps",
        "glare",
        "bins",
        "final_gather",
        "ports",
        "suns",
    };
    return effect < ORL_EFFECT_COUNT ? names[effect] : "unknown";
}

const char *orl_effect_override_name(enum orl_effect_override override)
{
    static const char *const names[ORL_OVERRIDE_COUNT] = {"auto", "force", "skip"};
    return override < ORL_OVERRIDE_COUNT ? names[override] : "unknown";
}

bool orl_decision_fill(struct orl_decision *decision, const struct orl_finding *finding,
                       const char *format, ...)
{
    va_list args;
    int at = 0;
    decision->simulated = decision->override == ORL_OVERRIDE_FORCE ||
                          (decision->override == ORL_OVERRIDE_AUTO && finding->needed);
    decision->unit = finding->unit;
    decision->bound = finding->bound;
    decision->saved_s = decision->simulated ? 0 : finding->saved_s;
    decision->cost_s = decision->simulated ? finding->saved_s : 0;
    if (decision->override != ORL_OVERRIDE_AUTO)
        at = snprintf(decision->why, sizeof decision->why, "as asked; ");
    va_start(args, format);
    vsnprintf(decision->why + at, sizeof decision->why - (size_t)at, format, args);
    va_end(args);
    return decision->simulated;
}

/* Decides on glossy reflection, and on absorption and refraction of dielectrics. */

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
    struct orl_reflector *const reflector = &m->as.reflector;
    const double specular = reflector->shares.specular;
    if (m->kind == ORL_MATERIAL_PLASTIC)
        m->color = orl_rgb_add(orl_rgb_scale(m->color, 1 - specular), orl_gray(specular / left));
    reflector->shares.specular = 0;
    reflector->roughness[0] = reflector->roughness[1] = 0;
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
                          "glossy surfaces with roughness: %zu; they mirror at most %.3g %%", count,
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
        const struct orl_rgb t = orl_interface_of(m)->media[side].transmissivity;
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
    if (orl_decision_fill(&plan->effects[ORL_EFFECT_MEDIA], &finding,
                          "surfaces of absorbing dielectrics: %zu; across the whole scene they "
                          "would absorb %.3g %% of the light",
                          count, 100 * lost))
        return;
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        struct orl_material *m = &lit_scene->materials[i];
        if (!is_dielectric(m))
            continue;
        struct orl_medium *const media = m->as.interface.media;
        media[0].transmissivity = media[1].transmissivity = orl_gray(1);
    }
    lit_scene->omit.media = count > 0;
}

/* Refraction may focus: the bound is that of all lights, focused. */
static void decide_refraction(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    const size_t count = orl_plan_survey_count(survey, is_dielectric);
    const double focused = orl_add_focused_suns(lit_scene, survey->sky_lx + survey->lamp_lx);
    const struct orl_finding finding = {
        .needed = count > 0, .unit = ORL_BOUND_LX, .bound = count > 0 ? focused : 0};
    if (orl_decision_fill(&plan->effects[ORL_EFFECT_REFRACTION], &finding,
                          "surfaces of solid dielectrics: %zu", count))
        return;
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        struct orl_material *m = &lit_scene->materials[i];
        if (is_dielectric(m))
            m->as.interface.media[0].ior = m->as.interface.media[1].ior = 1;
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

/* Decides on suns, skies and lamps, by upper bounds of their light. */

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
    const double focused = orl_add_focused_suns(lit_scene, 0);
    const struct orl_finding finding = {
        .needed = focused > survey->tolerance_lx,
        .unit = ORL_BOUND_LX,
        .bound =
            fmin(survey->sun_lx + orl_plan_survey_reflected_lx(survey, survey->sun_lx), focused),
        .saved_s = shadow_rays_s(survey, lit_scene->n_suns)};
    if (!orl_decision_fill(&plan->effects[ORL_EFFECT_SUN], &finding,
                           lit_scene->n_suns == 0
                               ? "the scene has %zu suns"
                               : "suns: %zu; a plane that faces them receives %s without focusing",
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
    if (!orl_decision_fill(&plan->effects[ORL_EFFECT_SKY], &finding,
                           "skies and other wide lights: %zu; their highest radiance from all "
                           "directions would give %s",
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
                           "luminous surfaces: %zu; directly in front of the brightest it is %s",
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

/* Decides on colour, exactly: every used material and every light is checked. */

static bool is_gray(struct orl_rgb c)
{
    return c.r == c.g && c.g == c.b;
}

enum { MOST_COLORS = 4 };

/* Lists the colours that a material's kind has, without those of mixed materials; returns their
 * number. */
static size_t list_colors(struct orl_material *m, struct orl_rgb *ret_colors[MOST_COLORS])
{
    struct orl_diffuse_parts *const diffuse =
        m->kind == ORL_MATERIAL_GLAZING ? &m->as.glazing.diffuse
        : m->kind == ORL_MATERIAL_BSDF  ? &m->as.bsdf_surface.diffuse
                                        : NULL;
    size_t n = 0;
    ret_colors[n++] = &m->color;
    if (m->kind == ORL_MATERIAL_ASHIKHMIN)
        ret_colors[n++] = &m->as.ashikhmin.gloss;
    if (m->kind == ORL_MATERIAL_GLASS)
        ret_colors[n++] = &m->as.glass.transmissivity;
    if (m->kind == ORL_MATERIAL_ILLUM)
        ret_colors[n++] = &m->as.illum.pane.transmissivity;
    for (size_t i = 0; m->kind == ORL_MATERIAL_DIELECTRIC && i < 2; i++)
        ret_colors[n++] = &m->as.interface.media[i].transmissivity;
    if (diffuse) {
        ret_colors[n++] = &diffuse->front;
        ret_colors[n++] = &diffuse->back;
        ret_colors[n++] = &diffuse->through;
    }
    return n;
}

static bool has_coloured_bsdf(const struct orl_material *m)
{
    struct orl_bsdf_info info = {.colored = false};
    if (m->kind == ORL_MATERIAL_BSDF)
        orl_bsdf_describe(orl_material_bsdf(m), &info);
    return info.colored;
}

static bool is_coloured(const struct orl_material *m);

/* Returns true for coloured data that cannot be converted to gray. */
static bool has_coloured_data(const struct orl_material *m)
{
    const struct orl_material *const mixed = orl_material_mixed(m);
    if (mixed && (is_coloured(&mixed[0]) || is_coloured(&mixed[1])))
        return true;
    return has_coloured_bsdf(m) ||
           (m->kind == ORL_MATERIAL_GLAZING && orl_glazing_of(m)->angles->coloured) ||
           (m->pattern && m->pattern->coloured);
}

static bool is_coloured(const struct orl_material *m)
{
    struct orl_material copy = *m;
    struct orl_rgb *colors[MOST_COLORS];
    const size_t n = list_colors(&copy, colors);
    for (size_t i = 0; i < n; i++)
        if (!is_gray(*colors[i]))
            return true;
    return has_coloured_data(m);
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
    const struct orl_material *const mixed = orl_material_mixed(m);
    struct orl_material copy = *m;
    struct orl_rgb *colors[MOST_COLORS];
    /* A medium's colour is not included: it depends on the length of the path. */
    const size_t n = m->kind == ORL_MATERIAL_DIELECTRIC ? 0 : list_colors(&copy, colors);
    double most = 1;
    for (size_t k = 0; k < n; k++)
        most = fmax(most, vividness(*colors[k]));
    for (int i = 0; mixed && i < 2; i++)
        most = fmax(most, vividness_of(&mixed[i]));
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
        struct orl_rgb *colors[MOST_COLORS];
        const size_t n = list_colors(&lit_scene->materials[i], colors);
        for (size_t k = 0; k < n; k++)
            *colors[k] = gray_of(*colors[k]);
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
    orl_decision_fill(decision, &finding, "coloured surfaces: %zu; coloured lights: %zu", materials,
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

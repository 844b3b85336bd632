/* Finds the classes of paths (oriel/job/paths.h) of a scene, and chooses the technique, the number
 * of reflections, and the number of photons. */
#include <stdio.h>
#include <string.h>

#include <oriel/job/paths.h>

#include "plan/decide.h"
#include "render/technique/technique.h"
#include "scene/material/function_brdf/function_brdf_check.h"

/* Largest tolerable share of lamps' mirrored light without virtual images. */
static const double tolerable_left_out = 0.02;

static uint32_t set_if(bool present, enum orl_path_class class)
{
    return present ? 1U << class : 0;
}

/* Returns true if there are lights that only rays can hit: skies and glow sources. */
static bool has_wide_lights(const struct orl_lit_scene *lit_scene)
{
    bool wide = lit_scene->n_domes > 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        wide = wide || !lit_scene->emitters[i].direct;
    return wide;
}

static uint32_t light_classes(const struct orl_lit_scene *lit_scene)
{
    bool direct = lit_scene->n_suns > 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        direct = direct || lit_scene->emitters[i].direct;
    return set_if(has_wide_lights(lit_scene), ORL_PATHS_SKY) | set_if(direct, ORL_PATHS_DIRECT);
}

static uint32_t mirror_classes(const struct orl_lit_scene *lit_scene,
                               const struct orl_lit_specular *lit)
{
    const bool flat = lit->classes[ORL_LIT_FLAT].lit, wide = has_wide_lights(lit_scene);
    return set_if(flat, ORL_PATHS_FLAT_MIRRORS) |
           set_if(lit->classes[ORL_LIT_CURVED].lit, ORL_PATHS_CURVED) |
           set_if(wide && lit->classes[ORL_LIT_CURVED].facets > 0, ORL_PATHS_SKY_CURVED) |
           set_if(flat && lit_scene->n_suns > 0 &&
                      lit_scene->images.n_left_out + lit_scene->images.n_images_left_out > 0,
                  ORL_PATHS_MANY_SUN_MIRRORS) |
           set_if(lit_scene->virtual_lamps.left_out > tolerable_left_out ||
                      lit_scene->virtual_lamps.bright_left_out,
                  ORL_PATHS_MANY_LAMP_MIRRORS) |
           set_if(orl_virtual_lamps_omit_pairs(&lit_scene->virtual_lamps),
                  ORL_PATHS_TWO_LAMP_MIRRORS);
}

static uint32_t lobe_classes(const struct orl_lit_scene *lit_scene,
                             const struct orl_lit_specular *lit)
{
    if (!lit->classes[ORL_LIT_LOBE].lit)
        return 0;
    return set_if(true, ORL_PATHS_LOBES) |
           set_if(orl_find_narrow_lobes(lit_scene->geometry, lit_scene->materials) != NULL,
                  ORL_PATHS_NARROW_LOBES);
}

uint32_t orl_find_path_set(const struct orl_plan_survey *survey, const struct orl_lit_specular *lit)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    return light_classes(lit_scene) | mirror_classes(lit_scene, lit) |
           lobe_classes(lit_scene, lit) | set_if(survey->rho_diffuse > 0, ORL_PATHS_DIFFUSE) |
           set_if(lit_scene->scene->mist != NULL, ORL_PATHS_VOLUME);
}

uint32_t orl_path_set_without_mirrors(uint32_t set)
{
    return set & ~(1U << ORL_PATHS_FLAT_MIRRORS | 1U << ORL_PATHS_CURVED |
                   1U << ORL_PATHS_MANY_SUN_MIRRORS | 1U << ORL_PATHS_MANY_LAMP_MIRRORS |
                   1U << ORL_PATHS_TWO_LAMP_MIRRORS);
}

enum { MOST_LAMPS = 4000000, DEEPEST = 1000 };
enum { PHOTONS_A_WINDOW = 40000, LEAST_WINDOWS = 3 };
/* Virtual point lights: per sample of a sensor, in total and per window; and for views. */
enum { LAMPS_A_SAMPLE = 200, LAMPS_A_WINDOW = 8, LEAST_SAMPLES = 64 };
enum { LAMPS_OF_VIEWS = 200000, LAMPS_OF_A_SAMPLE = 50, LAMPS_A_WINDOW_OF_VIEWS = 10000 };

/* ---- Technique ------------------------------------------------------------------------------- */

/* Returns the number of surfaces of instances, counted in each placement. */
static uint64_t count_placed(const struct orl_geometry *geometry)
{
    uint64_t n = 0;
    for (size_t i = 0; i < geometry->n_prototypes; i++)
        n += (uint64_t)geometry->prototypes[i]->n_facets * geometry->prototypes[i]->n_uses;
    return n;
}

/*
 * Returns the first of two techniques that finds all classes of paths, not some by chance only. If
 * neither does, returns the backward technique, whose results report missed light
 * (run/diagnostics/missed_light.c). Fills ret_why if it is not the first.
 */
static enum orl_technique choose_complete(const enum orl_technique preferred[2], uint32_t paths,
                                          char ret_why[ORL_WHY_MAX])
{
    const uint32_t missed = orl_paths_missed(preferred[0], paths);
    if (missed == 0)
        return preferred[0];
    const bool second = orl_paths_missed(preferred[1], paths) == 0;
    const enum orl_technique technique = second ? preferred[1] : ORL_TECHNIQUE_BACKWARD;
    if (technique != preferred[0])
        snprintf(ret_why, ORL_WHY_MAX, "the scene has %s, which technique %s finds %s",
                 orl_path_class_words(orl_paths_first(missed)), orl_technique_name(preferred[0]),
                 orl_path_strategies(preferred[0], orl_paths_first(missed), ORL_RECEIVER_AIR)
                     ? "by chance only"
                     : "not at all");
    return technique;
}

static enum orl_technique choose_for_views(const struct orl_job *job, uint32_t paths,
                                           char ret_why[ORL_WHY_MAX])
{
    static const enum orl_technique usual[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_BACKWARD},
                                    rated[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    const bool glare = orl_job_asks_for_glare(job);
    if (glare)
        snprintf(ret_why, ORL_WHY_MAX,
                 "views ask for glare metrics: path tracing has no bias, and its batches give the "
                 "error");
    else
        snprintf(ret_why, ORL_WHY_MAX,
                 "%zu view%s: a final gather to a photon map gives smooth images fastest",
                 job->n_views, orl_plural(job->n_views));
    return choose_complete(glare ? rated : usual, paths, ret_why);
}

static enum orl_technique choose_for_sensors(size_t n, uint32_t paths, char ret_why[ORL_WHY_MAX])
{
    static const enum orl_technique preferred[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    snprintf(ret_why, ORL_WHY_MAX,
             "%zu sensor%s: path tracing has no bias; photons serve as virtual lamps, and no map "
             "is stored",
             n, orl_plural(n));
    return choose_complete(preferred, paths, ret_why);
}

/* Returns the planner's technique for the views, or for the sensors. */
static enum orl_technique plan_technique(const struct orl_plan_survey *survey, uint32_t paths,
                                         bool views, char ret_why[ORL_WHY_MAX])
{
    const uint64_t leaves = count_placed(survey->lit_scene->geometry);
    if (leaves > ORL_DEFAULT_PHOTONS && !orl_paths_missed(ORL_TECHNIQUE_BACKWARD, paths)) {
        snprintf(ret_why, ORL_WHY_MAX,
                 "%llu surfaces in instances are more than the photons of a map; path tracing "
                 "needs no map",
                 (unsigned long long)leaves);
        return ORL_TECHNIQUE_BACKWARD;
    }
    return views ? choose_for_views(survey->request->job, paths, ret_why)
                 : choose_for_sensors(survey->request->n_sensors, paths, ret_why);
}

/* Returns the technique for the views, or for the sensors: the job's or the planner's. */
static enum orl_technique choose_technique(const struct orl_plan_survey *survey, uint32_t paths,
                                           bool views, char ret_why[ORL_WHY_MAX])
{
    const struct orl_job *job = survey->request->job;
    const enum orl_effect_override gather = job->overrides[ORL_EFFECT_FINAL_GATHER];
    enum orl_technique technique = job->technique;
    if (technique != ORL_TECHNIQUE_AUTO)
        snprintf(ret_why, ORL_WHY_MAX, "as the job asks");
    else
        technique = plan_technique(survey, paths, views, ret_why);
    if (gather == ORL_OVERRIDE_FORCE && job->technique == ORL_TECHNIQUE_AUTO) {
        snprintf(ret_why, ORL_WHY_MAX, "the job requests a final gather");
        return ORL_TECHNIQUE_GATHER;
    }
    if (gather == ORL_OVERRIDE_SKIP &&
        orl_technique_facts(technique)->final_gather != ORL_GATHER_NOWHERE) {
        snprintf(ret_why, ORL_WHY_MAX, "the job skips the final gather");
        return ORL_TECHNIQUE_DIRECT;
    }
    return technique;
}

/* Sensors beside views get a separate technique, unless the job names one for both or has a
 * deadline. Rounds divide the time of a deadline between sensors and views, and have one
 * technique. */
static void decide_techniques(const struct orl_plan_survey *survey, struct orl_plan *plan)
{
    const struct orl_job *job = survey->request->job;
    const bool views = job->n_views > 0 || survey->request->n_sensors == 0;
    plan->technique = choose_technique(survey, plan->paths, views, plan->technique_why);
    plan->sensor_technique = plan->technique;
    memcpy(plan->sensor_why, plan->technique_why, sizeof plan->sensor_why);
    if (views && survey->request->n_sensors > 0 && !(job->goal.deadline_s > 0))
        plan->sensor_technique = choose_technique(survey, plan->paths, false, plan->sensor_why);
}

static void decide_gather(const struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_decision *decision = &plan->effects[ORL_EFFECT_FINAL_GATHER];
    const bool gathers =
        orl_technique_facts(plan->technique)->final_gather == ORL_GATHER_EVERYWHERE;
    const struct orl_finding finding = {.needed = gathers, .unit = ORL_BOUND_NONE};
    const size_t sensors = survey->request->n_sensors, views = survey->request->job->n_views;
    orl_decision_fill(decision, &finding, "technique %s, for %zu sensor%s and %zu view%s",
                      orl_technique_name(plan->technique), sensors, orl_plural(sensors), views,
                      orl_plural(views));
    decision->simulated = gathers;
}

/* ---- Interreflection ------------------------------------------------------------------------- */

/* Returns the number of reflections after which less than the tolerance is left, of light that
 * nothing focuses. */
static uint32_t reflection_depth(const struct orl_plan_survey *survey,
                                 const struct orl_lit_specular *lit)
{
    const double rho = survey->rho_diffuse;
    double left = survey->sun_lx * (1 + (double)survey->lit_scene->images.n_mirrors) +
                  survey->sky_lx + survey->lamp_lx;
    if (lit->classes[ORL_LIT_CURVED].lit || lit->classes[ORL_LIT_LOBE].lit || rho >= 1)
        return ORL_ALL_REFLECTIONS;
    left *= rho / (1 - rho);
    for (uint32_t n = 0; n < DEEPEST; n++) {
        if (left <= survey->tolerance_lx)
            return n;
        left *= rho;
    }
    return ORL_ALL_REFLECTIONS;
}

static void decide_interreflection(struct orl_plan_survey *survey,
                                   const struct orl_lit_specular *lit, struct orl_plan *plan)
{
    struct orl_decision *decision = &plan->effects[ORL_EFFECT_INTERREFLECTION];
    const double direct = survey->sun_lx + survey->sky_lx + survey->lamp_lx;
    const double rho = fmin(survey->rho_diffuse, 1 - 1e-6);
    const uint32_t n = reflection_depth(survey, lit);
    const struct orl_finding finding = {.needed = n > 0,
                                        .unit = ORL_BOUND_LX,
                                        .bound = direct * rho / (1 - rho),
                                        .saved_s = 3 * (double)ORL_DEFAULT_PHOTONS * survey->ray_s};
    if (n < ORL_ALL_REFLECTIONS)
        orl_decision_fill(decision, &finding,
                          "the brightest diffuse surface reflects %.4g %%: after %u reflections "
                          "less than %.2g lx remains",
                          100 * survey->rho_diffuse, n, survey->tolerance_lx);
    else
        orl_decision_fill(decision, &finding, "the brightest diffuse surface reflects %.4g %%",
                          100 * survey->rho_diffuse);
    plan->most_reflections = !decision->simulated                       ? 0
                             : decision->override == ORL_OVERRIDE_FORCE ? ORL_ALL_REFLECTIONS
                                                                        : n;
}

/* Returns the number of reflections of photons. Where the map itself is read, it counts the light
 * that reaches a surface, not the light that the surface reflects. */
static uint32_t reflections_of_photons(const struct orl_plan *plan)
{
    const bool itself = orl_technique_facts(plan->technique)->shows_map;
    return plan->most_reflections < ORL_ALL_REFLECTIONS ? plan->most_reflections + itself
                                                        : ORL_ALL_REFLECTIONS;
}

/*
 * Returns the number of photons that a technique needs. for_edges is the number for rooms in which
 * suns and lamps make bright edges. Under the sky alone light is smooth. There sensors have the
 * same noise (1.3 %, mostly of gather rays) with 100 000 photons and with 2 000 000, and blocks of
 * 5 x 5 pixels differ by 1.5 %. A tenth of the virtual point lights adds a third to a standard
 * error. Many windows light many rooms, so the number grows with the windows.
 */
static uint64_t enough_photons(const struct orl_plan_survey *survey, uint64_t for_edges,
                               uint64_t a_window)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    const uint64_t windows =
        lit_scene->n_ports > LEAST_WINDOWS ? lit_scene->n_ports : LEAST_WINDOWS;
    const bool forced =
        survey->request->job->overrides[ORL_EFFECT_INTERREFLECTION] == ORL_OVERRIDE_FORCE;
    if (forced || lit_scene->n_suns > 0 || lit_scene->n_emitters > 0 || lit_scene->open ||
        windows > for_edges / a_window)
        return for_edges;
    return a_window * windows;
}

/*
 * Returns the number of virtual point lights. A sample connects to eight of them, and all samples
 * share them. With S samples and L lights a sensor's relative variance is proportional to 1 / S + b
 * / L. b is 90 to 105 in the test office, and 8 in rooms under the sky alone. A sample of its
 * sensors takes as long as about 5 lights. The time for a given error is least with about 200
 * lights per sample there, and 50 here. Pixels are so many that the largest useful number of lights
 * costs them little.
 */
static uint64_t virtual_lamps(const struct orl_plan_survey *survey)
{
    const struct orl_job *job = survey->request->job;
    uint64_t samples = job->gather_samples ? job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    uint64_t all, a_window = LAMPS_A_WINDOW_OF_VIEWS;
    if (job->n_views > 0) {
        all = LAMPS_OF_A_SAMPLE * samples;
        all = all > LAMPS_OF_VIEWS ? all : LAMPS_OF_VIEWS;
    } else {
        samples = samples > LEAST_SAMPLES ? samples : LEAST_SAMPLES;
        all = LAMPS_A_SAMPLE * samples;
        a_window = LAMPS_A_WINDOW * samples;
    }
    all = all < MOST_LAMPS ? all : MOST_LAMPS;
    return job->photons_global < all ? job->photons_global : enough_photons(survey, all, a_window);
}

static uint64_t global_photons(const struct orl_plan_survey *survey, const struct orl_plan *plan)
{
    const uint64_t asked = survey->request->job->photons_global;
    const struct orl_technique_facts *facts = orl_technique_facts(plan->technique);
    if (survey->lit_scene->omit.most_reflections == 0 || survey->lit_scene->scene->mist)
        return 0;
    if (facts->photons == ORL_PHOTONS_FOR_VPLS)
        return virtual_lamps(survey);
    if (asked != ORL_PHOTONS_BY_PLAN)
        return asked;
    return facts->final_gather == ORL_GATHER_EVERYWHERE
               ? enough_photons(survey, ORL_DEFAULT_PHOTONS, PHOTONS_A_WINDOW)
               : ORL_DEFAULT_PHOTONS;
}

void orl_decide_technique(struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                          struct orl_plan *plan)
{
    decide_techniques(survey, plan);
    decide_gather(survey, plan);
    decide_interreflection(survey, lit, plan);
    survey->lit_scene->omit.most_reflections = reflections_of_photons(plan);
    survey->lit_scene->omit.counted_light = orl_technique_facts(plan->technique)->shows_map;
    plan->photons_global = global_photons(survey, plan);
}

/* ---- Requests of jobs ------------------------------------------------------------------------ */

void orl_decide_requests(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    const struct orl_finding nothing = {.needed = false, .unit = ORL_BOUND_NONE};
    const struct orl_job *job = survey->request->job;
    const bool rated = orl_job_asks_for_glare(job);
    const struct orl_finding asked = {.needed = rated, .unit = ORL_BOUND_NONE};
    size_t views = 0;
    for (size_t i = 0; i < job->n_views; i++)
        views += job->views[i].metrics != 0;
    struct orl_decision *glare = &plan->effects[ORL_EFFECT_GLARE];
    struct orl_decision *bins = &plan->effects[ORL_EFFECT_BINS];
    orl_decision_fill(glare, &asked, "%zu of %zu view%s ask%s for a glare metric", views,
                      job->n_views, orl_plural(job->n_views), views == 1 ? "s" : "");
    orl_decision_fill(bins, &nothing,
                      "the job is for 1 moment, not for a year: light needs no separate bins");
    glare->simulated = rated;
    bins->simulated = false;
}

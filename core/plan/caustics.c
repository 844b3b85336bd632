/* Decides on caustics by the surfaces that are lit (lit_specular.c), never by chance hits of a
 * pilot. */
#include <stdio.h>

#include "plan/decide.h"
#include "render/technique/technique.h"

enum { RAYS_A_PHOTON = 3 };

static bool any_lit(const struct orl_lit_specular *lit)
{
    return lit->classes[ORL_LIT_FLAT].lit || lit->classes[ORL_LIT_CURVED].lit ||
           lit->classes[ORL_LIT_LOBE].lit;
}

static double map_time_s(const struct orl_plan_survey *survey)
{
    return RAYS_A_PHOTON * (double)ORL_DEFAULT_PHOTONS * survey->ray_s;
}

/* Returns a bound on the illuminance: a flat mirror doubles a sun, times its reflectance; a curved
 * one may focus it to a point. */
static double mirror_bound(const struct orl_plan_survey *survey, const struct orl_lit_specular *lit)
{
    if (lit->classes[ORL_LIT_CURVED].facets > 0)
        return orl_add_focused_suns(survey->lit_scene, survey->lamp_lx);
    return lit->classes[ORL_LIT_FLAT].share * (survey->sun_lx + survey->lamp_lx);
}

/* Returns true if panes may mirror suns onto outdoor surfaces, from where light enters by
 * windows. */
static bool may_light_outside(const struct orl_plan_survey *survey)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    return lit_scene->images.n_mirrors > 0 && lit_scene->n_suns > 0 &&
           survey->n_clear < lit_scene->n_ports && !lit_scene->omit.exterior;
}

/* Gives the reason if the scene has no such caustics; else returns false. lights, surfaces: what
 * would happen to the light, and what the surfaces do. */
static bool explain_absence(const struct orl_lit_specular *lit, size_t facets, const char *lights,
                            const char *surfaces, const struct orl_finding *finding,
                            struct orl_decision *decision)
{
    if (lit->lights == 0)
        orl_decision_fill(decision, finding, "the scene has %zu suns and lamps %s", lit->lights,
                          lights);
    else if (facets == 0)
        orl_decision_fill(decision, finding, "%zu surfaces %s", facets, surfaces);
    else if (!finding->needed)
        orl_decision_fill(decision, finding,
                          "no sun or lamp lights any of the %zu surface%s that %s indoors", facets,
                          orl_plural(facets), surfaces);
    return lit->lights == 0 || facets == 0 || !finding->needed;
}

/*
 * Decides on mirrors. Surfaces that are lit only by way of other lit ones count too: if there are
 * both mirrors and lobes and one of them is lit, the other may be.
 */
static bool decide_mirrors(const struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                           struct orl_decision *decision)
{
    const struct orl_lit_specular_class *flat = &lit->classes[ORL_LIT_FLAT];
    const struct orl_lit_specular_class *curved = &lit->classes[ORL_LIT_CURVED];
    const size_t facets = flat->facets + curved->facets;
    const bool needed = facets > 0 && (any_lit(lit) || may_light_outside(survey));
    const struct orl_finding finding = {.needed = needed,
                                        .unit = ORL_BOUND_LX,
                                        .bound = needed ? mirror_bound(survey, lit) : 0,
                                        .saved_s =
                                            lit->lights > 0 && facets > 0 ? map_time_s(survey) : 0};
    if (explain_absence(lit, facets, "that could be mirrored", "mirror or refract", &finding,
                        decision))
        return decision->simulated;
    return orl_decision_fill(decision, &finding,
                             "some of %zu flat and %zu curved surfaces that mirror or refract are "
                             "lit%s; they pass on up to %.3g %% of the light",
                             flat->facets, curved->facets,
                             any_lit(lit) ? "" : " from outdoors, where shadow rays include them",
                             100 * fmax(flat->share, curved->share));
}

static bool decide_lobes(const struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                         struct orl_decision *decision)
{
    const struct orl_lit_specular_class *lobes = &lit->classes[ORL_LIT_LOBE];
    const bool needed = lobes->facets > 0 && any_lit(lit);
    const struct orl_finding finding = {
        .needed = needed,
        .unit = ORL_BOUND_LX,
        .bound = needed ? lobes->share * (survey->sun_lx + survey->lamp_lx) : 0,
        .saved_s = lit->lights > 0 && lobes->facets > 0 ? map_time_s(survey) : 0};
    if (explain_absence(lit, lobes->facets, "whose light could be scattered", "scatter into lobes",
                        &finding, decision))
        return decision->simulated;
    return orl_decision_fill(decision, &finding,
                             "some of %zu surface%s that scatter into lobes are lit; they pass on "
                             "up to %.3g %% of the light",
                             lobes->facets, orl_plural(lobes->facets), 100 * lobes->share);
}

/* Returns true for glass of index 1 that is clear, such as the panes of openings
 * (scene/built/ports.h). */
static bool is_invisible(const struct orl_glass *glass)
{
    const struct orl_rgb t = glass->transmissivity;
    return glass->ior == 1 && t.r == 1 && t.g == 1 && t.b == 1;
}

/* Returns true for trans that transmits light without spreading it. */
static bool transmits_straight(const struct orl_reflector *trans)
{
    return !(trans->roughness[0] > 0) && trans->shares.transmitted > 0 &&
           trans->shares.transmitted_specular > 0;
}

static bool is_glass(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_MIXTURE:
        return is_glass(&orl_mixture_of(m)->mixed[0]) || is_glass(&orl_mixture_of(m)->mixed[1]);
    case ORL_MATERIAL_GLASS:
        return !is_invisible(orl_glass_of(m));
    case ORL_MATERIAL_BSDF:
        return orl_bsdf_surface_of(m)->peak;
    case ORL_MATERIAL_TRANS:
        return transmits_straight(orl_reflector_of(m));
    default:
        return m->kind == ORL_MATERIAL_GLAZING;
    }
}

static void decide_glass(const struct orl_plan_survey *survey, struct orl_decision *decision)
{
    const size_t panes = orl_plan_survey_count(survey, is_glass);
    /* Shadow rays pass panes in any case: leaving glass out is not possible, and would save
     * nothing. */
    decision->simulated = true;
    const struct orl_finding finding = {.needed = panes > 0, .unit = ORL_BOUND_LX, .bound = 0};
    orl_decision_fill(decision, &finding,
                      panes == 1 ? "%zu pane transmits light in a straight line: shadow rays "
                                   "compute this exactly, without photons"
                                 : "%zu panes transmit light in a straight line: shadow rays "
                                   "compute this exactly, without photons",
                      panes);
    decision->simulated = panes > 0 || decision->override == ORL_OVERRIDE_FORCE;
}

/*
 * Overrides a skip for the backward technique. Its paths hit mirrors and lobes anyway and include
 * their light, except for suns in flat mirrors, which only shadow rays find.
 */
static void override_skip(struct orl_decision *decision)
{
    char why[ORL_WHY_MAX - 60];
    if (decision->override != ORL_OVERRIDE_SKIP || !(decision->bound > 0))
        return;
    snprintf(why, sizeof why, "%.*s", (int)sizeof why - 1, decision->why);
    snprintf(decision->why, sizeof decision->why, "the backward technique includes them anyway; %s",
             why);
    decision->simulated = true;
    decision->saved_s = 0;
}

static bool reads_caustic_map(const struct orl_plan *plan)
{
    return orl_technique_facts(plan->technique)->reads_map[ORL_MAP_CAUSTIC];
}

/* Returns true if caustic photons have anything to do, or the job forces them. */
static bool needs_photons(const struct orl_lit_specular *lit, const struct orl_plan *plan,
                          bool simulated)
{
    const bool forced = plan->effects[ORL_EFFECT_CAUSTICS_MIRROR].override == ORL_OVERRIDE_FORCE ||
                        plan->effects[ORL_EFFECT_CAUSTICS_BSDF].override == ORL_OVERRIDE_FORCE;
    return simulated && (any_lit(lit) || forced) && reads_caustic_map(plan);
}

/* Removes virtual images of suns and lamps, so that shadow rays no longer search flat mirrors. */
static void remove_images(struct orl_lit_scene *lit_scene)
{
    orl_virtual_suns_keep(&lit_scene->images, NULL);
    lit_scene->virtual_lamps.n_images = 0;
    lit_scene->virtual_lamps.left_out = 0;
    lit_scene->virtual_lamps.bright_left_out = false;
    lit_scene->virtual_lamps.two_mirror_share = 0;
    lit_scene->virtual_lamps.two_bright_mirrors = false;
}

void orl_decide_caustics(struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                         struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    const uint64_t requested = survey->request->job->photons_caustic;
    const bool mirrors = decide_mirrors(survey, lit, &plan->effects[ORL_EFFECT_CAUSTICS_MIRROR]);
    const bool lobes = decide_lobes(survey, lit, &plan->effects[ORL_EFFECT_CAUSTICS_BSDF]);
    decide_glass(survey, &plan->effects[ORL_EFFECT_CAUSTICS_GLASS]);
    lit_scene->omit.mirror_caustics = !mirrors;
    lit_scene->omit.lobe_caustics = !lobes;
    if (plan->effects[ORL_EFFECT_CAUSTICS_MIRROR].override == ORL_OVERRIDE_SKIP)
        remove_images(lit_scene);
    lit_scene->caustics_lit = (mirrors || lobes) && any_lit(lit);
    plan->photons_caustic =
        requested == ORL_PHOTONS_BY_PLAN ? (uint64_t)ORL_DEFAULT_PHOTONS : requested;
    if (!reads_caustic_map(plan)) {
        if (lit->classes[ORL_LIT_CURVED].facets > 0 || lit->lights > lit_scene->n_suns)
            override_skip(&plan->effects[ORL_EFFECT_CAUSTICS_MIRROR]);
        override_skip(&plan->effects[ORL_EFFECT_CAUSTICS_BSDF]);
    }
    if (!needs_photons(lit, plan, mirrors || lobes))
        plan->photons_caustic = 0;
    if (!mirrors)
        plan->paths = orl_path_set_without_mirrors(plan->paths);
}

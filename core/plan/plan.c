#include "plan/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "plan/decide.h"

int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_lit_scene **ret_lit_scene,
                  struct orl_error *err)
{
    struct orl_lit_scene *lit_scene;
    struct orl_plan_survey survey;
    struct orl_lit_specular lit;
    int code = orl_lit_scene_new(lights, request->pool, &lit_scene, err);
    if (code < 0)
        return code;
    memset(ret_plan, 0, sizeof *ret_plan);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        ret_plan->effects[i].override = request->job->overrides[i];
    code = orl_plan_survey_init(&survey, request, lit_scene);
    if (code < 0) {
        orl_error_set(err, code, "out of memory for the plan");
        goto done;
    }
    orl_decide_materials(&survey, ret_plan);
    orl_decide_lights(&survey, ret_plan);
    orl_decide_windows(&survey, ret_plan);
    orl_decide_color(&survey, ret_plan);
    orl_lit_specular_find(&survey, &lit);
    ret_plan->paths = orl_find_path_set(&survey, &lit);
    orl_decide_technique(&survey, &lit, ret_plan);
    orl_decide_caustics(&survey, &lit, ret_plan);
    orl_decide_requests(&survey, ret_plan);
    orl_lit_scene_update_seen(lit_scene);
done:
    orl_plan_survey_done(&survey);
    if (code == 0)
        *ret_lit_scene = lit_scene;
    else
        orl_lit_scene_free(lit_scene);
    return code;
}

/* Weight from which on caustics get as many photons as the global map. */
static const double full_weight = 0.05;
/* A caustic map with fewer photons is too sparse for a kernel; with fewer still there is no map. */
static const double least_photons = 20000, fewest_photons = 64;
/* Rays of caustic photons, relative to those of the global ones: at zero weight, and the addition
 * at full weight. */
static const double rays_at_zero = 0.5, rays_at_full = 30;
/* Share of rays whose cost is negligible: where photons are cheap, the map gets more of them. */
static const double negligible_rays = 0.1;

/* Lower limit of the global photons that the bound on a job's request is based on; about a
 * second. */
static const double least_base = 200000;

/* Returns the number of global photons, or the default if there is no global map. */
static double global_photons(const struct orl_plan *plan)
{
    return plan->photons_global > 0 ? (double)plan->photons_global : (double)ORL_DEFAULT_PHOTONS;
}

bool orl_plan_bounds_caustics(const struct orl_job *job)
{
    return job->photons_caustic != ORL_PHOTONS_BY_PLAN && job->photons_caustic > ORL_FEW_PHOTONS &&
           !job->photons_exact;
}

/* Rounds to two digits, so that a pilot with another seed gives the same number. */
static uint64_t to_two_digits(double count)
{
    const double unit = pow(10, floor(log10(fmax(count, 1))) - 1);
    return (uint64_t)fmax(round(count / unit) * unit, 1);
}

static double weight_of(const struct orl_photon_pilot *pilot)
{
    return fmin(pilot->share * pilot->contrast / full_weight, 1);
}

/* Returns the number of photons whose rays match the caustics' weight relative to `base` global
 * photons; infinite if the pilot is not conclusive. */
static double bound_by_rays(const struct orl_photon_pilot *pilot, double base, double weight)
{
    if (!(pilot->yield[ORL_MAP_CAUSTIC] > 0 && pilot->yield[ORL_MAP_GLOBAL] > 0))
        return INFINITY;
    const double rays = base * pilot->rays[ORL_MAP_GLOBAL] / pilot->yield[ORL_MAP_GLOBAL];
    const double each = pilot->rays[ORL_MAP_CAUSTIC] / pilot->yield[ORL_MAP_CAUSTIC];
    return (rays_at_zero + rays_at_full * weight * weight) * rays / each;
}

/* Limits the job's request. A user who asks for more may want a small spot sharp, but hardly a
 * faint gleam. */
static uint64_t bound_request(const struct orl_job *job, const struct orl_photon_pilot *pilot,
                              const struct orl_plan *plan, uint64_t enough)
{
    const double requested = (double)job->photons_caustic;
    const double weight = fmax(weight_of(pilot), pilot->contrast * pilot->contrast);
    const double most = bound_by_rays(pilot, fmax(global_photons(plan), least_base), weight);
    if (!orl_plan_bounds_caustics(job) || requested <= fmax(most, (double)enough))
        return job->photons_caustic;
    return to_two_digits(fmax(fmax(most, (double)enough), fewest_photons));
}

/* Returns the odds of a share; finite, since a pilot knows no share to better than a thousandth. */
static double odds_of(double share)
{
    return share / fmax(1 - share, 1e-3);
}

/*
 * Returns the number of caustic photons by Neyman allocation. Where caustics land, the variance of
 * their light is its square over the photons on an area; the same holds for the rest of the light.
 * For a given number of rays, the sum of both variances is least if each kind gets rays in
 * proportion to a square root: that of its variance for one photon times its rays for one photon.
 * Contrast and share together give both light and area.
 */
static double neyman_photons(const struct orl_photon_pilot *pilot, double base)
{
    if (!(pilot->yield[ORL_MAP_CAUSTIC] > 0 && pilot->yield[ORL_MAP_GLOBAL] > 0))
        return INFINITY;
    const double rest = pilot->rays[ORL_MAP_GLOBAL] / pilot->yield[ORL_MAP_GLOBAL];
    const double each = pilot->rays[ORL_MAP_CAUSTIC] / pilot->yield[ORL_MAP_CAUSTIC];
    const double ratio = sqrt(odds_of(pilot->share) * odds_of(pilot->contrast) * each / rest);
    return (rays_at_zero + ratio) * base * rest / each;
}

static uint64_t caustic_photons(const struct orl_photon_pilot *pilot, const struct orl_plan *plan)
{
    const double base = global_photons(plan);
    const double weight = weight_of(pilot);
    double photons = fmax(weight * base, fmin(least_photons, base));
    if (pilot->yield[ORL_MAP_CAUSTIC] > 0 && pilot->yield[ORL_MAP_GLOBAL] > 0) {
        const double rays = base * pilot->rays[ORL_MAP_GLOBAL] / pilot->yield[ORL_MAP_GLOBAL];
        const double each = pilot->rays[ORL_MAP_CAUSTIC] / pilot->yield[ORL_MAP_CAUSTIC];
        photons = fmax(photons, fmin(negligible_rays * rays / each, base));
        photons = fmin(photons, bound_by_rays(pilot, base, weight));
        photons = fmin(photons, neyman_photons(pilot, base));
        photons = fmax(photons, fmin(fewest_photons, base));
    }
    return to_two_digits(photons);
}

static void fill_forecast(const struct orl_photon_pilot *pilot,
                          const uint64_t photons[ORL_SHOT_KINDS], struct orl_photon_forecast *f)
{
    f->photons_s = 0;
    f->known = true;
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        const bool found = pilot->stored[k] > 0 && (k == ORL_MAP_GLOBAL || pilot->known);
        f->emitted[k] = photons[k] == 0 ? 0 : found ? (double)photons[k] / pilot->yield[k] : NAN;
        f->seconds[k] = photons[k] == 0 ? 0 : f->emitted[k] * pilot->emission_s[k];
        f->known = f->known && (photons[k] == 0 || found);
        f->photons_s += f->seconds[k];
    }
    const double rays = pilot->rays[ORL_MAP_GLOBAL], ray_s = pilot->emission_s[ORL_MAP_GLOBAL];
    f->ray_s = rays > 0 && isfinite(ray_s) ? ray_s / rays : 0;
}

static void describe_choice(const struct orl_photon_pilot *pilot, const struct orl_plan *plan,
                            uint64_t requested, struct orl_photon_forecast *f)
{
    if (plan->photons_caustic == 0)
        snprintf(f->why, sizeof f->why, "0 caustic photons: no caustic paths are possible");
    else if (!pilot->known)
        snprintf(f->why, sizeof f->why,
                 "of %llu pilot emissions, %llu gave a caustic photon: the cost of caustic photons "
                 "is not known",
                 (unsigned long long)pilot->emitted[ORL_MAP_CAUSTIC],
                 (unsigned long long)pilot->stored[ORL_MAP_CAUSTIC]);
    else
        snprintf(f->why, sizeof f->why,
                 "caustics are %.2g %% of all light and %.2g %% where they fall: %llu photons %s, "
                 "one per %.3g emissions",
                 100 * pilot->share, 100 * pilot->contrast,
                 (unsigned long long)plan->photons_caustic,
                 requested == plan->photons_caustic ? "as asked" : "are enough",
                 1 / pilot->yield[ORL_MAP_CAUSTIC]);
}

void orl_plan_budget(const struct orl_job *job, const struct orl_photon_pilot *pilot,
                     struct orl_plan *plan)
{
    struct orl_photon_forecast *f = &plan->forecast;
    const bool requested = job->photons_caustic != ORL_PHOTONS_BY_PLAN;
    *f = (struct orl_photon_forecast){.made = true, .caustic_share = pilot->share};
    if (plan->photons_caustic > 0) {
        const uint64_t enough = caustic_photons(pilot, plan);
        f->enough_caustic = enough;
        plan->photons_caustic = requested ? bound_request(job, pilot, plan, enough) : enough;
    }
    const uint64_t photons[ORL_SHOT_KINDS] = {plan->photons_global, plan->photons_caustic};
    fill_forecast(pilot, photons, f);
    describe_choice(pilot, plan, job->photons_caustic, f);
}

#include "plan/budget.h"

#include <math.h>
#include <stdio.h>

/* Worth from which on caustics have as many photons as the rest. */
static const double full_worth = 0.05;
/* A map of fewer has hardly a kernel's worth anywhere; fewer still are no map. */
static const double least_photons = 20000, fewest_photons = 64;
/* Rays of caustic photons, of those of the global ones: at no worth, and what all of it adds. */
static const double rays_of_none = 0.5, rays_of_all = 30;
/* So many are not felt: where photons come cheap there are more of them. */
static const double rays_not_felt = 0.1;

/* Global photons that the bound of what a job asks for goes by, at the least: a second or so. */
static const double least_base = 200000;

/* Photons that the global map has, or would have. */
static double global_photons(const struct orl_plan *plan)
{
    return plan->photons_global > 0 ? (double)plan->photons_global : (double)ORL_DEFAULT_PHOTONS;
}

bool orl_plan_bounds_caustics(const struct orl_job *job)
{
    return job->photons_caustic != ORL_PHOTONS_BY_PLAN && job->photons_caustic > ORL_FEW_PHOTONS &&
           !job->photons_exact;
}

/* To two digits, so that a pilot of another seed says the same. */
static uint64_t to_two_digits(double count)
{
    const double unit = pow(10, floor(log10(fmax(count, 1))) - 1);
    return (uint64_t)fmax(round(count / unit) * unit, 1);
}

static double weight_of(const struct orl_worth *worth)
{
    return fmin(worth->share * worth->contrast / full_worth, 1);
}

/* Photons whose rays are as many as caustics are worth beside so many global ones; infinite where a
 * pilot cannot tell. */
static double bound_by_rays(const struct orl_worth *worth, double base, double weight)
{
    if (!(worth->yield[ORL_MAP_CAUSTIC] > 0 && worth->yield[ORL_MAP_GLOBAL] > 0))
        return INFINITY;
    const double rays = base * worth->rays[ORL_MAP_GLOBAL] / worth->yield[ORL_MAP_GLOBAL];
    const double each = worth->rays[ORL_MAP_CAUSTIC] / worth->yield[ORL_MAP_CAUSTIC];
    return (rays_of_none + rays_of_all * weight * weight) * rays / each;
}

/* Of what a job asks for: who asks for more may want a small spot sharp, but hardly a gleam. */
static uint64_t bound(const struct orl_job *job, const struct orl_worth *worth,
                      const struct orl_plan *plan, uint64_t enough)
{
    const double asked = (double)job->photons_caustic;
    const double weight = fmax(weight_of(worth), worth->contrast * worth->contrast);
    const double most = bound_by_rays(worth, fmax(global_photons(plan), least_base), weight);
    if (!orl_plan_bounds_caustics(job) || asked <= fmax(most, (double)enough))
        return job->photons_caustic;
    return to_two_digits(fmax(fmax(most, (double)enough), fewest_photons));
}

/* Odds of a share; finite, for a pilot knows no share to better than a thousandth. */
static double odds(double share)
{
    return share / fmax(1 - share, 1e-3);
}

/*
 * The caustic photons of the Neyman allocation. Where caustics land, the variance of their light is
 * its square over the photons on an area, and so is that of the rest. The sum of both is least, for
 * a number of rays, when each kind has rays as the root of its variance for one photon times its
 * rays for one photon. Contrast and share together tell both light and area.
 */
static double best_by_rays(const struct orl_worth *worth, double base)
{
    if (!(worth->yield[ORL_MAP_CAUSTIC] > 0 && worth->yield[ORL_MAP_GLOBAL] > 0))
        return INFINITY;
    const double rest = worth->rays[ORL_MAP_GLOBAL] / worth->yield[ORL_MAP_GLOBAL];
    const double each = worth->rays[ORL_MAP_CAUSTIC] / worth->yield[ORL_MAP_CAUSTIC];
    const double times = sqrt(odds(worth->share) * odds(worth->contrast) * each / rest);
    return (rays_of_none + times) * base * rest / each;
}

static uint64_t caustic_photons(const struct orl_worth *worth, const struct orl_plan *plan)
{
    const double base = global_photons(plan);
    const double weight = weight_of(worth);
    double photons = fmax(weight * base, fmin(least_photons, base));
    if (worth->yield[ORL_MAP_CAUSTIC] > 0 && worth->yield[ORL_MAP_GLOBAL] > 0) {
        const double rays = base * worth->rays[ORL_MAP_GLOBAL] / worth->yield[ORL_MAP_GLOBAL];
        const double each = worth->rays[ORL_MAP_CAUSTIC] / worth->yield[ORL_MAP_CAUSTIC];
        photons = fmax(photons, fmin(rays_not_felt * rays / each, base));
        photons = fmin(photons, bound_by_rays(worth, base, weight));
        photons = fmin(photons, best_by_rays(worth, base));
        photons = fmax(photons, fmin(fewest_photons, base));
    }
    return to_two_digits(photons);
}

static void foresee(const struct orl_worth *worth, const uint64_t photons[ORL_SHOT_KINDS],
                    struct orl_foresight *f)
{
    f->photons_s = 0;
    f->known = true;
    for (int k = 0; k < ORL_SHOT_KINDS; k++) {
        const bool found = worth->stored[k] > 0 && (k == ORL_MAP_GLOBAL || worth->known);
        f->emitted[k] = photons[k] == 0 ? 0 : found ? (double)photons[k] / worth->yield[k] : NAN;
        f->seconds[k] = photons[k] == 0 ? 0 : f->emitted[k] * worth->emission_s[k];
        f->known = f->known && (photons[k] == 0 || found);
        f->photons_s += f->seconds[k];
    }
    const double rays = worth->rays[ORL_MAP_GLOBAL], ray_s = worth->emission_s[ORL_MAP_GLOBAL];
    f->ray_s = rays > 0 && isfinite(ray_s) ? ray_s / rays : 0;
}

static void say_why(const struct orl_worth *worth, const struct orl_plan *plan, uint64_t asked,
                    struct orl_foresight *f)
{
    if (plan->photons_caustic == 0)
        snprintf(f->why, sizeof f->why, "0 caustic photons: there is no way for any");
    else if (!worth->known)
        snprintf(f->why, sizeof f->why,
                 "of %llu emissions of a pilot %llu came to a caustic photon: what they will take "
                 "is not known",
                 (unsigned long long)worth->emitted[ORL_MAP_CAUSTIC],
                 (unsigned long long)worth->stored[ORL_MAP_CAUSTIC]);
    else
        snprintf(f->why, sizeof f->why,
                 "caustics are %.2g %% of the light and %.2g %% of it where they land: %llu "
                 "photons %s, one of %.3g emissions",
                 100 * worth->share, 100 * worth->contrast,
                 (unsigned long long)plan->photons_caustic,
                 asked == plan->photons_caustic ? "as asked" : "are worth their time",
                 1 / worth->yield[ORL_MAP_CAUSTIC]);
}

void orl_plan_budget(const struct orl_job *job, const struct orl_worth *worth,
                     struct orl_plan *plan)
{
    struct orl_foresight *f = &plan->foresight;
    const bool asked = job->photons_caustic != ORL_PHOTONS_BY_PLAN;
    *f = (struct orl_foresight){.made = true, .caustic_share = worth->share};
    if (plan->photons_caustic > 0) {
        const uint64_t enough = caustic_photons(worth, plan);
        f->enough_caustic = enough;
        plan->photons_caustic = asked ? bound(job, worth, plan, enough) : enough;
    }
    const uint64_t photons[ORL_SHOT_KINDS] = {plan->photons_global, plan->photons_caustic};
    foresee(worth, photons, f);
    say_why(worth, plan, job->photons_caustic, f);
}

#include "run/diagnostics/cross_check_verdict.h"

#include <math.h>

#include "plan/decide.h"
#include "run/diagnostics/diagnostics.h"
#include "run/diagnostics/run_warnings.h"
#include "run/run_state.h"

static const double least_effective = 30; /* effective number of samples */
/* A difference counts beyond so many joint standard errors, and such a share of the light. */
static const double differs_in_errors = 5, differs_by = 0.1;
/* A difference of a class counts if it is this share of the class's light. It is attributed to
 * groups in which it is also this share of all light. */
static const double differs_by_class = 0.25, matters = 0.05;
static const double bound_in_errors = 2;

/* A group, with the technique's result for the same sensors. */
struct compared {
    const struct orl_plain_group *group;
    double lx; /* sum of the technique's values */
    /* Sum of the standard errors implied by the intervals; those of neighbours are assumed
     * correlated. */
    double error;
};

static struct compared compare_group(const struct orl_result *r,
                                     const struct orl_plain_groups *groups, size_t index)
{
    struct compared c = {.group = &groups->groups[index]};
    const size_t end = c.group->first + c.group->count;
    for (size_t i = c.group->first; i < end; i += groups->stride) {
        c.lx += r->illuminance_lx[i];
        c.error += (r->interval_95_lx[i][1] - r->interval_95_lx[i][0]) / (2 * 1.96);
    }
    return c;
}

static bool is_known(const struct compared *c)
{
    return c->group->effective >= least_effective;
}

static double variance_of(const struct compared *c)
{
    return c->group->variance + c->error * c->error;
}

/* ---- Classes --------------------------------------------------------------------------------- */

/* Least-squares fit of the differences of all groups by the light of one class. */
struct match {
    double share;  /* the factor of the class's light: 1 if all of it is missing */
    double errors; /* that factor over its standard error */
};

static struct match match_class(const struct orl_result *r, const struct orl_plain_groups *groups,
                                int light)
{
    double product = 0, squares = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const struct compared c = compare_group(r, groups, g);
        const double variance = variance_of(&c), lx = c.group->classes[light];
        if (!is_known(&c) || !(variance > 0))
            continue;
        product += (c.group->sum - c.lx) * lx / variance;
        squares += lx * lx / variance;
    }
    return squares > 0 ? (struct match){product / squares, product / sqrt(squares)}
                       : (struct match){0, 0};
}

/* Returns the class whose fit is the most significant. */
static enum orl_light_class find_class(const struct orl_result *r,
                                       const struct orl_plain_groups *groups,
                                       struct match *ret_match)
{
    enum orl_light_class best = ORL_LIGHT_STRAIGHT;
    *ret_match = (struct match){0, 0};
    for (int light = 0; light < ORL_LIGHT_CLASSES; light++) {
        const struct match match = match_class(r, groups, light);
        if (fabs(match.errors) <= fabs(ret_match->errors))
            continue;
        best = (enum orl_light_class)light;
        *ret_match = match;
    }
    return best;
}

const char *orl_light_class_name(enum orl_light_class light)
{
    static const char *const names[] = {"direct light of suns and lamps",
                                        "mirrored light of suns and lamps",
                                        "direct light from outdoors", "reflected light"};
    return names[light];
}

/* ---- Groups ---------------------------------------------------------------------------------- */

/* Widens the group's intervals to include `sum` and marks its sensors. Each sensor's bound is in
 * proportion to its value, or the mean if none has any light. */
static void widen_group(struct orl_run_state *state, const struct compared *c, double sum)
{
    struct orl_result *r = state->result;
    const struct orl_plain_group *group = c->group;
    for (size_t i = group->first; i < group->first + group->count; i++) {
        double *const interval = r->interval_95_lx[i];
        const double bound =
            c->lx > 0 ? r->illuminance_lx[i] * sum / c->lx : sum / (double)group->traced;
        interval[0] = fmin(interval[0], fmax(bound, 0));
        interval[1] = fmax(interval[1], bound);
        orl_run_mark_unreliable(state, i, ORL_DOUBT_CROSS_CHECK);
    }
    r->cross_check.sensors_off += group->count;
}

/* The class that best fits the differences of all groups. If match.share is 0, no class fits well
 * enough to count. */
struct verdict {
    enum orl_light_class light;
    struct match match;
};

/* Returns true if the group differs, by itself or as part of a class, and has widened it then. */
static bool evaluate_group(struct orl_run_state *state, const struct compared *c, bool find_all,
                           const struct verdict *verdict)
{
    const double off = c->group->sum - c->lx, scatter = sqrt(c->group->variance);
    const double of_class = verdict->match.share * c->group->classes[verdict->light];
    const bool by_itself = fabs(off) >= differs_in_errors * sqrt(variance_of(c)) &&
                           fabs(off) >= differs_by * c->lx && (off > 0 || find_all);
    if (!by_itself && !(fabs(of_class) >= matters * c->lx))
        return false;
    const double difference = by_itself ? off : of_class;
    const double by_paths = c->group->sum + copysign(bound_in_errors * scatter, difference);
    const double by_class = c->lx + of_class * (1 + bound_in_errors / fabs(verdict->match.errors));
    const double sum = by_itself        ? by_paths
                       : difference > 0 ? fmax(by_paths, by_class)
                                        : fmin(by_paths, by_class);
    widen_group(state, c, sum);
    return true;
}

/* Returns the ratio of a group's light by paths to its light by the technique, at most 1000. */
static double ratio_of(const struct compared *c)
{
    return c->group->sum / fmax(c->lx, 1e-3 * c->group->sum);
}

static void warn_of_worst(struct orl_run_state *state, const struct compared *worst)
{
    struct orl_result *r = state->result;
    const enum orl_technique technique = r->plan.technique;
    const struct orl_plain_group *group = worst->group;
    orl_run_warn(state,
                 "cross-check: plain path tracing finds %.2g times the light that technique %s has "
                 "found at %zu sensor%s from sensors[%zu] on, beyond the errors of both; the "
                 "difference is most like the %s. Intervals of %zu sensor%s are widened to include "
                 "it. Compare with technique %s",
                 ratio_of(worst), orl_technique_name(technique), group->count,
                 orl_plural(group->count), group->first,
                 orl_light_class_name(r->cross_check.differs_in), r->cross_check.sensors_off,
                 orl_plural(r->cross_check.sensors_off),
                 technique == ORL_TECHNIQUE_BACKWARD ? "gather" : "backward");
}

void orl_cross_check_evaluate(struct orl_run_state *state, const struct orl_plain_groups *groups)
{
    struct orl_result *r = state->result;
    struct orl_cross_check *check = &r->cross_check;
    struct verdict verdict;
    struct compared worst = {.group = NULL};
    double all = 0, by_paths = 0, variance = 0;
    verdict.light = check->differs_in = find_class(r, groups, &verdict.match);
    if (fabs(verdict.match.errors) < differs_in_errors ||
        fabs(verdict.match.share) < differs_by_class ||
        (verdict.match.share < 0 && !groups->find_all))
        verdict.match.share = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const struct compared c = compare_group(r, groups, g);
        check->paths += (uint64_t)groups->paths * c.group->traced;
        if (!is_known(&c))
            continue;
        check->sensors += c.group->traced;
        all += c.lx;
        by_paths += c.group->sum;
        variance += c.group->variance;
        if (evaluate_group(state, &c, groups->find_all, &verdict) &&
            (!worst.group || fabs(log(ratio_of(&c))) > fabs(log(ratio_of(&worst)))))
            worst = c;
    }
    const bool known = all > 0 && (groups->find_all || by_paths >= all);
    check->ratio = known ? by_paths / all : NAN;
    check->ratio_error = known ? sqrt(variance) / all : NAN;
    if (worst.group)
        warn_of_worst(state, &worst);
}

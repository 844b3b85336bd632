/*
 * The planner's decisions, by kind. Each looks at the survey, decides for its effects, and takes
 * what is left out from the world being made, so that those after it see it as it is going to be: a
 * lamp left out lights no mirror.
 *
 * Every decision is orl_settle's: it joins what the scene calls for with what the job wishes.
 */
#ifndef ORL_PLAN_DECIDE_H
#define ORL_PLAN_DECIDE_H

#include "plan/lit_specular.h"
#include "plan/survey.h"

/* What the scene says of an effect. */
struct orl_finding {
    bool needed;
    enum orl_bound_unit unit;
    double bound;   /* of skipping it */
    double saved_s; /* by skipping it */
};

/*
 * Fills in the decision; its wish is there. format: why, one sentence without its full stop.
 * Returns whether the effect is simulated.
 */
bool orl_settle(struct orl_decision *decision, const struct orl_finding *finding,
                const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The end of a noun of which there are so many. */
static inline const char *orl_plural(size_t count)
{
    return count == 1 ? "" : "s";
}

/* glossy, media, refraction: changes materials. */
void orl_decide_materials(struct orl_survey *survey, struct orl_plan *plan);
/* sun, sky, lamps: takes them out. */
void orl_decide_lights(struct orl_survey *survey, struct orl_plan *plan);
/* exterior, ports, suns. */
void orl_decide_windows(struct orl_survey *survey, struct orl_plan *plan);
/* color. */
void orl_decide_color(struct orl_survey *survey, struct orl_plan *plan);
/* caustics by mirrors, lobes, and straight through glass. */
void orl_decide_caustics(struct orl_survey *survey, const struct orl_lit *lit,
                         struct orl_plan *plan);
/* The classes of paths that the scene has (oriel/paths.h), as flags; and a set without those by way
 * of mirrors and dielectrics. */
uint32_t orl_find_path_set(const struct orl_survey *survey, const struct orl_lit *lit);
uint32_t orl_path_set_without_mirrors(uint32_t set);
/* The technique and the final gather, interreflection, and how many photons. */
void orl_decide_technique(struct orl_survey *survey, const struct orl_lit *lit,
                          struct orl_plan *plan);
/* glare, bins: never asked for by a job of today. */
void orl_decide_requests(struct orl_survey *survey, struct orl_plan *plan);

#endif

/*
 * The planner's decisions, by kind. Each function reads the survey, decides on its effects, and
 * removes skipped parts from the world being built. Later functions see the reduced world: a lamp
 * left out lights no mirror.
 *
 * Every decision goes through orl_decision_fill, which combines the need of the scene with the
 * job's override.
 */
#ifndef ORL_PLAN_DECIDE_H
#define ORL_PLAN_DECIDE_H

#include "plan/lit_specular.h"
#include "plan/survey.h"

/* Result of examining the scene for an effect. */
struct orl_finding {
    bool needed;
    enum orl_bound_unit unit;
    double bound;   /* effect of skipping it */
    double saved_s; /* estimated time saved by skipping it */
};

/*
 * Fills the decision, whose wish is already set. format: the reason, one sentence without its full
 * stop. Returns true if the effect is simulated.
 */
bool orl_decision_fill(struct orl_decision *decision, const struct orl_finding *finding,
                       const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Returns the plural ending of a noun for a count. */
static inline const char *orl_plural(size_t count)
{
    return count == 1 ? "" : "s";
}

/* Decides on glossy, media, refraction; changes materials. */
void orl_decide_materials(struct orl_plan_survey *survey, struct orl_plan *plan);
/* Decides on sun, sky, lamps; removes lights. */
void orl_decide_lights(struct orl_plan_survey *survey, struct orl_plan *plan);
/* Decides on exterior, ports, suns. */
void orl_decide_windows(struct orl_plan_survey *survey, struct orl_plan *plan);
/* Decides on color. */
void orl_decide_color(struct orl_plan_survey *survey, struct orl_plan *plan);
/* Decides on caustics by mirrors, by lobes, and straight through glass. */
void orl_decide_caustics(struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                         struct orl_plan *plan);
/* Return the path classes of the scene (oriel/job/paths.h), as flags; and a set without the classes
 * by mirrors and dielectrics. */
uint32_t orl_find_path_set(const struct orl_plan_survey *survey,
                           const struct orl_lit_specular *lit);
uint32_t orl_path_set_without_mirrors(uint32_t set);
/* Decides on technique, final gather, interreflection and photon numbers. */
void orl_decide_technique(struct orl_plan_survey *survey, const struct orl_lit_specular *lit,
                          struct orl_plan *plan);
/* Decides on glare and bins; bins are never requested by current jobs. */
void orl_decide_requests(struct orl_plan_survey *survey, struct orl_plan *plan);

#endif

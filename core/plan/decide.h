/*
 * The planner's internal interface: facts about the scene (survey), lit mirrors and lobes, and the
 * decisions by kind.
 *
 * The survey holds materials in use, strength of the lights, size of the job, and cost of a ray. It
 * makes no decisions.
 *
 * Bounds. In a scene of passive surfaces no radiance is larger than that of the brightest light: E
 * <= pi L anywhere, in spite of mirrors and lenses. For domes and lamps that bound is tight enough.
 * For a sun it is far too loose. If nothing focuses, the bound is the sun's irradiance and its
 * diffuse reflections, 1 / (1 - rho).
 *
 * Tolerance: an effect on auto is skipped if it changes no point by more than this many lux: 0.01,
 * or a millionth of the largest possible light of all sources, whichever is less.
 */
#ifndef ORL_PLAN_DECIDE_H
#define ORL_PLAN_DECIDE_H

#include "light/lit_scene.h"
#include "plan/plan.h"

struct orl_plan_survey {
    const struct orl_plan_request *request;
    struct orl_lit_scene *lit_scene;
    uint32_t *surfaces;             /* per material: number of surfaces */
    double sun_lx, sky_lx, lamp_lx; /* upper bounds, at unfocused points */
    double tolerance_lx;
    bool sky_measured;  /* true: sky_lx is final; domes are removed all or none */
    double rho_diffuse; /* largest diffuse reflectance of a surface */
    double rho;         /* largest diffuse or glossy reflectance of a surface */
    double ray_s;       /* seconds per ray, shading included */
    double pixels, sensor_rays;
    size_t n_clear; /* number of clear ports, see light/lit_scene.h */
};

/* Collects the facts. Returns 0 or ORL_ERR_NOMEM. Call orl_plan_survey_done in either case. */
int orl_plan_survey_init(struct orl_plan_survey *survey, const struct orl_plan_request *request,
                         struct orl_lit_scene *lit_scene);
void orl_plan_survey_done(struct orl_plan_survey *survey);

/* Measures lights and reflectances again, after something was left out. */
void orl_plan_survey_measure(struct orl_plan_survey *survey);

/* Returns the illuminance by any number of reflections of reflectance rho, for a direct
 * illuminance. */
double orl_plan_survey_reflected_lx(const struct orl_plan_survey *survey, double direct_lx);

/* Returns a sum, from a first term on, of the suns' illuminances under any focusing. */
static inline double orl_add_focused_suns(const struct orl_lit_scene *lit_scene, double sum_lx)
{
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        sum_lx += ORL_EFFICACY_LM_PER_W * ORL_PI * orl_luma(lit_scene->suns[i].radiance);
    return sum_lx;
}

/* Returns the number of surfaces whose material passes the test. */
size_t orl_plan_survey_count(const struct orl_plan_survey *survey,
                             bool (*is)(const struct orl_material *material));

/* Returns true if a sensor or an eye of the job is, or may be, outside the building. */
bool orl_plan_survey_is_outdoor(const struct orl_plan_survey *survey);

/*
 * Finds mirrors, lenses and lobes that a sun or lamp lights, and that may therefore make caustics.
 * A small mirror that focuses the sun is easily missed by random light. So every facet of such a
 * material is tested from an even set of points on each of its sides, by shadow rays to all suns
 * and lamps, through panes. Rays from the windows along the suns find sun patches that are small
 * relative to the facet. Suns in flat outdoor mirrors are searched from the windows, as virtual
 * suns.
 *
 * In sealed scenes surfaces lit outdoors make no caustics indoors, except for those images, and for
 * panes that are lit from outside and scatter light in.
 *
 * The result depends on the scene alone. The number of rays is bounded and shared among the facets.
 * If facets and lights are too many, all such surfaces count as lit.
 */

enum orl_lit_specular_kind {
    ORL_LIT_FLAT,   /* flat mirrors and panes */
    ORL_LIT_CURVED, /* curved mirrors, and dielectrics: surfaces that may focus */
    ORL_LIT_LOBE,   /* BSDFs, rough metal and plastic, trans */
    ORL_LIT_KINDS
};

struct orl_lit_specular_class {
    size_t facets; /* number of facets of that kind */
    bool lit;      /* true: at least one is lit, inside, by a sun or lamp */
    double share;  /* share of light that the strongest of them sends on */
};

struct orl_lit_specular {
    struct orl_lit_specular_class classes[ORL_LIT_KINDS];
    size_t lights;
};

void orl_lit_specular_find(const struct orl_plan_survey *survey, struct orl_lit_specular *ret_lit);

/*
 * The planner's decisions, by kind. Each function reads the survey, decides on its effects, and
 * removes skipped parts from the lit scene being built. Later functions see the reduced lit scene:
 * a lamp left out lights no mirror.
 *
 * Every decision goes through orl_decision_fill, which combines the need of the scene with the
 * job's override.
 */

/* Result of examining the scene for an effect. */
struct orl_finding {
    bool needed;
    enum orl_bound_unit unit;
    double bound;   /* effect of skipping it */
    double saved_s; /* estimated time saved by skipping it */
};

/*
 * Fills the decision, whose override is already set. format: the reason, one sentence without its
 * full stop. Returns true if the effect is simulated.
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

/*
 * The plan of a job: its technique, and which effects of light it simulates, each with its reason.
 *
 * Before photons are traced the planner (core/plan) looks at the scene, the request and a pilot,
 * and decides for each effect whether the job calls for it. A job may force an effect or skip it;
 * what is left on auto is skipped only where a bound says that it does not matter. The plan is a
 * function of job and scene alone, but for the seconds in it, which are estimates.
 */
#ifndef ORIEL_PLAN_H
#define ORIEL_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum orl_technique {
    ORL_TECHNIQUE_AUTO,        /* the planner's choice of those below */
    ORL_TECHNIQUE_BACKWARD,    /* unbiased, no maps, no density: the yardstick */
    ORL_TECHNIQUE_GATHER,      /* global photons seen through one final gather; caustics directly */
    ORL_TECHNIQUE_DIRECT,      /* global photons seen directly, bias-compensated */
    ORL_TECHNIQUE_PRECOMPUTED, /* irradiance precomputed at a fraction of the photons */
    ORL_TECHNIQUE_COUNT
};
const char *orl_technique_name(enum orl_technique technique); /* "auto", "backward", ... */

enum orl_effect {
    ORL_EFFECT_SUN,             /* suns, straight or through panes */
    ORL_EFFECT_SKY,             /* skies, grounds and other wide distant lights */
    ORL_EFFECT_EXTERIOR,        /* light that surfaces outside reflect before it comes in */
    ORL_EFFECT_CAUSTICS_MIRROR, /* suns and lamps by way of mirrors and dielectrics */
    ORL_EFFECT_CAUSTICS_BSDF,   /* by way of lobes: BSDFs, rough metal, trans */
    ORL_EFFECT_CAUSTICS_GLASS,  /* straight through panes: exact by shadow rays, never by photons */
    ORL_EFFECT_INTERREFLECTION, /* between diffuse surfaces, and how many times */
    ORL_EFFECT_GLOSSY,       /* glossy reflection by surfaces; folded into diffuse when skipped */
    ORL_EFFECT_COLOR,        /* three channels, or one */
    ORL_EFFECT_MEDIA,        /* absorption on the way through dielectrics */
    ORL_EFFECT_REFRACTION,   /* solid dielectrics */
    ORL_EFFECT_LAMPS,        /* local emitters */
    ORL_EFFECT_GLARE,        /* glare metrics */
    ORL_EFFECT_BINS,         /* contributions told apart by sky patch or sun */
    ORL_EFFECT_FINAL_GATHER, /* rays to the photon map instead of the map itself */
    ORL_EFFECT_PORTS,        /* which windows send photons */
    ORL_EFFECT_SUNS,         /* which suns do */
    ORL_EFFECT_COUNT
};
const char *orl_effect_name(enum orl_effect effect); /* "sun", "caustics_mirror", ... */

/* What a job says of an effect. */
enum orl_wish { ORL_WISH_AUTO, ORL_WISH_FORCE, ORL_WISH_SKIP, ORL_WISH_COUNT };
const char *orl_wish_name(enum orl_wish wish); /* "auto", "force", "skip" */

enum orl_bound_unit { ORL_BOUND_NONE, ORL_BOUND_LX, ORL_BOUND_RELATIVE };

enum { ORL_WHY_MAX = 240, ORL_ALL_REFLECTIONS = UINT16_MAX };

struct orl_decision {
    bool simulated;
    enum orl_wish wish;    /* the job's, as it was given */
    char why[ORL_WHY_MAX]; /* one sentence, with the number that decided */
    enum orl_bound_unit unit;
    double bound;   /* what skipping costs any sensor or pixel at most; 0: nothing at all */
    double saved_s; /* estimated, of one thread; 0 when simulated */
    double cost_s;  /* likewise, of what is simulated; 0 when left out */
};

/* What the photons of a plan will take, from a pilot of them. */
struct orl_foresight {
    bool made;               /* false: nobody asked */
    bool known;              /* false: too few photons came of the pilot to tell */
    double emitted[2];       /* global, caustic; NaN: not known */
    double seconds[2];       /* of the crew that made the plan; NaN likewise. Estimates */
    double photons_s;        /* of both */
    double ray_s;            /* of one of the photons' rays; 0: there was no clock */
    double job_s;            /* the whole of it, from its start; NaN: not known */
    double caustic_share;    /* of all light */
    uint64_t enough_caustic; /* photons that are worth their time, whatever the job asks for */
    char why[ORL_WHY_MAX];
};

struct orl_plan {
    enum orl_technique technique; /* never AUTO in a plan that was made */
    char technique_why[ORL_WHY_MAX];
    /* The technique of the sensors. It differs from the technique above, which is then the views',
     * only if the job has both and leaves the technique to the planner. */
    enum orl_technique sensor_technique;
    char sensor_why[ORL_WHY_MAX];
    struct orl_decision effects[ORL_EFFECT_COUNT];
    uint32_t most_reflections; /* diffuse ones that light is followed through; or ORL_ALL_... */
    uint32_t channels;         /* 3, or 1 where all is gray */
    uint32_t paths; /* the classes of paths that the scene has (paths.h), as 1 << class */
    uint64_t photons_global, photons_caustic; /* targets; 0: no such map */
    struct orl_foresight foresight;
};

#endif

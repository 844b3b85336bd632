/*
 * Plan of a job: its technique, and the effects of light that it simulates, each with its reason.
 *
 * Before photons are traced, the planner (core/plan) examines the scene, the request and a pilot
 * run. It decides for each effect whether the job needs it. A job may force an effect or skip it.
 * An effect on auto is skipped only if a bound shows that it does not matter. The plan is a
 * function of job and scene alone, except for its estimated seconds.
 */
#ifndef ORIEL_JOB_PLAN_H
#define ORIEL_JOB_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum orl_technique {
    ORL_TECHNIQUE_AUTO,     /* chosen by the planner from those below */
    ORL_TECHNIQUE_BACKWARD, /* unbiased, without photon maps or density estimation: the reference */
    ORL_TECHNIQUE_GATHER,   /* global photons by one final gather; caustics by density */
    ORL_TECHNIQUE_DIRECT,   /* global photons by density, bias-compensated */
    ORL_TECHNIQUE_PRECOMPUTED, /* irradiance precomputed at a fraction of the photons */
    ORL_TECHNIQUE_COUNT
};
const char *orl_technique_name(enum orl_technique technique); /* "auto", "backward", ... */

enum orl_effect {
    ORL_EFFECT_SUN,             /* suns, directly or through panes */
    ORL_EFFECT_SKY,             /* sky, ground and other wide distant sources */
    ORL_EFFECT_EXTERIOR,        /* light reflected by outdoor surfaces before it enters */
    ORL_EFFECT_CAUSTICS_MIRROR, /* suns and lamps by mirrors and dielectrics */
    ORL_EFFECT_CAUSTICS_BSDF,   /* suns and lamps by lobes: BSDFs, rough metal, trans */
    ORL_EFFECT_CAUSTICS_GLASS,  /* straight through panes: exact by shadow rays, never by photons */
    ORL_EFFECT_INTERREFLECTION, /* diffuse interreflection, and its number of bounces */
    ORL_EFFECT_GLOSSY,          /* glossy reflection; treated as diffuse when skipped */
    ORL_EFFECT_COLOR,           /* three channels, or one */
    ORL_EFFECT_MEDIA,           /* absorption within dielectrics */
    ORL_EFFECT_REFRACTION,      /* solid dielectrics */
    ORL_EFFECT_LAMPS,           /* local emitters */
    ORL_EFFECT_GLARE,           /* glare metrics */
    ORL_EFFECT_BINS,            /* contributions separated by sky patch or sun */
    ORL_EFFECT_FINAL_GATHER,    /* final gather instead of the map's density */
    ORL_EFFECT_PORTS,           /* selection of windows that emit photons */
    ORL_EFFECT_SUNS,            /* selection of suns that emit photons */
    ORL_EFFECT_COUNT
};
const char *orl_effect_name(enum orl_effect effect); /* "sun", "caustics_mirror", ... */

/* A job's override for an effect. */
enum orl_effect_override {
    ORL_OVERRIDE_AUTO,
    ORL_OVERRIDE_FORCE,
    ORL_OVERRIDE_SKIP,
    ORL_OVERRIDE_COUNT
};
const char *
orl_effect_override_name(enum orl_effect_override override); /* "auto", "force", "skip" */

enum orl_bound_unit { ORL_BOUND_NONE, ORL_BOUND_LX, ORL_BOUND_RELATIVE };

enum { ORL_WHY_MAX = 240, ORL_ALL_REFLECTIONS = UINT16_MAX };

struct orl_decision {
    bool simulated;
    enum orl_effect_override override; /* the job's override */
    char why[ORL_WHY_MAX];             /* one sentence, with the decisive number */
    enum orl_bound_unit unit;
    double bound;   /* largest effect of skipping on any sensor or pixel; 0: none */
    double saved_s; /* estimated single-thread seconds saved; 0 if simulated */
    double cost_s;  /* estimated single-thread seconds spent; 0 if skipped */
};

/* Predicted cost of a plan's photons, from a pilot. */
struct orl_photon_forecast {
    bool made;            /* false: no prediction requested */
    bool known;           /* false: too few pilot photons for a prediction */
    double emitted[2];    /* global, caustic; NaN: not known */
    double seconds[2];    /* estimated seconds for the threads that made the plan; NaN: not known */
    double photons_s;     /* sum for both kinds */
    double ray_s;         /* per ray of the photons; 0: there was no clock */
    double job_s;         /* whole job, from its start; NaN: not known */
    double caustic_share; /* caustics' share of the light */
    uint64_t enough_caustic; /* number of caustic photons beyond which more do not pay off,
                                independent of the job's targets */
    char why[ORL_WHY_MAX];
};

struct orl_plan {
    enum orl_technique technique; /* never AUTO in a complete plan */
    char technique_why[ORL_WHY_MAX];
    /* Technique of the sensors. It differs from `technique`, which is then that of the views, only
     * if the job has both and leaves the technique to the planner. */
    enum orl_technique sensor_technique;
    char sensor_why[ORL_WHY_MAX];
    struct orl_decision effects[ORL_EFFECT_COUNT];
    uint32_t most_reflections; /* largest number of diffuse reflections followed; or
                                  ORL_ALL_REFLECTIONS */
    uint32_t channels;         /* 3, or 1 if all is gray */
    uint32_t paths;            /* path classes of the scene (paths.h), bits 1 << class */
    uint64_t photons_global, photons_caustic; /* targets; 0: no such map */
    struct orl_photon_forecast forecast;
};

#endif

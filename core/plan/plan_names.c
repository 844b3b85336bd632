#include <oriel/job/plan.h>

const char *orl_technique_name(enum orl_technique technique)
{
    static const char *const names[ORL_TECHNIQUE_COUNT] = {"auto", "backward", "gather", "direct",
                                                           "precomputed"};
    return technique < ORL_TECHNIQUE_COUNT ? names[technique] : "unknown";
}

const char *orl_effect_name(enum orl_effect effect)
{
    static const char *const names[ORL_EFFECT_COUNT] = {
        "sun",
        "sky",
        "exterior",
        "caustics_mirror",
        "caustics_bsdf",
        "caustics_glass",
        "interreflection",
        "glossy",
        "color",
        "media",
        "refraction",
        "lamps",
        "glare",
        "bins",
        "final_gather",
        "ports",
        "suns",
    };
    return effect < ORL_EFFECT_COUNT ? names[effect] : "unknown";
}

const char *orl_effect_override_name(enum orl_effect_override override)
{
    static const char *const names[ORL_OVERRIDE_COUNT] = {"auto", "force", "skip"};
    return override < ORL_OVERRIDE_COUNT ? names[override] : "unknown";
}

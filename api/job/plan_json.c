#include "job/job_members_json.h"

#include <stdbool.h>

#include <oriel/job/paths.h>

#include "schemas.h"
#include "json/encode.h"

static bool in_group(int effect)
{
    return effect == ORL_EFFECT_CAUSTICS_MIRROR || effect == ORL_EFFECT_CAUSTICS_BSDF ||
           effect == ORL_EFFECT_CAUSTICS_GLASS;
}

int orl_technique_from_json(const json_t *value, const char *path,
                            const struct orl_json_schema *schema, enum orl_technique first,
                            enum orl_technique *ret_technique, struct orl_error *err)
{
    enum orl_technique place;
    const int rc = orl_json_word(value, path, schema->words, &place, err);
    if (rc == 0)
        *ret_technique = first + place;
    return rc;
}

/* An effect named by itself overrides its group, in any order. */
int orl_effect_overrides_from_json(const json_t *effects, const char *path, void *into,
                                   struct orl_error *err)
{
    enum orl_effect_override *overrides = into, group = ORL_OVERRIDE_COUNT, own[ORL_EFFECT_COUNT];
    struct orl_json_member members[ORL_EFFECT_COUNT + 2] = {{"caustics", .word = &group}};
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        own[i] = ORL_OVERRIDE_COUNT;
        members[i + 1] =
            (struct orl_json_member){orl_effect_name((enum orl_effect)i), .word = &own[i]};
    }
    const int rc = orl_json_members(effects, path, &orl_schema_wishes, members, err);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        const enum orl_effect_override override =
            own[i] == ORL_OVERRIDE_COUNT && in_group(i) ? group : own[i];
        if (override != ORL_OVERRIDE_COUNT)
            overrides[i] = override;
    }
    return rc;
}

/* Returns NULL if there is no bound. */
static const char *unit_name(enum orl_bound_unit unit)
{
    return unit == ORL_BOUND_LX ? "lx" : unit == ORL_BOUND_RELATIVE ? "relative" : NULL;
}

static json_t *decision_to_json(enum orl_effect effect, const struct orl_decision *decision)
{
    const char *unit = unit_name(decision->unit);
    json_t *bound =
        unit ? json_pack("{s:o, s:s}", "value", orl_json_from_real(decision->bound), "unit", unit)
             : json_null();
    return json_pack(
        "{s:s, s:b, s:s, s:o, s:o, s:o, s:o}", "effect", orl_effect_name(effect), "simulated",
        (int)decision->simulated, "wish", orl_effect_override_name(decision->override), "why",
        orl_json_from_text(decision->why), "bound", bound, "saved_s",
        orl_json_from_real(decision->saved_s), "cost_s", orl_json_from_real(decision->cost_s));
}

static json_t *decisions_to_json(const struct orl_plan *plan)
{
    json_t *effects = json_array();
    for (int i = 0; i < ORL_EFFECT_COUNT && effects; i++) {
        json_t *effect = decision_to_json((enum orl_effect)i, &plan->effects[i]);
        effects = orl_json_append(effects, effect);
    }
    return effects;
}

/* Encodes what a pilot of photons predicts for the photon maps. */
static json_t *forecast_to_json(const struct orl_photon_forecast *f)
{
    return json_pack(
        "{s:s, s:b, s:{s:o, s:o}, s:{s:o, s:o}, s:o, s:o, s:I}", "why", f->why, "known",
        (int)f->known, "emitted", "global", orl_json_from_real(f->emitted[0]), "caustic",
        orl_json_from_real(f->emitted[1]), "seconds", "global", orl_json_from_real(f->seconds[0]),
        "caustic", orl_json_from_real(f->seconds[1]), "photons_s", orl_json_from_real(f->photons_s),
        "job_s", orl_json_from_real(f->job_s), "enough_caustic", (json_int_t)f->enough_caustic);
}

static json_t *strategies_to_json(unsigned strategies)
{
    json_t *names = json_array();
    for (unsigned i = 0; i < ORL_PATH_STRATEGIES; i++)
        if (strategies & 1U << i)
            json_array_append_new(
                names, json_string(orl_path_strategy_name((enum orl_path_strategy)(1U << i))));
    return names;
}

/* Encodes the classes of paths in the scene, and the strategies that sample each. */
static json_t *paths_to_json(const struct orl_plan *plan)
{
    json_t *list = json_array();
    for (int i = 0; i < ORL_PATH_CLASSES; i++) {
        const enum orl_path_class class = (enum orl_path_class)i;
        if (!(plan->paths & 1U << i))
            continue;
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:o, s:o}", "class", orl_path_class_name(class), "light",
                            orl_path_class_words(class), "in_air",
                            strategies_to_json(orl_path_strategies(plan->sensor_technique, class,
                                                                   ORL_RECEIVER_AIR)),
                            "on_surfaces",
                            strategies_to_json(orl_path_strategies(plan->technique, class,
                                                                   ORL_RECEIVER_SURFACE))));
    }
    return list;
}

json_t *orl_plan_to_json(const struct orl_plan *plan)
{
    if (plan->technique == ORL_TECHNIQUE_AUTO)
        return json_null();
    json_t *reflections = plan->most_reflections == ORL_ALL_REFLECTIONS
                              ? json_null()
                              : json_integer((json_int_t)plan->most_reflections);
    json_t *sensors =
        plan->sensor_technique != plan->technique
            ? json_pack("{s:s, s:o}", "technique", orl_technique_name(plan->sensor_technique),
                        "why", orl_json_from_text(plan->sensor_why))
            : NULL;
    json_t *forecast = plan->forecast.made ? forecast_to_json(&plan->forecast) : NULL;
    return json_pack("{s:s, s:o, s:o*, s:o, s:I, s:{s:I, s:I}, s:o, s:o, s:o*}", "technique",
                     orl_technique_name(plan->technique), "why",
                     orl_json_from_text(plan->technique_why), "sensors", sensors,
                     "most_reflections", reflections, "channels", (json_int_t)plan->channels,
                     "photons", "global", (json_int_t)plan->photons_global, "caustic",
                     (json_int_t)plan->photons_caustic, "paths", paths_to_json(plan), "effects",
                     decisions_to_json(plan), "foresight", forecast);
}

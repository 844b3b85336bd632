/* Effect overrides in job documents, and plans in result documents. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "job/job_json.h"
#include "job/job_members_json.h"
#include "json/decode.h"

#define ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

/* Decodes a job document with these "effects" (text of an object). */
static int decode(const char *effects, struct orl_job *job, struct orl_error *err)
{
    char text[2048], *id = NULL;
    json_t *doc = NULL;
    snprintf(text, sizeof text, "{\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,1]],\"effects\":%s}",
             effects);
    int rc = orl_json_parse("job.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_job_from_json(doc, ORL_JOB_REMOTE, job, &id, err);
    json_decref(doc);
    free(id);
    return rc;
}

/* Decodes valid effects and frees the job. */
static void wishes_of(const char *effects, enum orl_effect_override ret_wishes[ORL_EFFECT_COUNT])
{
    struct orl_job job;
    struct orl_error err = {0};
    if (decode(effects, &job, &err) < 0)
        fail_msg("%s: %s", effects, err.message);
    memcpy(ret_wishes, job.overrides, sizeof job.overrides);
    orl_job_done(&job);
}

static void test_every_effect_by_its_name(void **state)
{
    (void)state;
    for (int effect = 0; effect < ORL_EFFECT_COUNT; effect++)
        for (int override = 0; override < ORL_OVERRIDE_COUNT; override++) {
            enum orl_effect_override overrides[ORL_EFFECT_COUNT];
            char text[128];
            snprintf(text, sizeof text, "{\"%s\":\"%s\"}", orl_effect_name((enum orl_effect)effect),
                     orl_effect_override_name((enum orl_effect_override) override));
            wishes_of(text, overrides);
            for (int other = 0; other < ORL_EFFECT_COUNT; other++)
                assert_int_equal(overrides[other], other == effect ? override : ORL_OVERRIDE_AUTO);
        }
}

static void test_caustics_stands_for_three(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum orl_effect_override mirror, bsdf, glass;
    } cases[] = {
        {"{\"caustics\":\"skip\"}", ORL_OVERRIDE_SKIP, ORL_OVERRIDE_SKIP, ORL_OVERRIDE_SKIP},
        {"{\"caustics\":\"force\"}", ORL_OVERRIDE_FORCE, ORL_OVERRIDE_FORCE, ORL_OVERRIDE_FORCE},
        /* The specific member wins, first or last, with any value. */
        {"{\"caustics\":\"skip\",\"caustics_bsdf\":\"force\"}", ORL_OVERRIDE_SKIP,
         ORL_OVERRIDE_FORCE, ORL_OVERRIDE_SKIP},
        {"{\"caustics_bsdf\":\"force\",\"caustics\":\"skip\"}", ORL_OVERRIDE_SKIP,
         ORL_OVERRIDE_FORCE, ORL_OVERRIDE_SKIP},
        {"{\"caustics_mirror\":\"auto\",\"caustics\":\"skip\"}", ORL_OVERRIDE_AUTO,
         ORL_OVERRIDE_SKIP, ORL_OVERRIDE_SKIP},
        {"{\"caustics\":\"auto\",\"caustics_glass\":\"skip\"}", ORL_OVERRIDE_AUTO,
         ORL_OVERRIDE_AUTO, ORL_OVERRIDE_SKIP},
        {"{}", ORL_OVERRIDE_AUTO, ORL_OVERRIDE_AUTO, ORL_OVERRIDE_AUTO},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        enum orl_effect_override overrides[ORL_EFFECT_COUNT];
        wishes_of(cases[i].text, overrides);
        assert_int_equal(overrides[ORL_EFFECT_CAUSTICS_MIRROR], cases[i].mirror);
        assert_int_equal(overrides[ORL_EFFECT_CAUSTICS_BSDF], cases[i].bsdf);
        assert_int_equal(overrides[ORL_EFFECT_CAUSTICS_GLASS], cases[i].glass);
        assert_int_equal(overrides[ORL_EFFECT_SUN], ORL_OVERRIDE_AUTO);
    }
}

static void test_mistakes_say_what_is_wanted(void **state)
{
    (void)state;
    static const struct {
        const char *text, *path, *says, *hint;
    } cases[] = {
        {"{\"caustic\":\"skip\"}", "effects.caustic", "no such member", "caustics, sun, sky, "},
        {"{\"\":\"skip\"}", "effects.", "no such member", ", suns"},
        {"{\"sun\":\"never\"}", "effects.sun", "\"auto\", \"force\" or \"skip\"", ""},
        {"{\"sun\":false}", "effects.sun", "\"auto\", \"force\" or \"skip\"", ""},
        {"{\"caustics\":\"Skip\"}", "effects.caustics", "\"auto\", \"force\" or \"skip\"", ""},
        {"{\"caustics\":null}", "effects.caustics", "\"auto\", \"force\" or \"skip\"", ""},
        {"[\"sun\"]", "effects", "an object is expected", ""},
        {"\"skip\"", "effects", "an object is expected", ""},
        {"null", "effects", "an object is expected", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_job job;
        struct orl_error err = {0};
        assert_int_equal(decode(cases[i].text, &job, &err), ORL_ERR_INVALID);
        assert_string_equal(err.primitive, cases[i].path);
        if (!strstr(err.message, cases[i].says) || !strstr(err.hint, cases[i].hint))
            fail_msg("%s: \"%s\" (%s)", cases[i].text, err.message, err.hint);
    }
}

/* The hint for a misspelt effect lists all names without truncation. */
static void test_the_hint_holds_every_name(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err = {0};
    assert_int_equal(decode("{\"sunn\":\"skip\"}", &job, &err), ORL_ERR_INVALID);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        assert_non_null(strstr(err.hint, orl_effect_name((enum orl_effect)i)));
}

/* Returns a plan in which no two members are equal. */
static struct orl_plan example(void)
{
    struct orl_plan plan = {.technique = ORL_TECHNIQUE_PRECOMPUTED,
                            .technique_why = "2 views of 240000 pixels",
                            .sensor_technique = ORL_TECHNIQUE_BACKWARD,
                            .sensor_why = "5 sensors",
                            .most_reflections = 7,
                            .channels = 1,
                            .photons_global = 3000000000,
                            .photons_caustic = 5};
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        struct orl_decision *d = &plan.effects[i];
        d->simulated = i % 2 == 0;
        d->override = (enum orl_effect_override)(i % ORL_OVERRIDE_COUNT);
        d->unit = (enum orl_bound_unit)(i % 3);
        d->bound = 0.5 + i;
        d->saved_s = 0.25 * i;
        d->cost_s = 0.5 * i;
        snprintf(d->why, sizeof d->why, "because of %d", i);
    }
    return plan;
}

/* Returns the plan written as JSON and parsed again. */
static json_t *written_and_read(const struct orl_plan *plan)
{
    json_t *made = orl_plan_to_json(plan);
    assert_non_null(made);
    char *text = json_dumps(made, JSON_COMPACT);
    assert_non_null(text);
    json_t *read = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    assert_true(json_equal(made, read));
    free(text);
    json_decref(made);
    return read;
}

static void check_decision(const json_t *told, enum orl_effect effect,
                           const struct orl_decision *decision)
{
    static const char *const units[] = {NULL, "lx", "relative"};
    const json_t *bound = json_object_get(told, "bound");
    assert_int_equal(json_object_size(told), 7);
    assert_string_equal(json_string_value(json_object_get(told, "effect")),
                        orl_effect_name(effect));
    assert_int_equal(json_is_true(json_object_get(told, "simulated")), decision->simulated);
    assert_string_equal(json_string_value(json_object_get(told, "wish")),
                        orl_effect_override_name(decision->override));
    assert_string_equal(json_string_value(json_object_get(told, "why")), decision->why);
    assert_true(json_number_value(json_object_get(told, "saved_s")) == decision->saved_s);
    assert_true(json_number_value(json_object_get(told, "cost_s")) == decision->cost_s);
    assert_int_equal(json_is_null(bound), decision->unit == ORL_BOUND_NONE);
    if (decision->unit == ORL_BOUND_NONE)
        return;
    assert_true(json_number_value(json_object_get(bound, "value")) == decision->bound);
    assert_string_equal(json_string_value(json_object_get(bound, "unit")), units[decision->unit]);
}

static void test_a_plan_is_told_whole(void **state)
{
    (void)state;
    const struct orl_plan plan = example();
    json_t *doc = written_and_read(&plan);
    const json_t *photons = json_object_get(doc, "photons");
    const json_t *effects = json_object_get(doc, "effects");
    const json_t *sensors = json_object_get(doc, "sensors");
    assert_int_equal(json_object_size(doc), 8);
    assert_string_equal(json_string_value(json_object_get(sensors, "technique")), "backward");
    assert_string_equal(json_string_value(json_object_get(sensors, "why")), "5 sensors");
    assert_string_equal(json_string_value(json_object_get(doc, "technique")), "precomputed");
    assert_string_equal(json_string_value(json_object_get(doc, "why")), plan.technique_why);
    assert_int_equal(json_integer_value(json_object_get(doc, "most_reflections")), 7);
    assert_int_equal(json_integer_value(json_object_get(doc, "channels")), 1);
    assert_int_equal(json_integer_value(json_object_get(photons, "global")), 3000000000);
    assert_int_equal(json_integer_value(json_object_get(photons, "caustic")), 5);
    assert_int_equal(json_array_size(effects), ORL_EFFECT_COUNT);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        check_decision(json_array_get(effects, (size_t)i), (enum orl_effect)i, &plan.effects[i]);
    json_decref(doc);
}

/* Values that JSON cannot express: unlimited reflections, an infinite bound, a name in Latin-1. */
static void test_what_json_cannot_say(void **state)
{
    (void)state;
    struct orl_plan plan = example();
    plan.most_reflections = ORL_ALL_REFLECTIONS;
    plan.effects[ORL_EFFECT_SKY].unit = ORL_BOUND_LX;
    plan.effects[ORL_EFFECT_SKY].bound = INFINITY;
    plan.effects[ORL_EFFECT_SKY].saved_s = NAN;
    strcpy(plan.effects[ORL_EFFECT_SKY].why, "glass 'stra\xdf\x65' lets 9 lx through");
    json_t *doc = written_and_read(&plan);
    const json_t *sky = json_array_get(json_object_get(doc, "effects"), ORL_EFFECT_SKY);
    const json_t *bound = json_object_get(sky, "bound");
    assert_true(json_is_null(json_object_get(doc, "most_reflections")));
    assert_true(json_is_null(json_object_get(bound, "value")));
    assert_string_equal(json_string_value(json_object_get(bound, "unit")), "lx");
    assert_true(json_is_null(json_object_get(sky, "saved_s")));
    assert_string_equal(json_string_value(json_object_get(sky, "why")),
                        "glass 'stra?e' lets 9 lx through");
    json_decref(doc);
}

static void test_no_plan_is_null(void **state)
{
    (void)state;
    const struct orl_plan none = {0};
    json_t *doc = orl_plan_to_json(&none);
    assert_true(json_is_null(doc));
    json_decref(doc);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_effect_by_its_name),
        cmocka_unit_test(test_caustics_stands_for_three),
        cmocka_unit_test(test_mistakes_say_what_is_wanted),
        cmocka_unit_test(test_the_hint_holds_every_name),
        cmocka_unit_test(test_a_plan_is_told_whole),
        cmocka_unit_test(test_what_json_cannot_say),
        cmocka_unit_test(test_no_plan_is_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/*
 * Decoders of jobs accept and refuse what api/schema says: documents at, below and above each
 * bound, with each word, and with a member too many or too few (tests/schema/documents.py makes
 * them).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "job/job_members_json.h"
#include "job/job_request_json.h"
#include "schemas.h"
#include "json/decode.h"

/* Decodes and checks a document as the daemon does. */
static int decode(const char *text, struct orl_error *err)
{
    struct orl_job_request job_request;
    char *scene_id = NULL;
    json_t *doc = NULL;
    int rc = orl_json_parse(NULL, text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_job_request_from_json(doc, ORL_JOB_REMOTE, &job_request, &scene_id, err);
    if (rc == 0)
        orl_job_request_done(&job_request);
    free(scene_id);
    json_decref(doc);
    return rc;
}

enum relation { ELSEWHERE, AROUND, SAME, INSIDE };

/* Compares the path of an error, such as "views[0].width", with a place, "views.0.width". An error
 * may be about the place, about a value around it, or about one inside. */
static enum relation relate(const struct orl_error *err, const char *place)
{
    const char *at = err->primitive;
    for (; *at && *place; at++) {
        if (*at == ']')
            continue;
        if (*at != *place && !(*at == '[' && *place == '.'))
            return ELSEWHERE;
        place++;
    }
    at += *at == ']';
    return *place ? AROUND : *at ? INSIDE : SAME;
}

static bool is_as_expected(const char *verdict, const char *place, int rc,
                           const struct orl_error *err)
{
    if (strcmp(verdict, "accept") == 0)
        return rc == 0;
    if (strcmp(verdict, "refuse") == 0)
        return rc != 0 && rc != ORL_ERR_INTERNAL && relate(err, place) != ELSEWHERE;
    /* At a bound: other rules may refuse the value, but not as one that is out of bounds. */
    return rc == 0 || (rc != ORL_ERR_INTERNAL && !(relate(err, place) == SAME &&
                                                   (rc == ORL_ERR_RANGE || rc == ORL_ERR_LIMIT)));
}

static void test_described_documents(void **state)
{
    (void)state;
    /* Debian's own Python, which has python3-yaml. */
    FILE *documents =
        popen("PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tests/schema/documents.py", "r");
    assert_non_null(documents);
    char *line = NULL, *rest;
    size_t size = 0, counts[2] = {0}, faults = 0;
    while (getline(&line, &size, documents) > 0) {
        struct orl_error err = {0};
        const char *verdict = strtok_r(line, "\t", &rest);
        const char *place = *rest == '\t' ? "" : strtok_r(NULL, "\t", &rest);
        const char *text = strtok_r(NULL, "\t\n", &rest);
        assert_non_null(text);
        const int rc = decode(text, &err);
        counts[rc != 0]++;
        if (is_as_expected(verdict, place, rc, &err))
            continue;
        print_message("# %s '%s': %d, %s (at '%s'): %.300s\n", verdict, place, rc, err.message,
                      err.primitive, text);
        faults++;
    }
    free(line);
    assert_int_equal(pclose(documents), 0);
    print_message("# %zu documents are accepted, %zu refused\n", counts[0], counts[1]);
    assert_true(counts[0] > 200 && counts[1] > 500);
    assert_int_equal(faults, 0);
}

static void assert_words(const char *const *words, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        assert_string_equal(words[i], names[i]);
    assert_null(words[count]);
}

/* Words stand in the order of the enumeration of C, for a decoder takes their index. */
static void test_words_are_the_core_s(void **state)
{
    (void)state;
    const char *names[ORL_EFFECT_COUNT + 1];
    for (int i = 0; i < ORL_TECHNIQUE_COUNT; i++)
        names[i] = orl_technique_name((enum orl_technique)i);
    assert_words(orl_schema_job_request_technique.words, names, ORL_TECHNIQUE_COUNT);
    assert_words(orl_schema_study_technique.words, names + 1, ORL_TECHNIQUE_COUNT - 1);
    for (int i = 0; i < ORL_OVERRIDE_COUNT; i++)
        names[i] = orl_effect_override_name((enum orl_effect_override)i);
    assert_words(orl_schema_wish.words, names, ORL_OVERRIDE_COUNT);
    for (int i = 0; i < ORL_PALETTES; i++)
        names[i] = orl_palette_name((enum orl_palette)i);
    assert_words(orl_schema_palette.words, names, ORL_PALETTES);
    for (int i = 0; i < ORL_BSDF_BASES; i++)
        names[i] = orl_bsdf_basis_name((enum orl_bsdf_basis)i);
    assert_words(orl_schema_bsdf_basis.words, names, ORL_BSDF_BASES);
    for (int i = 0; i < ORL_BSDF_FIT_SYMMETRIES; i++)
        names[i] = orl_bsdf_fit_symmetry_name((enum orl_bsdf_fit_symmetry)i);
    assert_words(orl_schema_bsdf_fit_request_symmetry.words, names, ORL_BSDF_FIT_SYMMETRIES);
    for (int i = 0; i < 2; i++)
        names[i] = orl_tone_name((enum orl_tone)i);
    assert_words(orl_schema_display_tone.words, names, 2);
}

static void assert_preset(const char *name, const struct orl_json_schema *schema, double actual)
{
    if (!schema->has_preset || schema->preset != actual)
        fail_msg("%s: %g is described, and %g used", name, schema->preset, actual);
}

#define PRESET(schema, value) assert_preset(#schema, &orl_schema_##schema, (double)(value))

/* Defaults of the core are those that the description states. */
static void test_defaults_of_renders_and_studies(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_sky_request sky;
    struct orl_study_request study;
    orl_job_init(&job);
    orl_sky_request_init(&sky);
    orl_study_request_init(&study);
    PRESET(job_request_technique, job.technique);
    PRESET(job_request_seed, job.seed);
    PRESET(job_request_dark, job.dark_expected);
    PRESET(goal_at, job.goal.at);
    PRESET(photons_exact, job.photons_exact);
    PRESET(priority, ORL_PRIORITY_DEFAULT);
    PRESET(ground_reflectance, sky.ground_reflectance);
    PRESET(cie_sky_turbidity, sky.turbidity);
    PRESET(normalisation, sky.normalise);
    PRESET(sun_method, sky.sun_method);
    PRESET(study_request_repeats, study.repeats);
    PRESET(study_request_seed, study.job.seed);
    PRESET(study_reference_runs, study.reference_runs);
    orl_job_done(&job);
    orl_study_request_done(&study);
}

static void test_defaults_of_years_and_bsdfs(void **state)
{
    (void)state;
    struct orl_annual_request year;
    struct orl_report_request report;
    struct orl_bsdf_make_request panel;
    struct orl_bsdf_fit_request sample;
    orl_annual_request_init(&year);
    assert_int_equal(orl_report_request_init(&report), 0);
    orl_bsdf_make_request_init(&panel);
    orl_bsdf_fit_request_init(&sample);
    PRESET(annual_request_north, year.north_deg);
    PRESET(annual_request_seed, year.seed);
    PRESET(annual_request_sun_halvings, year.sun_halvings);
    PRESET(annual_request_technique, year.technique);
    PRESET(ground_reflectance, year.ground_reflectance);
    PRESET(occupancy_from, report.occupancy.from_h);
    PRESET(occupancy_to, report.occupancy.to_h);
    PRESET(sun_exposure_least_altitude, report.exposure.least_altitude_deg);
    PRESET(bsdf_make_request_seed, panel.seed);
    PRESET(bsdf_make_request_paths_most, panel.paths_most);
    PRESET(bsdf_make_request_symmetry, panel.symmetry);
    PRESET(bsdf_make_request_color, panel.color);
    PRESET(bsdf_resolution, panel.resolution);
    PRESET(bsdf_resolution, sample.resolution);
    PRESET(bsdf_fit_request_grazing, sample.grazing_deg);
    PRESET(bsdf_fit_request_symmetry, sample.symmetry);
    orl_annual_request_done(&year);
    orl_report_request_done(&report);
    orl_bsdf_make_request_done(&panel);
    orl_bsdf_fit_request_done(&sample);
}

/* Pages of the guide are those that the description gives: `make reference` writes them. */
static void test_reference_is_current(void **state)
{
    (void)state;
    assert_int_equal(system("set -e; new=$(mktemp -d); trap 'rm -rf \"$new\"' EXIT; "
                            "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 api/schema/describe.py "
                            "reference \"$new\"; "
                            "diff -r \"$new\" client/guide/reference | head -20 >&2; "
                            "diff -qr \"$new\" client/guide/reference >/dev/null"),
                     0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_described_documents),
        cmocka_unit_test(test_words_are_the_core_s),
        cmocka_unit_test(test_defaults_of_renders_and_studies),
        cmocka_unit_test(test_defaults_of_years_and_bsdfs),
        cmocka_unit_test(test_reference_is_current),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

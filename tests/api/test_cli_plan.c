/* `oriel plan` from a script's view: the table, the JSON, and that nothing is rendered. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include <oriel/job/plan.h>

#include "support/cli.h"
#include "support/extent.h"

/* A room without a roof, under a sky with a sun. */
static const char scene_text[] = "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void light beam\n0\n0\n3 1e6 1e6 1e6\n"
                                 "beam source sun\n0\n0\n4 0.3 -0.5 1 0.533\n"
                                 "void glow sky_glow\n0\n0\n4 10 10 10 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0\n"
                                 "grey polygon west\n0\n0\n12 0 0 0  0 4 0  0 4 3  0 0 3\n";

#define JOB(effects)                                                                               \
    "{\"scene\": {\"files\": [\"room.rad\"]}, \"effects\": " effects ",\n"                         \
    " \"photons\": {\"global\": 20000, \"caustic\": 0}, \"gather_samples\": 64,\n"                 \
    " \"sensors\": [[1.5, 1, 0.8, 0, 0, 1]]}\n"

static int set_up(void **state)
{
    static const struct cli_file files[] = {
        {"job.json", JOB("{}")}, {"room.rad", scene_text}, {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static void plan(struct cli_desk *f, const char *option)
{
    const char *const args[] = {"plan", f->document, option, NULL};

    cli_run(args, &f->result);
}

/* Runs with --json; returns the document, which the caller frees. */
static json_t *planned(struct cli_desk *f, const char *threads)
{
    const char *const args[] = {"plan", "--json", "--threads", threads, f->document, NULL};
    json_t *doc;

    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("exit %d: %s", f->result.exit_code, f->result.err);
    doc = json_loads(f->result.out, 0, NULL);
    assert_non_null(doc);
    return doc;
}

/* Removes the estimated seconds, the only part of a plan that may differ between two runs. */
static json_t *without_seconds(json_t *plan)
{
    json_t *effects = json_object_get(plan, "effects"), *effect;
    json_t *foresight = json_object_get(plan, "foresight");
    size_t i;

    assert_int_equal(json_array_size(effects), ORL_EFFECT_COUNT);
    json_array_foreach(effects, i, effect)
    {
        assert_int_equal(json_object_del(effect, "saved_s"), 0);
        assert_int_equal(json_object_del(effect, "cost_s"), 0);
    }
    if (foresight) {
        assert_int_equal(json_object_del(foresight, "seconds"), 0);
        assert_int_equal(json_object_del(foresight, "photons_s"), 0);
        assert_int_equal(json_object_del(foresight, "job_s"), 0);
    }
    return plan;
}

static void test_the_table_has_every_effect(void **state)
{
    struct cli_desk *f = *state;
    const char *at;

    plan(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(strncmp(f->result.out, "technique ", 10), 0);
    at = strstr(f->result.out, "\neffect ");
    assert_non_null(at);
    assert_non_null(strstr(at, "simulated"));
    /* One row each, in the order of the plan. */
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        char row[32];

        snprintf(row, sizeof row, "\n%-15s  ", orl_effect_name((enum orl_effect)i));
        at = strstr(at, row);
        if (!at)
            fail_msg("no row for %s in:\n%s", orl_effect_name((enum orl_effect)i), f->result.out);
    }
}

static void assert_narrow(char *text)
{
    char *rest;

    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
        if (strlen(line) > 100)
            fail_msg("%zu columns: %s", strlen(line), line);
}

/* Tables and warnings are wrapped, and words longer than a line are cut. */
static void test_no_line_is_too_long(void **state)
{
    struct cli_desk *f = *state;
    char name[128], job[512], scene[1024];

    memset(name, 'n', 120);
    strcpy(name + 120, ".rad");
    snprintf(scene, sizeof scene, "%svoid dielectric prism\n0\n0\n5 0.9 0.9 0.9 1.5 0.1\n",
             scene_text);
    snprintf(job, sizeof job,
             "{\"scene\": {\"files\": [\"%s\"]}, \"sensors\": [[1, 1, 1, 0, 0, 1]]}", name);
    cli_write_file(f->folder, name, scene);
    cli_write_file(f->folder, "job.json", job);
    plan(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(strncmp(f->result.err, "warning: dielectric prism at", 28), 0);
    assert_non_null(strstr(f->result.err, "nnn\n         nnn"));
    assert_non_null(strstr(f->result.err, "not simulated\n"));
    assert_narrow(f->result.out);
    assert_narrow(f->result.err);
}

/* Returns the row of an effect in the table, up to its end. */
static void row_of(const struct cli_desk *f, const char *effect, char ret_row[160])
{
    char start[32];
    const char *at;

    snprintf(start, sizeof start, "\n%s ", effect);
    at = strstr(f->result.out, start);
    assert_non_null(at);
    snprintf(ret_row, 160, "%.*s", (int)strcspn(at + 1, "\n"), at + 1);
}

static void test_wishes_show(void **state)
{
    struct cli_desk *f = *state;
    char row[160];

    cli_write_file(f->folder, "job.json",
                   JOB("{\"caustics\": \"skip\", \"caustics_bsdf\": \"auto\", \"sky\": "
                       "\"force\"}"));
    plan(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    row_of(f, "caustics_mirror", row);
    assert_non_null(strstr(row, "(skip)"));
    row_of(f, "caustics_bsdf", row);
    assert_null(strstr(row, "("));
    row_of(f, "sky", row);
    assert_non_null(strstr(row, "(force)"));
}

static void test_json_is_what_a_run_says(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"run", f->document, "-o", f->output, NULL};
    json_t *one = planned(f, "1"), *three = planned(f, "3"), *result;
    char *text;

    assert_true(json_is_array(json_object_get(one, "warnings")));
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    text = cli_read_file(f->output, "result.json");
    assert_non_null(text);
    result = json_loads(text, 0, NULL);
    free(text);
    without_seconds(json_object_get(one, "plan"));
    without_seconds(json_object_get(three, "plan"));
    without_seconds(json_object_get(result, "plan"));
    assert_true(json_equal(json_object_get(one, "plan"), json_object_get(three, "plan")));
    /* A run with given photon counts needs no pilot. */
    assert_int_equal(json_object_del(json_object_get(one, "plan"), "foresight"), 0);
    assert_true(json_equal(json_object_get(one, "plan"), json_object_get(result, "plan")));
    assert_non_null(strstr(f->result.err, "plan: "));
    json_decref(one);
    json_decref(three);
    json_decref(result);
}

/* A plan for each sky, also of a job that renders a sequence of them; JSON has one document each.
 * Paths need no pilot, which is most of a plan's time. */
static void test_skies(void **state)
{
    static const char day[] = "{\"name\": \"%s\", \"cie\": {\"type\": \"overcast\", "
                              "\"diffuse_horizontal_lx\": %d}}";
    struct cli_desk *f = *state;
    char text[1000], one[150], other[150];
    const char *second;

    cli_write_file(f->folder, "room.rad", strstr(scene_text, "grey polygon floor"));
    snprintf(one, sizeof one, day, "dull", 4000);
    snprintf(other, sizeof other, day, "bright", 20000);
    snprintf(text, sizeof text,
             "{\"scene\": {\"files\": [\"grey.mat\", \"room.rad\"]}, \"technique\": \"backward\", "
             "\"skies\": [%s, %s], "
             "\"sequence\": {}, \"views\": [{\"name\": \"v\", \"view\": \"-vp 1 1 1\", "
             "\"width\": 16, \"height\": 16}]}",
             one, other);
    cli_write_file(f->folder, "job.json", text);
    cli_write_file(f->folder, "grey.mat", "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n");
    plan(f, NULL);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_int_equal(strncmp(f->result.out, "sky dull\n\ntechnique ", 20), 0);
    second = strstr(f->result.out, "\n\nsky bright\n\ntechnique ");
    assert_non_null(second);
    plan(f, "--json");
    assert_int_equal(f->result.exit_code, 0);
    second = strstr(f->result.out, "\n}\n{\n");
    assert_non_null(second);
    assert_null(strstr(second + 3, "\n}\n{\n"));
}

/* The plan has the requested technique; without a request it selects one. */
static void test_the_technique(void **state)
{
    static const char *const techniques[] = {"backward", "gather", "direct", "precomputed"};
    struct cli_desk *f = *state;
    json_t *doc = planned(f, "1");
    const char *chosen =
        json_string_value(json_object_get(json_object_get(doc, "plan"), "technique"));

    assert_non_null(chosen);
    assert_string_not_equal(chosen, "auto");
    json_decref(doc);
    for (size_t i = 0; i < sizeof techniques / sizeof techniques[0]; i++) {
        char text[512];

        /* One more member after the document's opening brace. */
        snprintf(text, sizeof text, "{\"technique\": \"%s\", %s", techniques[i], &JOB("{}")[1]);
        cli_write_file(f->folder, "job.json", text);
        doc = planned(f, "1");
        assert_string_equal(
            json_string_value(json_object_get(json_object_get(doc, "plan"), "technique")),
            techniques[i]);
        json_decref(doc);
    }
}

/* If no accuracy can be promised the plan reports this, and is printed all the same. */
static void test_narrow_lobes(void **state)
{
    static const char lobes[] =
        "m(x,y,z) = x*(Dx + 2*RdotP*NxP) + y*(Dy + 2*RdotP*NyP) + z*(Dz + 2*RdotP*NzP);\n"
        "lobe(x,y,z,o) = if(m(x,y,z) - .9995, 100, 0);\n";
    struct cli_desk *f = *state;
    char scene[2048];

    snprintf(scene, sizeof scene,
             "%svoid metfunc gloss\n2 lobe l.cal\n0\n4 .8 .6 .4 .5\n"
             "gloss polygon east\n0\n0\n12 3 0 0  3 0 3  3 4 3  3 4 0\n",
             scene_text);
    cli_write_file(f->folder, "room.rad", scene);
    cli_write_file(f->folder, "l.cal", lobes);
    plan(f, NULL);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_non_null(strstr(f->result.out, "not known: lobes of some materials are too narrow"));
    /* Lit by a lamp, photons would be few and bright: paths evaluate the functions. */
    strcat(scene, "void light bulb\n0\n0\n3 99 99 99\nbulb sphere lamp\n0\n0\n4 1 2 2 .1\n");
    cli_write_file(f->folder, "room.rad", scene);
    cli_write_file(f->folder, "job.json", JOB("{}"));
    json_t *const doc = planned(f, "1");
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(doc, "plan"), "technique")), "backward");
    json_decref(doc);
}

static void test_nothing_is_written(void **state)
{
    struct cli_desk *f = *state;
    char path[160];

    plan(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    for (size_t i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", f->folder, i ? "maps" : "result.json");
        assert_int_equal(access(path, F_OK), -1);
    }
}

static void test_mistakes(void **state)
{
    static const struct {
        const char *file, *text, *says;
    } cases[] = {
        {"job.json", "{\"scene\":\n }", "job.json:2: "},
        {"job.json", "{\"kind\": \"annual\"}", "job.json: kind: a year (\"annual\") has no plan"},
        {"job.json", "{\"kind\": \"study\"}",
         "not \"study\" (use `oriel study` for such a document)"},
        {"job.json", JOB("{\"caustic\": \"skip\"}"), "job.json: effects.caustic: "},
        {"job.json", JOB("{\"caustic\": \"skip\"}"), "caustics_mirror"},
        {"job.json", JOB("{\"sun\": \"no\"}"), "effects.sun: \"auto\", \"force\" or \"skip\""},
        {"room.rad", "void plastic grey\n0\n0\n5 0.5 nan 0.5 0 0\n", "room.rad:4: "},
    };
    static const char *const usage[][3] = {{"plan", NULL}, {"plan", "a", "b"}};
    struct cli_desk *f;

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cli_desk_tear_down(state);
        set_up(state);
        f = *state;
        cli_write_file(f->folder, cases[i].file, cases[i].text);
        plan(f, "--json");
        assert_int_equal(f->result.exit_code, 1);
        assert_string_equal(f->result.out, "");
        if (!strstr(f->result.err, cases[i].says))
            fail_msg("expected \"%s\" in:\n%s", cases[i].says, f->result.err);
    }
    f = *state;
    unlink(f->document);
    plan(f, NULL);
    assert_int_equal(f->result.exit_code, 1);
    for (size_t i = 0; i < 2; i++) {
        const char *const args[] = {usage[i][0], usage[i][1], usage[i][2], NULL};

        cli_run(args, &f->result);
        assert_int_equal(f->result.exit_code, 2);
    }
    plan(f, "--threads=0");
    assert_int_equal(f->result.exit_code, 2);
}

/* The README's example is complete in the repository: no file must be generated first. The short
 * form plans a copy of it by paths, whose plan takes a sixth of the time. */
static void test_example(void **state)
{
    struct cli_desk *f = *state;
    char folder[160], text[2048], path[200];
    char *job = cli_read_file("client/examples/office", "office.json");
    assert_non_null(job);
    snprintf(text, sizeof text, "cp -r client/examples/office %s", f->folder);
    assert_int_equal(system(text), 0); /* NOLINT(cert-env33-c) */
    snprintf(text, sizeof text, "{\"technique\": \"backward\", %s", strchr(job, '{') + 1);
    snprintf(folder, sizeof folder, "%s/office", f->folder);
    cli_write_file(folder, "office.json", extent_is_long() ? job : text);
    snprintf(path, sizeof path, "%s/office.json", folder);
    const char *const args[] = {"plan", path, NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("exit %d: %s", f->result.exit_code, f->result.err);
    free(job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_the_table_has_every_effect, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_no_line_is_too_long, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_wishes_show, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_json_is_what_a_run_says, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_skies, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_the_technique, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_narrow_lobes, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_nothing_is_written, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_example, set_up, cli_desk_tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

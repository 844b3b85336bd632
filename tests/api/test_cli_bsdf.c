/* `oriel bsdf check`, `fit` and `make` from a script's view. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

static struct cli_result result;

static void check_bsdf(const char *file, const char *option)
{
    const char *const args[] = {"bsdf", "check", file, option, NULL};
    cli_run(args, &result);
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

static void a_sound_file_passes(void **state)
{
    (void)state;
    check_bsdf("tests/fixtures/bsdf_lcp8.xml", NULL);
    assert_int_equal(result.exit_code, 0);
    assert_says(result.out, "TensorTree4, resolution 8");
    assert_says(result.out, "goes straight through");
    assert_string_equal(result.err, "");
}

static void it_speaks_json(void **state)
{
    json_t *json;
    const char *verdict = NULL;
    (void)state;
    check_bsdf("tests/fixtures/bsdf_klems41.xml", "--json");
    assert_int_equal(result.exit_code, 0);
    json = json_loads(result.out, 0, NULL);
    assert_non_null(json);
    assert_int_equal(json_unpack(json, "{s:{s:s}}", "check", "verdict", &verdict), 0);
    assert_string_not_equal(verdict, "fault");
    json_decref(json);
}

/* The fixture with its first number replaced, and a file with each kind of fault. */
static void faults_end_with_1(void **state)
{
    static const struct {
        const char *value, *out, *err;
    } cases[] = {{"nan", "", "'nan' is not a finite number"},
                 {"1e9", "Energy is gained", ""},
                 {"abc", "", "is not a number"}};
    char folder[64], path[128];
    char *text = cli_read_file("tests/fixtures", "bsdf_klems41.xml");
    char *data;
    (void)state;
    assert_non_null(text);
    data = strstr(text, "<ScatteringData>") + strlen("<ScatteringData>");
    data += strspn(data, " \t\r\n");
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/bad.xml", folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        memset(data, ' ', strcspn(data, ",\n"));
        memcpy(data, cases[i].value, strlen(cases[i].value));
        cli_write_file(folder, "bad.xml", text);
        check_bsdf(path, NULL);
        assert_int_equal(result.exit_code, 1);
        assert_says(result.out, cases[i].out);
        assert_says(result.err, cases[i].err);
        if (cases[i].err[0] != '\0')
            assert_says(result.err, "bad.xml:");
    }
    free(text);
    cli_remove_folder(folder);
}

/* A sheet defined by arguments and by a document gives the same bytes, and a valid file. */
static void a_panel_becomes_a_file(void **state)
{
    char folder[64], panel[128], xml[128], document[128], other[128], report[128], errors[128];
    double transmitted = 0;
    (void)state;
    cli_make_folder(folder);
    cli_write_file(folder, "panel.rad",
                   "void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                   "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n");
    cli_write_file(folder, "panel.json",
                   "{\"kind\": \"bsdf_make\", \"scene\": {\"files\": [\"panel.rad\"]},"
                   " \"name\": \"sheet\", \"basis\": \"klems_quarter\", \"paths\": 256,"
                   " \"cell\": {\"x\": [0, 1], \"y\": [0, 1]}}");
    snprintf(panel, sizeof panel, "%s/panel.rad", folder);
    snprintf(xml, sizeof xml, "%s/panel.xml", folder);
    snprintf(document, sizeof document, "%s/panel.json", folder);
    snprintf(other, sizeof other, "%s/other.xml", folder);
    snprintf(report, sizeof report, "%s/report.json", folder);
    snprintf(errors, sizeof errors, "%s/errors.xml", folder);
    const char *const by_document[] = {"bsdf",     "make", document,   "-o",   xml,
                                       "--report", report, "--errors", errors, NULL};
    cli_run(by_document, &result);
    assert_int_equal(result.exit_code, 0);
    assert_says(result.out, "diffuse light from");
    json_t *json = json_load_file(report, 0, NULL);
    assert_int_equal(json_unpack(json, "{s:{s:{s:{s:f}}}}", "diffuse", "front", "transmitted",
                                 "value", &transmitted),
                     0);
    assert_true(transmitted > 0.29 && transmitted < 0.31); /* 0.3 */
    json_decref(json);
    check_bsdf(xml, NULL);
    assert_int_equal(result.exit_code, 0);
    assert_says(result.out, "Klems Quarter, resolution 41");
    char *text = cli_read_file(folder, "errors.xml");
    assert_says(text, "This file holds standard errors, not a BSDF");
    free(text);
    assert_says(result.out, "\"sheet\"");
    const char *const by_words[] = {"bsdf",    "make",          panel,     "-o",  other,
                                    "--basis", "klems_quarter", "--paths", "256", "--name",
                                    "sheet",   "--cell",        "0 1 0 1", NULL};
    cli_run(by_words, &result);
    assert_int_equal(result.exit_code, 0);
    char *first = cli_read_file(folder, "panel.xml"), *second = cli_read_file(folder, "other.xml");
    /* Compares all lines except the one that names the file. */
    assert_string_equal(strstr(first, "SHA-256"), strstr(second, "SHA-256"));
    free(first);
    free(second);
    cli_remove_folder(folder);
}

static void make_cell(const char *folder, const char *cell)
{
    char panel[128], xml[128];
    snprintf(panel, sizeof panel, "%s/panel.rad", folder);
    snprintf(xml, sizeof xml, "%s/panel.xml", folder);
    const char *const args[] = {"bsdf",          "make",    panel, "-o",     xml,  "--basis",
                                "klems_quarter", "--paths", "16",  "--cell", cell, NULL};
    cli_run(args, &result);
}

/* A cell outside the panel is a mistake; one in a gap of it is air, with a warning. */
static void an_empty_cell_is_noticed(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    cli_write_file(folder, "panel.rad",
                   "void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                   "s polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
                   "s polygon q 0 0 12 3 0 0 4 0 0 4 1 0 3 1 0\n");
    make_cell(folder, "10 11 0 1");
    assert_int_equal(result.exit_code, 1);
    assert_says(result.err,
                "the cell contains no surface: the panel extends from x 0 to 4, y 0 to 1");
    make_cell(folder, "0 1 -3 -2");
    assert_int_equal(result.exit_code, 1);
    make_cell(folder, "1.5 2.5 0 1");
    assert_int_equal(result.exit_code, 0);
    assert_says(result.err, "warning: no ray hit a surface in the cell, x 1.5 to 2.5, y 0 to 1: "
                            "all light passes through it unchanged");
    make_cell(folder, "0.5 1.5 0 1"); /* half of it is a gap */
    assert_int_equal(result.exit_code, 0);
    assert_null(strstr(result.err, "warning"));
    cli_remove_folder(folder);
}

/* Writes goniophotometer measurements of white paper of 60 %: three incident directions, 200 rows
 * each. */
static void write_paper(const char *folder)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    fputs("theta_in,phi_in,theta_out,phi_out,bsdf\n", out);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 200; i++)
            fprintf(out, "%d,180,%.3f,%.3f,%.5f\n", 30 * k,
                    acos(1 - 0.95 * (i + 0.5) / 200) * 180 / M_PI, fmod(137.508 * i, 360),
                    0.6 / M_PI);
    assert_int_equal(fclose(out), 0);
    cli_write_file(folder, "paper.csv", text);
    free(text);
}

/* Measurements given by arguments and by a document give the same file. */
static void measurements_become_a_file(void **state)
{
    char folder[64], data[128], xml[128], document[128], other[128];
    double total = 0;
    (void)state;
    cli_make_folder(folder);
    write_paper(folder);
    cli_write_file(folder, "paper.json",
                   "{\"kind\": \"bsdf_fit\", \"measurements\": {\"files\": [\"paper.csv\"]},"
                   " \"name\": \"paper\", \"resolution\": 8}");
    snprintf(data, sizeof data, "%s/paper.csv", folder);
    snprintf(xml, sizeof xml, "%s/paper.xml", folder);
    snprintf(document, sizeof document, "%s/paper.json", folder);
    snprintf(other, sizeof other, "%s/other.xml", folder);
    const char *const by_document[] = {"bsdf", "fit", document, "-o", xml, "--json", NULL};
    cli_run(by_document, &result);
    assert_int_equal(result.exit_code, 0);
    json_t *json = json_loads(result.out, 0, NULL);
    assert_int_equal(json_unpack(json, "{s:{s:{s:{s:f}}}}", "components", "reflection_front",
                                 "diffuse", "value", &total),
                     0);
    /* Values have five digits; sums are accurate to 0.5 %. */
    assert_true(fabs(total - 0.6) < 0.003);
    json_decref(json);
    check_bsdf(xml, NULL);
    assert_int_equal(result.exit_code, 0);
    assert_says(result.out, "\"paper\"");
    const char *const by_words[] = {"bsdf",         "fit", data,     "-o",    other,
                                    "--resolution", "8",   "--name", "paper", NULL};
    cli_run(by_words, &result);
    assert_int_equal(result.exit_code, 0);
    assert_says(result.out, "symmetry isotropic, basis tensor_tree_3");
    char *first = cli_read_file(folder, "paper.xml"), *second = cli_read_file(folder, "other.xml");
    /* Compares all lines except the one that names the file. */
    assert_string_equal(strstr(first, "600 rows"), strstr(second, "600 rows"));
    free(first);
    free(second);
    cli_remove_folder(folder);
}

/* An error in making a file names the member concerned. */
static void what_cannot_be_made_is_refused(void **state)
{
    static const struct {
        const char *const args[12];
        int exit_code;
        const char *err;
    } cases[] = {
        {{"bsdf", "make", "x.rad"}, 2, "-o FILE is missing"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml"}, 1, "cannot open"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml", "--basis", "klems"}, 1, "basis"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml", "--paths", "0"}, 1, "paths"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml", "--accuracy", "2"}, 1, "accuracy"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml", "--cell", "0 1 2"}, 1, "cell"},
        {{"bsdf", "make", "x.rad", "-o", "x.xml", "--cell", "0 1 2 2"}, 1, "cell.y"},
        {{"bsdf", "make", "x.json", "-o", "x.xml", "--color"},
         2,
         "takes no further files and options"},
        {{"bsdf", "convert", "x.xml", "-o", "y.xml", "--within", "2"}, 2, "--within takes"},
        {{"bsdf", "fit", "x.txt"}, 2, "-o FILE is missing"},
        {{"bsdf", "fit", "x.txt", "-o", "x.xml"}, 1, "cannot open"},
        {{"bsdf", "fit", "x.txt", "-o", "x.xml", "--symmetry", "odd"}, 1, "symmetry"},
        {{"bsdf", "fit", "x.txt", "-o", "x.xml", "--grazing", "50"}, 1, "grazing"},
        {{"bsdf", "fit", "x.txt", "-o", "x.xml", "--basis", "klems_full", "--cull", "0"},
         1,
         "cull"},
        {{"bsdf", "fit", "x.json", "-o", "x.xml", "--reversed"},
         2,
         "takes no further files and options"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cli_run(cases[i].args, &result);
        assert_int_equal(result.exit_code, cases[i].exit_code);
        assert_says(result.err, cases[i].err);
    }
}

/* An output that is no regular file is written to, and not replaced. */
static void devices_are_not_replaced(void **state)
{
    char folder[64], panel[128], sink[128];
    struct stat info;
    (void)state;
    cli_make_folder(folder);
    snprintf(panel, sizeof panel, "%s/panel.rad", folder);
    snprintf(sink, sizeof sink, "%s/sink.svg", folder);
    cli_write_file(folder, "panel.rad",
                   "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                   "w polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n");
    assert_int_equal(symlink("/dev/null", sink), 0);
    const char *const make[] = {"bsdf",    "make",          panel,     "-o", sink,
                                "--basis", "klems_quarter", "--paths", "64", NULL};
    cli_run(make, &result);
    assert_int_equal(result.exit_code, 0);
    const char *const plot[] = {"bsdf", "plot", "tests/fixtures/bsdf_klems41.xml",
                                "-o",   sink,   NULL};
    cli_run(plot, &result);
    assert_int_equal(result.exit_code, 0);
    assert_int_equal(lstat(sink, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat("/dev/null", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
    cli_remove_folder(folder);
}

static void wrong_command_lines_exit_with_2(void **state)
{
    const char *const unknown[] = {"bsdf", "paint", "a.xml", NULL};
    const char *const missing[] = {"bsdf", "check", NULL};
    (void)state;
    cli_run(unknown, &result);
    assert_int_equal(result.exit_code, 2);
    assert_says(result.err, "\"paint\" is not one of check, fit, make, convert");
    cli_run(missing, &result);
    assert_int_equal(result.exit_code, 2);
    check_bsdf("no/such/file.xml", NULL);
    assert_int_equal(result.exit_code, 1);
    assert_says(result.err, "cannot open");
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_file_passes),
        cmocka_unit_test(it_speaks_json),
        cmocka_unit_test(faults_end_with_1),
        cmocka_unit_test(a_panel_becomes_a_file),
        cmocka_unit_test(an_empty_cell_is_noticed),
        cmocka_unit_test(measurements_become_a_file),
        cmocka_unit_test(what_cannot_be_made_is_refused),
        cmocka_unit_test(devices_are_not_replaced),
        cmocka_unit_test(wrong_command_lines_exit_with_2),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

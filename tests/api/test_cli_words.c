/* Unknown words of command lines and documents get a suggestion; each --help fits a screen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"

static int set_up(void **state)
{
    static const struct cli_file files[] = {{"job.json", "{}"}, {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("\"%s\" is not in: %s", wanted, text);
}

static void test_unknown_words_of_command_lines(void **state)
{
    static const struct {
        const char *args[5], *message;
    } cases[] = {
        {{"anual"}, "there is no command \"anual\"; did you mean \"annual\"?"},
        {{"help", "sumbit"}, "there is no command \"sumbit\"; did you mean \"submit\"?"},
        {{"run", "a.json", "--ouput", "b"},
         "unknown option \"--ouput\"; did you mean \"--output\"?"},
        {{"submit", "a.hbjson", "--whether=a.epw"}, "did you mean \"--weather\"?"},
        {{"bsdf", "mkae", "a.rad"}, "did you mean \"make\"?"},
        {{"teapot"}, "there is no command \"teapot\". Try `oriel --help`."},
    };
    struct cli_desk *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cli_run(cases[i].args, &f->result);
        assert_int_equal(f->result.exit_code, 2);
        assert_says(f->result.err, cases[i].message);
    }
}

/* Runs a document and checks the message of its refusal. */
static void assert_refused(struct cli_desk *f, const char *command, const char *document,
                           const char *message)
{
    const char *const args[] = {command, f->document, "-o", f->output, NULL};
    cli_write_file(f->folder, "job.json", document);
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, message);
}

#define RENDER(MORE)                                                                               \
    "{\"scene\": {\"files\": [\"a.rad\"]}, \"sensors\": [[0, 0, 0, 0, 0, 1]], " MORE "}"
#define YEAR(MORE)                                                                                 \
    "{\"kind\": \"annual\", \"scene\": {\"files\": [\"a.rad\"]}, \"weather\": \"a.epw\","          \
    " \"grids\": [{\"name\": \"a\", \"sensors\": {\"file\": \"a.pts\"}}], " MORE "}"

static void test_unknown_words_of_documents(void **state)
{
    static const struct {
        const char *command, *document, *word;
    } cases[] = {
        {"run", RENDER("\"tehcnique\": \"gather\""), "did you mean \"technique\"?"},
        {"run", RENDER("\"technique\": \"bakcward\""), "did you mean \"backward\"?"},
        {"run", RENDER("\"sky\": {\"cie\": {\"type\": \"overcats\"}}"),
         "did you mean \"overcast\"?"},
        {"run",
         RENDER("\"views\": [{\"name\": \"a\", \"view\": \"-vth\", \"width\": 9, \"height\": 9,"
                " \"metrics\": [\"dpg\"]}]"),
         "did you mean \"dgp\"?"},
        {"run",
         RENDER("\"views\": [{\"name\": \"a\", \"view\": \"-vth\", \"width\": 9, \"height\": 9,"
                " \"formats\": [\"pgn\"]}]"),
         "did you mean \"png\"?"},
        {"annual", YEAR("\"rules\": [\"LEDE\"]"), "did you mean \"LEED\"?"},
        {"annual", YEAR("\"metrics\": [\"cumulatve\"]"), "did you mean \"cumulative\"?"},
        {"annual", YEAR("\"targets\": [\"sAD300/50 >= 55 %\"]"), "did you mean \"sda\"?"},
    };
    struct cli_desk *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_refused(f, cases[i].command, cases[i].document, cases[i].word);
}

static void test_unknown_words_of_projects(void **state)
{
    static const char model[] = "tests/fixtures/honeybee/two_rooms.hbjson";
    struct cli_desk *f = *state;
    const char *const group[] = {"project", model, "--states", "south_glas=0_south_glass", NULL};
    cli_run(group, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "did you mean \"south_glass\"?");
    const char *const choice[] = {"project", model, "--states", "south_glass=2_south_glass", NULL};
    cli_run(choice, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_says(f->result.err, "its states are 0_south_glass, 1_south_glass");
}

/* ---- Help ------------------------------------------------------------------------------------ */

/* A screen of help. `bsdf make`, which has the most options, takes the most lines. */
enum { SCREEN_LINES = 46, SCREEN_COLUMNS = 80 };

static void assert_fits(const char *command, const char *text)
{
    size_t lines = 0;
    for (const char *at = text; *at; lines++) {
        const size_t length = strcspn(at, "\n");
        if (length > SCREEN_COLUMNS)
            fail_msg("%s: a line has %zu columns: %.*s", command, length, (int)length, at);
        at += length + (at[length] == '\n');
    }
    if (lines > SCREEN_LINES)
        fail_msg("%s: the help has %zu lines", command, lines);
}

static void test_help_fits_a_screen(void **state)
{
    static const char *const commands[][2] = {{"run"},
                                              {"plan"},
                                              {"project"},
                                              {"annual"},
                                              {"verify"},
                                              {"part"},
                                              {"study"},
                                              {"submit"},
                                              {"status"},
                                              {"watch"},
                                              {"wait"},
                                              {"fetch"},
                                              {"cancel"},
                                              {"remove"},
                                              {"list"},
                                              {"link"},
                                              {"maps"},
                                              {"upload"},
                                              {"bsdf"},
                                              {"bsdf", "make"},
                                              {"bsdf", "fit"},
                                              {"bsdf", "plot"},
                                              {"bsdf", "compare"},
                                              {"bsdf", "convert"},
                                              {"glare"},
                                              {"version"}};
    struct cli_desk *f = *state;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        const char *const args[] = {"help", commands[i][0], commands[i][1], NULL};
        cli_run(args, &f->result);
        assert_int_equal(f->result.exit_code, 0);
        assert_fits(commands[i][0], f->result.out);
        assert_says(f->result.out, "\nexample\n  oriel ");
        assert_says(f->result.out, "\nGuide: ");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_unknown_words_of_command_lines, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_unknown_words_of_documents, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_unknown_words_of_projects, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_help_fits_a_screen, set_up, cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* `oriel` on a terminal: a progress bar as wide as the window allows, and colours where wanted. */
#include <pty.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/cli.h"

static const char scene_text[] = "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void glow sky_glow\n0\n0\n4 17.78 17.78 17.78 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  4 0 0  4 4 0  0 4 0\n";

static int set_up(void **state)
{
    static const struct cli_file files[] = {
        {"job.json", "{\"scene\": {\"files\": [\"room.rad\"]}, \"technique\": \"backward\","
                     " \"gather_samples\": 256, \"sensors\": [[1, 1, 0.8, 0, 0, 1]]}"},
        {"room.rad", scene_text},
        {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

/* Output of a command on a terminal. */
struct shown {
    int exit_code;
    size_t size;
    char text[CLI_OUTPUT_MAX];
};

static void run_on_terminal(const char *const *args, unsigned short columns, const char *term,
                            const char *no_color, struct shown *ret_shown)
{
    const struct winsize window = {.ws_row = 24, .ws_col = columns};
    const char *build = getenv("ORIEL_BUILD");
    char program[512];
    int terminal = -1, status = 0;
    snprintf(program, sizeof program, "%s/oriel", build ? build : "build");
    const pid_t child = forkpty(&terminal, NULL, NULL, &window);
    assert_true(child >= 0);
    if (child == 0) {
        setenv("TERM", term, 1);
        setenv("NO_COLOR", no_color, 1);
        execv(program, (char *const *)(uintptr_t)args);
        _exit(127);
    }
    *ret_shown = (struct shown){.size = 0};
    for (ssize_t n; ret_shown->size + 1 < CLI_OUTPUT_MAX &&
                    (n = read(terminal, ret_shown->text + ret_shown->size,
                              CLI_OUTPUT_MAX - 1 - ret_shown->size)) > 0;)
        ret_shown->size += (size_t)n; /* ends with EIO when the child has gone */
    close(terminal);
    assert_int_equal(waitpid(child, &status, 0), child);
    ret_shown->exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static struct shown *run_job(struct cli_desk *f, unsigned short columns, const char *term,
                             const char *no_color)
{
    struct shown *shown = malloc(sizeof *shown);
    const char *const args[] = {"oriel", "run", f->document, "-o", f->output, NULL};
    assert_non_null(shown);
    run_on_terminal(args, columns, term, no_color, shown);
    if (shown->exit_code != 0)
        fail_msg("%s", shown->text);
    return shown;
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("\"%s\" is not in: %s", wanted, text);
}

/* Returns the columns that a line takes: characters but for escape codes. */
static size_t count_columns(const char *line, size_t length)
{
    size_t columns = 0;
    for (size_t i = 0; i < length; i++) {
        if (line[i] != '\033') {
            columns++;
            continue;
        }
        while (i + 1 < length && line[++i] != 'm' && line[i] != 'K')
            ;
    }
    return columns;
}

/* Checks that every state of the bar fits the window. */
static void assert_bars_fit(const char *text, size_t columns)
{
    size_t bars = 0;
    for (const char *at = strstr(text, "\r"); at; at = strstr(at + 1, "\r")) {
        const size_t length = strcspn(at + 1, "\r\n");
        if (strstr(at + 1, "ETA") && strstr(at + 1, "ETA") < at + 1 + length) {
            bars++;
            assert_true(count_columns(at + 1, length) < columns);
        }
    }
    assert_true(bars > 0);
}

static void test_a_bar_with_colours(void **state)
{
    struct cli_desk *f = *state;
    struct shown *shown = run_job(f, 100, "xterm-256color", "");
    assert_says(shown->text, "\r[");
    assert_says(shown->text, " %  render   ETA ");
    assert_says(shown->text, "\033[32m");     /* the part of the bar that is done */
    assert_says(shown->text, "\033[1mgrid "); /* the table's heading */
    assert_bars_fit(shown->text, 100);
    free(shown);
}

static void test_narrow_windows_get_text_alone(void **state)
{
    struct cli_desk *f = *state;
    struct shown *shown = run_job(f, 30, "xterm", "");
    assert_null(strstr(shown->text, "\r["));
    assert_bars_fit(shown->text, 30);
    free(shown);
}

static void test_no_color_leaves_the_bar(void **state)
{
    struct cli_desk *f = *state;
    struct shown *shown = run_job(f, 100, "xterm", "1");
    assert_says(shown->text, "\r[");
    assert_null(strstr(shown->text, "\033[3"));
    assert_null(strstr(shown->text, "\033[1m"));
    free(shown);
}

static void test_dumb_terminals_get_plain_lines(void **state)
{
    struct cli_desk *f = *state;
    struct shown *shown = run_job(f, 100, "dumb", "");
    assert_null(strstr(shown->text, "\033"));
    assert_null(strstr(shown->text, "\r["));
    assert_says(shown->text, " %  render   ETA ");
    free(shown);
}

static void test_pipes_get_no_codes(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"run", f->document, "-o", f->output, NULL};
    setenv("TERM", "xterm", 1);
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_null(strstr(f->result.out, "\033"));
    assert_null(strstr(f->result.err, "\033"));
    assert_null(strstr(f->result.err, "\r"));
}

static void test_errors_are_red(void **state)
{
    const char *const args[] = {"oriel", "run", "/nowhere/job.json", "-o", "/tmp", NULL};
    struct cli_desk *f = *state;
    struct shown *shown = malloc(sizeof *shown);
    char output[128];
    assert_non_null(shown);
    snprintf(output, sizeof output, "%s", f->output);
    const char *const line[] = {args[0], args[1], args[2], args[3], output, NULL};
    run_on_terminal(line, 80, "xterm", "", shown);
    assert_int_equal(shown->exit_code, 1);
    assert_says(shown->text, "\033[31m");
    free(shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_bar_with_colours, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_narrow_windows_get_text_alone, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_no_color_leaves_the_bar, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_dumb_terminals_get_plain_lines, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_pipes_get_no_codes, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_errors_are_red, set_up, cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

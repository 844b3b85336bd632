/* `oriel bsdf check` as a script meets it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

static struct cli_result result;

static void check(const char *file, const char *option)
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
    check("tests/fixtures/bsdf_lcp8.xml", NULL);
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
    check("tests/fixtures/bsdf_klems41.xml", "--json");
    assert_int_equal(result.exit_code, 0);
    json = json_loads(result.out, 0, NULL);
    assert_non_null(json);
    assert_int_equal(json_unpack(json, "{s:{s:s}}", "check", "verdict", &verdict), 0);
    assert_string_not_equal(verdict, "fault");
    json_decref(json);
}

/* The fixture with its first number replaced, beside a fault of each kind. */
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
        check(path, NULL);
        assert_int_equal(result.exit_code, 1);
        assert_says(result.out, cases[i].out);
        assert_says(result.err, cases[i].err);
        if (cases[i].err[0] != '\0')
            assert_says(result.err, "bad.xml:");
    }
    free(text);
    cli_remove_folder(folder);
}

static void wrong_command_lines_exit_with_2(void **state)
{
    const char *const unknown[] = {"bsdf", "paint", "a.xml", NULL};
    const char *const missing[] = {"bsdf", "check", NULL};
    (void)state;
    cli_run(unknown, &result);
    assert_int_equal(result.exit_code, 2);
    assert_says(result.err, "\"paint\" is not check");
    cli_run(missing, &result);
    assert_int_equal(result.exit_code, 2);
    check("no/such/file.xml", NULL);
    assert_int_equal(result.exit_code, 1);
    assert_says(result.err, "cannot open");
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_file_passes),
        cmocka_unit_test(it_speaks_json),
        cmocka_unit_test(faults_end_with_1),
        cmocka_unit_test(wrong_command_lines_exit_with_2),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The settings file of `oriel`: servers by name, files of tokens, precedence, and errors by line.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "support/canned.h"

static const struct canned no_maps[] = {{"GET /v1/maps", 200, "{\"maps\": []}"}, {NULL, 0, NULL}};

static int set_up(void **state)
{
    const int rc = canned_set_up(state);
    struct canned_daemon *f = *state;
    setenv("XDG_CONFIG_HOME", f->folder, 1);
    unsetenv("ORIEL_URL");
    unsetenv("ORIEL_TOKEN");
    return rc;
}

/* Runs `oriel maps [--server SERVER]` against the daemon. */
static void list_maps(struct canned_daemon *f, const char *server)
{
    const char *const args[] = {"maps", server ? "--server" : NULL, server, NULL};
    canned_run_args(f, no_maps, args);
}

/* Writes the settings: text before and after the daemon's URL. */
static void write_settings(struct canned_daemon *f, const char *before, const char *after)
{
    char text[1024];
    snprintf(text, sizeof text, "%s%s%s", before, f->url, after);
    cli_write_file(f->folder, "oriel.toml", text);
}

static void test_server_of_the_file(void **state)
{
    struct canned_daemon *f = *state;
    write_settings(f, "# my daemons\r\nserver = \"", "/\"  # the usual one\r\n");
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_true(canned_asked(f, "GET /v1/maps") == 1);
}

static void test_servers_by_name(void **state)
{
    struct canned_daemon *f = *state;
    write_settings(f, "server = 'office'\n[servers.office]\nurl = \"",
                   "\"\n"
                   "[servers.other]\nurl = \"http://127.0.0.1:1\"\n");
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    list_maps(f, "office");
    assert_int_equal(f->result.exit_code, 0);
    list_maps(f, "other");
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "no answer from http://127.0.0.1:1");
    list_maps(f, "ofice");
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "\"ofice\" is neither a URL nor a server that the settings name");
    canned_says(f->result.err, "did you mean \"office\"?");
}

/* The environment overrides the file, and the option overrides both. */
static void test_precedence(void **state)
{
    struct canned_daemon *f = *state;
    write_settings(f, "server = \"http://127.0.0.1:1\"\n[servers.office]\nurl = \"", "\"\n");
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 1);
    setenv("ORIEL_URL", f->url, 1);
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    setenv("ORIEL_URL", "http://127.0.0.1:1", 1);
    list_maps(f, "office");
    assert_int_equal(f->result.exit_code, 0);
    unsetenv("ORIEL_URL");
}

/* A token that others can read is used with a warning; one that cannot be read is an error. */
static void test_tokens(void **state)
{
    struct canned_daemon *f = *state;
    char path[256];
    write_settings(f, "server = \"", "\"\ntoken_file = \"my.token\"\n");
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "my.token");
    cli_write_file(f->folder, "my.token", "secret\n");
    snprintf(path, sizeof path, "%s/my.token", f->folder);
    assert_int_equal(chmod(path, 0644), 0);
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    canned_says(f->result.err, "other users can read this access token; run `chmod 600 ");
    assert_int_equal(chmod(path, 0600), 0);
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 0);
    assert_null(strstr(f->result.err, "chmod"));
    cli_write_file(f->folder, "my.token", "two words\n");
    list_maps(f, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "the file must have one access token, and no more");
    /* Another server is asked without that token. */
    cli_write_file(f->folder, "oriel.toml",
                   "server = \"http://127.0.0.1:1\"\ntoken_file = \"my.token\"\n");
    list_maps(f, f->url);
    assert_int_equal(f->result.exit_code, 0);
}

static void test_errors_have_lines(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"\nserver = http://a\n", "oriel.toml:2: a string in quotes is expected"},
        {"server = \"http://a\n", "oriel.toml:1: the string has no closing quote"},
        {"server = \"http://a\" x\n", "oriel.toml:1: nothing may follow the string"},
        {"server = \"a\\n\"\n", "oriel.toml:1: the only escapes in a string are"},
        {"server \"http://a\"\n", "oriel.toml:1: '=' is expected after the key"},
        {"server = \"http://a\"\nserver = \"http://b\"\n",
         "oriel.toml:2: the setting is given twice"},
        {"tokenfile = \"a\"\n",
         "oriel.toml:1: \"tokenfile\" is not a setting at the top of the file "
         "(did you mean \"token_file\"?"},
        {"[server.a]\n", "oriel.toml:1: a table is expected as [servers.NAME]"},
        {"[servers.a]\nurl = \"http://a\"\n[servers.a]\n",
         "oriel.toml:3: a second table has the same name"},
        {"[servers.a]\nserver = \"http://a\"\n",
         "oriel.toml:2: \"server\" is not a setting of a server"},
        {"[servers.a]\n", "oriel.toml: the server \"a\" has no \"url\""},
        {"[servers.a]\nurl = 5\n", "oriel.toml:2: a string in quotes is expected"},
    };
    struct canned_daemon *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cli_write_file(f->folder, "oriel.toml", cases[i].text);
        list_maps(f, NULL);
        assert_int_equal(f->result.exit_code, 1);
        canned_says(f->result.err, cases[i].message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_server_of_the_file, set_up, canned_tear_down),
        cmocka_unit_test_setup_teardown(test_servers_by_name, set_up, canned_tear_down),
        cmocka_unit_test_setup_teardown(test_precedence, set_up, canned_tear_down),
        cmocka_unit_test_setup_teardown(test_tokens, set_up, canned_tear_down),
        cmocka_unit_test_setup_teardown(test_errors_have_lines, set_up, canned_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

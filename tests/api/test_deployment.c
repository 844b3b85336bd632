/*
 * Properties of the Dockerfile and the systemd unit that can be tested without Docker or systemd.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/certificate.h"
#include "support/cli.h"
#include "support/daemon.h"

/* Runs the health check's command, ["oriel", ...], with the daemon's port in place of the default
 * one. */
static int run_health_check(const char *url)
{
    const char *build = getenv("ORIEL_BUILD");
    char command[600], *text = cli_read_file(".", "Dockerfile");
    assert_non_null(text);
    const char *at = strstr(text, "HEALTHCHECK");
    at = at ? strstr(at, "CMD [") : NULL;
    assert_non_null(at);
    at += strlen("CMD [");
    const char *end = at + strcspn(at, "]");
    snprintf(command, sizeof command, "PATH=%s:$PATH; ", build ? build : "build");
    while (at < end && strlen(command) + 32 < sizeof command) {
        if (strncmp(at, "8423", 4) == 0) {
            strcat(command, strrchr(url, ':') + 1);
            at += 4;
        } else {
            strncat(command, *at == ',' ? " " : at, 1);
            at++;
        }
    }
    free(text);
    strcat(command, " >/dev/null");
    return system(command);
}

static void test_health_check(void **state)
{
    struct daemon daemon;
    char cert[80], key[80], url[64];
    (void)state;
    daemon_start(&daemon, NULL);
    assert_int_equal(run_health_check(daemon.url), 0);
    assert_int_equal(daemon_end(&daemon, SIGTERM), 0);
    snprintf(url, sizeof url, "%s", daemon.url);
    assert_int_not_equal(run_health_check(url), 0); /* the daemon no longer listens there */
    snprintf(cert, sizeof cert, "%s/cert.pem", daemon.root);
    snprintf(key, sizeof key, "%s/key.pem", daemon.root);
    certificate_make(cert, key);
    const char *const extra[] = {"--tls-cert", cert, "--tls-key", key, NULL};
    daemon_restart(&daemon, extra);
    assert_int_equal(run_health_check(daemon.url), 0);
    daemon_remove(&daemon);
}

static void test_container_is_no_root(void **state)
{
    (void)state;
    char *text = cli_read_file(".", "Dockerfile");
    assert_non_null(text);
    const char *user = strstr(text, "\nUSER oriel\n"), *entry = strstr(text, "\nENTRYPOINT");
    assert_true(user && entry && user < entry);
    assert_non_null(strstr(text, "-m 0700 /state/oriel"));
    assert_non_null(strstr(text, "--chown=8423:8423 /state /var/lib\n"));
    free(text);
}

/* The unit has the required settings; and systemd, if installed, accepts it. */
static void test_unit(void **state)
{
    static const char *const lines[] = {
        "\nUser=oriel\n",
        "\nProtectSystem=strict\n",
        "\nNoNewPrivileges=yes\n",
        "\nPrivateTmp=yes\n",
        "\nPrivateMounts=yes\n",
        "\nDevicePolicy=closed\n",
        "\nStateDirectory=oriel\n",
        "\nStateDirectoryMode=0700\n",
        "\nProtectHome=yes\n",
        "\nCapabilityBoundingSet=\n",
        "\nMemoryDenyWriteExecute=yes\n",
        "\nSystemCallFilter=@system-service\n",
        "\nType=notify\n",
        "\nWatchdogSec=",
        "\nMemoryMax=",
        "\nExecReload=",
        "\nEnvironmentFile=-/etc/oriel/orield.env\n",
    };
    const char *build = getenv("ORIEL_BUILD");
    char folder[64], command[600], *text = cli_read_file("server", "orield.service");
    (void)state;
    assert_non_null(text);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (!strstr(text, lines[i]))
            fail_msg("the unit has lost %s", lines[i]);
    free(text);
    if (system("command -v systemd-analyze >/dev/null") != 0)
        return;
    cli_make_folder(folder);
    snprintf(command, sizeof command,
             "sed \"s#^ExecStart=.*#ExecStart=$(realpath %s/orield) \\$ORIEL_OPTIONS#\" "
             "server/orield.service "
             ">%s/orield.service && { systemd-analyze verify --man=no %s/orield.service >%s/said "
             "2>&1; cat %s/said >&2; ! grep -q orield.service %s/said; }",
             build ? build : "build", folder, folder, folder, folder, folder);
    assert_int_equal(system(command), 0);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_health_check),
        cmocka_unit_test(test_container_is_no_root),
        cmocka_unit_test(test_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

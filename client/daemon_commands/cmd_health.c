/* oriel health: asks a daemon whether it is alive. */
#include "options/command.h"

#include <stdio.h>
#include <string.h>

#include <jansson.h>

#include "daemon_commands/follow_job.h"
#include "http/json_get.h"
#include "output/terminal.h"

static void print_health(const char *url, const json_t *health)
{
    char up[32];
    orl_format_duration(orl_get_number(health, "uptime_s", 0), up, sizeof up);
    printf("%s: orield %s, up for %s, disk %s\n", url, orl_get_text(health, "version"), up,
           orl_get_text(health, "disk"));
}

/* Asks again by HTTPS. Keeps the first error if there is no answer either: it names the URL that
 * was given. */
static int ask_by_https(struct orl_daemon_command *daemon, json_t **ret_health)
{
    static const char http[] = "http://";
    struct orl_error second = {0};
    char url[sizeof daemon->http.base_url];
    if (strncmp(daemon->http.base_url, http, strlen(http)) != 0)
        return daemon->err.code;
    const int length =
        snprintf(url, sizeof url, "https://%s", daemon->http.base_url + strlen(http));
    if (length < 0 || (size_t)length >= sizeof url)
        return daemon->err.code;
    memcpy(daemon->http.base_url, url, sizeof url);
    const int rc = orl_http_call(&daemon->http, "GET", "/healthz", ret_health, &second);
    return rc ? daemon->err.code : 0;
}

int orl_cmd_health(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    bool local = false;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"local", 0, NULL, "accept any certificate of a daemon of this machine, and HTTPS for HTTP",
         NULL, &local},
    };
    json_t *health = NULL;
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 0, 0, &daemon.operands, &rc))
        return rc;
    rc = orl_daemon_open(&daemon);
    daemon.http.any_certificate = local;
    if (rc == 0)
        rc = orl_http_call(&daemon.http, "GET", "/healthz", &health, &daemon.err);
    if (rc && local && daemon.http.curl)
        rc = ask_by_https(&daemon, &health);
    if (rc == 0)
        print_health(daemon.http.base_url, health);
    json_decref(health);
    return orl_daemon_end(&daemon, rc);
}

/* oriel wait ID: waits for a job with progress on stderr. */
#include "options/command.h"

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "output/report_error.h"

int orl_cmd_wait(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *server = NULL;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    int code;

    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &operands, &code))
        return code;
    if (orl_http_open(&http, server, &err))
        code = orl_report_error(&err);
    else
        code = orl_follow_job(&http, operands.items[0]);
    orl_http_close(&http);
    return code;
}

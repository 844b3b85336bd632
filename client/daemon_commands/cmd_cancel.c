/* oriel cancel ID: cancels a job and returns when it has stopped. */
#include "options/command.h"

#include <stdio.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "output/report_error.h"

int orl_cmd_cancel(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *server = NULL;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    json_t *nothing, *job = NULL;
    char path[1024];
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &operands, &rc))
        return rc;
    nothing = json_object();
    rc = orl_http_open(&http, server, &err);
    if (rc == 0)
        rc = orl_job_path(operands.items[0], "/cancel", path, sizeof path, &err);
    if (rc == 0)
        rc = orl_http_post_json(&http, path, nothing, &job, &err);
    if (rc == 0 && !(job && orl_job_has_ended(job))) {
        fprintf(stderr, "job %s: cancelling\n", operands.items[0]);
        json_decref(job);
        job = NULL;
        rc = orl_await_job(&http, operands.items[0], &job, &err);
    }
    if (rc == 0)
        fprintf(stderr, "job %s: %s\n", operands.items[0], orl_json_text(job, "state"));
    json_decref(job);
    json_decref(nothing);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

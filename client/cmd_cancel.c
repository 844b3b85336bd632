/* oriel cancel ID */
#include "command.h"

#include <stdio.h>

#include "follow.h"
#include "http.h"
#include "report.h"

int orl_cmd_cancel(const struct orl_command *self, int argc, char **argv)
{
    const char *server = NULL;
    const struct orl_option options[] = {ORL_OPTION_SERVER(&server)};
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    json_t *nothing = json_object();
    char path[1024];
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &operands, &rc))
        return rc;
    rc = orl_http_open(&http, server, &err);
    if (rc == 0)
        rc = orl_job_path(operands.items[0], "/cancel", path, sizeof path, &err);
    if (rc == 0)
        rc = orl_http_post_json(&http, path, nothing, NULL, &err);
    if (rc == 0)
        fprintf(stderr, "job %s: cancelled\n", operands.items[0]);
    json_decref(nothing);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

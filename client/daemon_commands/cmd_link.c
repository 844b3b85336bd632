/* oriel link ID FILE...: prints temporary addresses of result files that need no token. */
#include "options/command.h"

#include <stdio.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "output/report_error.h"

enum { MOST_FILES = 100, MOST_SECONDS = 3600, USUAL_SECONDS = 300 };

static json_t *make_document(const struct orl_operands *operands, uint64_t seconds)
{
    json_t *files = json_array();

    for (int i = 1; i < operands->count && files; i++)
        json_array_append_new(files, json_string(operands->items[i]));
    return json_pack("{s:o, s:I}", "files", files, "seconds", (json_int_t)seconds);
}

static void print_links(const struct orl_http *http, const json_t *links)
{
    const json_t *link;
    size_t i;

    json_array_foreach(links, i, link)
    {
        printf("%s%s\n", http->base_url, orl_json_text(link, "url"));
    }
}

int orl_cmd_link(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *server = NULL, *seconds_text = NULL;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&server),
        {.name = "seconds",
         .metavar = "N",
         .help = "that they are good for, up to 3600 (300)",
         .value = &seconds_text},
    };
    struct orl_operands operands;
    struct orl_http http = {0};
    struct orl_error err = {0};
    uint64_t seconds = USUAL_SECONDS;
    json_t *reply = NULL;
    char path[1024];
    int rc;

    if (!orl_options_parse(self, argc, argv, options, 2, 2, 1 + MOST_FILES, &operands, &rc))
        return rc;
    if (seconds_text && !orl_parse_count(seconds_text, 1, MOST_SECONDS, &seconds))
        return orl_usage_error(self, "--seconds takes a number from 1 to %d, not \"%s\"",
                               MOST_SECONDS, seconds_text);
    json_t *body = make_document(&operands, seconds);
    rc = body ? orl_http_open(&http, server, &err)
              : orl_error_set(&err, ORL_ERR_INVALID, "names of files are text in UTF-8");
    if (rc == 0)
        rc = orl_job_path(operands.items[0], "/links", path, sizeof path, &err);
    if (rc == 0)
        rc = orl_http_post_json(&http, path, body, &reply, &err);
    if (rc == 0)
        print_links(&http, json_object_get(reply, "links"));
    json_decref(reply);
    json_decref(body);
    orl_http_close(&http);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

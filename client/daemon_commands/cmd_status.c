/* oriel status [ID]: prints one job in detail, or the latest jobs as a table. */
#include "options/command.h"

#include <stdio.h>
#include <string.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "output/reports.h"
#include "output/terminal.h"

/* Prints a study's current step and its points so far. */
static void print_study(const json_t *study)
{
    const json_t *points = json_object_get(study, "points"), *point;
    char text[160];
    size_t i;
    if (!study)
        return;
    printf("running  %s, run %.0f of %.0f\npoints   %zu of %.0f\n", orl_get_text(study, "running"),
           orl_get_number(study, "run", 0), orl_get_number(study, "runs", 0),
           json_array_size(points), orl_get_number(study, "settings", 0));
    json_array_foreach(points, i, point)
    {
        orl_format_study_point(point, text, sizeof text);
        printf("%s\n", text);
    }
}

static void print_job(const json_t *job)
{
    const json_t *maps = json_object_get(job, "maps"), *map, *warning, *tag;
    const double eta_s = orl_get_number(job, "eta_s", -1);
    const double position = orl_get_number(job, "queue_position", -1);
    char text[320];
    size_t i;
    printf("id       %s\n", orl_get_text(job, "id"));
    if (*orl_get_text(job, "name"))
        printf("name     %s\n", orl_get_text(job, "name"));
    json_array_foreach(json_object_get(job, "tags"), i, tag)
    {
        printf("tag      %s\n", json_string_value(tag));
    }
    printf("kind     %s\nstate    %s\n", orl_get_text(job, "kind"), orl_get_text(job, "state"));
    if (*orl_get_text(job, "client"))
        printf("client   %s\n", orl_get_text(job, "client"));
    if (*orl_get_text(job, "evicted"))
        printf("results  removed at %s to make room\n", orl_get_text(job, "evicted"));
    if (position > 0)
        printf("queue    %.0f\n", position);
    if (*orl_get_text(job, "stage"))
        printf("stage    %s\n", orl_get_text(job, "stage"));
    printf("percent  %.1f\n", orl_get_number(job, "percent", 0));
    if (eta_s >= 0) {
        orl_format_duration(eta_s, text, sizeof text);
        printf("eta      %s\n", text);
    }
    json_array_foreach(maps, i, map)
    {
        orl_format_map(map, text, sizeof text);
        printf("%s\n", text);
    }
    json_array_foreach(json_object_get(job, "warnings"), i, warning)
    {
        printf("warning  %s\n", json_string_value(warning));
    }
    print_study(json_object_get(job, "study"));
    orl_print_verdicts(stdout, json_object_get(json_object_get(job, "annual"), "verdicts"));
    if (json_object_get(job, "bsdf"))
        printf("bsdf     %s\n", orl_get_text(json_object_get(job, "bsdf"), "id"));
    orl_report_job_error(job);
}

/* Appends "&tag=..." to the path if the option is given. */
static int add_filter(char *path, size_t size, const char *name, const char *value,
                      struct orl_error *err)
{
    char escaped[512];
    const size_t used = strlen(path);
    if (!value)
        return 0;
    int rc = orl_http_escape(value, escaped, sizeof escaped, err);
    if (rc == 0)
        snprintf(path + used, size - used, "&%s=%s", name, escaped);
    return rc;
}

int orl_cmd_status(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *state = NULL, *tag = NULL, *scene = NULL, *since = NULL, *limit = NULL;
    enum { OPTIONS = 6 };
    const struct orl_option options[OPTIONS] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"state", 0, "queued|running|succeeded|failed|cancelled", "only jobs in that state", &state,
         NULL},
        {"tag", 0, "TAG", "only jobs with that tag", &tag, NULL},
        {"scene", 0, "ID", "only jobs of that scene", &scene, NULL},
        {"since", 0, "TIME", "only jobs submitted at that time or later: 2026-11-23T08:00:00Z",
         &since, NULL},
        {"limit", 0, "N", "largest number of jobs (100)", &limit, NULL},
    };
    char path[2048] = "/v1/jobs?fields=summary";
    json_t *reply = NULL;
    int rc;
    if (!orl_options_parse(self, argc, argv, options, OPTIONS, 0, 1, &daemon.operands, &rc))
        return rc;
    rc = orl_daemon_open(&daemon);
    if (rc == 0 && daemon.operands.count)
        rc = orl_job_path(daemon.operands.items[0], "", path, sizeof path, &daemon.err);
    for (int i = 1; i < OPTIONS && !daemon.operands.count && rc == 0; i++)
        rc = add_filter(path, sizeof path, options[i].name, *options[i].value, &daemon.err);
    if (rc == 0)
        rc = orl_http_call(&daemon.http, "GET", path, &reply, &daemon.err);
    if (rc == 0 && daemon.operands.count)
        print_job(reply);
    else if (rc == 0)
        orl_print_jobs(json_object_get(reply, "jobs"));
    json_decref(reply);
    return orl_daemon_end(&daemon, rc);
}

/*
 * oriel watch: prints all jobs of a daemon as they change, one line per change, from its event
 * stream. It ends when the stream is refused or the daemon stays away.
 */
#include "options/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "output/reports.h"
#include "output/terminal.h"

/* Seconds to wait for an absent daemon, and percent between two lines of a running job. */
#define PATIENCE_S 60.0
#define PERCENT_STEP 10.0

/* State of the event parser, and the job summaries printed so far. */
struct watch {
    char event[32], id[64], last_id[64];
    char *data;
    json_t *printed_jobs; /* last printed summary of each job, by id */
    bool received;        /* true if anything was received since connecting */
};

/* Returns true if the job differs from its printed summary: state, error, or PERCENT_STEP more
 * progress. */
static bool has_changed(const json_t *printed_jobs, const json_t *job)
{
    const double percent = orl_get_number(job, "percent", 0);
    return !printed_jobs ||
           strcmp(orl_get_text(printed_jobs, "state"), orl_get_text(job, "state")) != 0 ||
           !json_equal(json_object_get(printed_jobs, "error"), json_object_get(job, "error")) ||
           fabs(percent - orl_get_number(printed_jobs, "percent", 0)) >= PERCENT_STEP;
}

static void handle_job(struct watch *watch, json_t *job)
{
    const char *id = orl_get_text(job, "id");
    if (!has_changed(json_object_get(watch->printed_jobs, id), job))
        return;
    orl_print_job(job);
    json_object_set(watch->printed_jobs, id, job);
}

static void handle_event(struct watch *watch)
{
    json_t *doc = watch->data ? json_loads(watch->data, 0, NULL) : NULL;
    if (doc && strcmp(watch->event, "job") == 0) {
        handle_job(watch, doc);
    } else if (doc && strcmp(watch->event, "removed") == 0) {
        printf("%-8.8s  removed\n", orl_get_text(doc, "id"));
        json_object_del(watch->printed_jobs, orl_get_text(doc, "id"));
    }
    json_decref(doc);
    free(watch->data);
    watch->data = NULL;
    memcpy(watch->last_id, watch->id, sizeof watch->last_id);
}

/* Parses a line of the stream (WHATWG HTML, 9.2.6); an empty line ends an event. */
static bool on_line(void *ctx, const char *line)
{
    struct watch *watch = ctx;
    watch->received = true;
    if (strncmp(line, "event: ", 7) == 0) {
        snprintf(watch->event, sizeof watch->event, "%s", line + 7);
    } else if (strncmp(line, "id: ", 4) == 0) {
        snprintf(watch->id, sizeof watch->id, "%s", line + 4);
    } else if (strncmp(line, "data: ", 6) == 0) {
        free(watch->data);
        watch->data = strdup(line + 6);
    } else if (!*line) {
        handle_event(watch);
        watch->event[0] = '\0';
    }
    return true;
}

/* Prints the existing jobs, oldest first. */
static int list_jobs(struct orl_http *http, struct watch *watch, const char *filters,
                     struct orl_error *err)
{
    char path[2048];
    json_t *reply = NULL;
    snprintf(path, sizeof path, "/v1/jobs?fields=summary%s", filters);
    const int rc = orl_http_call(http, "GET", path, &reply, err);
    json_t *jobs = json_object_get(reply, "jobs");
    for (size_t i = json_array_size(jobs); rc == 0 && i > 0; i--)
        handle_job(watch, json_array_get(jobs, i - 1));
    json_decref(reply);
    return rc;
}

static void pause_s(double seconds)
{
    const struct timespec span = {(time_t)seconds, 0};
    nanosleep(&span, NULL);
}

/* Reads events, and reconnects after an interruption unless the daemon is away for too long. */
static int follow_events(struct orl_http *http, struct watch *watch, const char *filters,
                         struct orl_error *err)
{
    double silent_since_s = orl_clock_s(NULL);
    char path[2048];
    int rc = 0;
    snprintf(path, sizeof path, "/v1/events%s%s", *filters ? "?" : "", *filters ? filters + 1 : "");
    while (rc == 0) {
        watch->received = false;
        rc = orl_http_stream(http, path, watch->last_id, on_line, watch, err);
        if (watch->received)
            silent_since_s = orl_clock_s(NULL);
        if (rc == ORL_ERR_IO && http->status == 0 &&
            orl_clock_s(NULL) - silent_since_s < PATIENCE_S)
            rc = 0;
        if (rc == 0)
            pause_s(1);
    }
    return rc;
}

int orl_cmd_watch(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *tag = NULL;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"tag", 0, "TAG", "only jobs with that tag", &tag, NULL},
    };
    struct watch watch = {.printed_jobs = json_object()};
    char filters[600] = "", escaped[512];
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 2, 0, 0, &daemon.operands, &rc)) {
        json_decref(watch.printed_jobs);
        return rc;
    }
    rc = orl_daemon_open(&daemon);
    if (rc == 0 && tag)
        rc = orl_http_escape(tag, escaped, sizeof escaped, &daemon.err);
    if (rc == 0 && tag)
        snprintf(filters, sizeof filters, "&tag=%s", escaped);
    if (rc == 0) {
        orl_print_job_heading();
        rc = list_jobs(&daemon.http, &watch, filters, &daemon.err);
    }
    if (rc == 0)
        rc = follow_events(&daemon.http, &watch, filters, &daemon.err);
    json_decref(watch.printed_jobs);
    free(watch.data);
    orl_http_close(&daemon.http);
    return orl_report_error(&daemon.err);
}

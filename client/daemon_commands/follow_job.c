#include "daemon_commands/follow_job.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "http/json_get.h"
#include "options/command.h"
#include "output/reports.h"
#include "output/style.h"
#include "output/terminal.h"

/* Seconds to wait for a daemon that stopped answering, because it may be restarting. */
#define RECONNECT_LIMIT_S 60.0

int orl_daemon_open(struct orl_daemon_command *command)
{
    return orl_http_open(&command->http, command->server, &command->err);
}

int orl_daemon_end(struct orl_daemon_command *command, int rc)
{
    orl_http_close(&command->http);
    return rc ? orl_report_error(&command->err) : ORL_EXIT_OK;
}

int orl_job_path(const char *id, const char *rest, char *ret_path, size_t size,
                 struct orl_error *err)
{
    char escaped[512];
    const int rc = orl_http_escape(id, escaped, sizeof escaped, err);
    if (rc)
        return rc;
    int length = snprintf(ret_path, size, "/v1/jobs/%s%s", escaped, rest);
    if (length < 0 || (size_t)length >= size)
        return orl_error_set(err, ORL_ERR_LIMIT, "the job's address is too long");
    return 0;
}

void orl_format_map(const json_t *map, char *ret_text, size_t size)
{
    const double seconds = orl_get_number(map, "seconds", 0);
    const double reused = orl_get_number(map, "reused", 0);
    char stored[32], bytes[32], before[32];
    if (strcmp(orl_get_text(map, "kind"), "made") == 0) {
        orl_format_amount(orl_get_number(map, "emitted", 0), "", stored, sizeof stored);
        snprintf(ret_text, size, "BSDF: %s %.1f s (from %s paths or measured rows)",
                 orl_get_true(map, "cached") ? "found in the cache, made in" : "made in", seconds,
                 stored);
        return;
    }
    orl_format_amount(orl_get_number(map, "stored", 0), "", stored, sizeof stored);
    orl_format_amount(orl_get_number(map, "bytes", 0), "B", bytes, sizeof bytes);
    orl_format_amount(reused, "", before, sizeof before);
    if (orl_get_true(map, "cached"))
        snprintf(ret_text, size, "%s map: found in the cache (%s photons, %s), %.1f s saved",
                 orl_get_text(map, "kind"), stored, bytes, seconds);
    else if (reused > 0)
        snprintf(ret_text, size, "%s map: topped up from %s photons (%s photons, %s)",
                 orl_get_text(map, "kind"), before, stored, bytes);
    else
        snprintf(ret_text, size, "%s map: built in %.1f s (%s photons, %s)",
                 orl_get_text(map, "kind"), seconds, stored, bytes);
}

/* Facts reported so far. */
struct reported {
    char sky[80];
    bool technique, runner;
    size_t maps, points;
    double rounds;
};

/* Reports each warning of the job once. *reported_warnings is created if NULL. */
static void report_warnings(struct orl_progress_line *progress, const json_t *job,
                            json_t **reported_warnings)
{
    const json_t *warnings = json_object_get(job, "warnings"), *warning;
    size_t i;
    if (!*reported_warnings)
        *reported_warnings = json_object();
    json_array_foreach(warnings, i, warning)
    {
        const char *text = json_string_value(warning);
        if (!text || json_object_get(*reported_warnings, text))
            continue;
        json_object_set_new(*reported_warnings, text, json_true());
        orl_progress_warn(progress, text);
    }
}

/* Reports which of several skies is being rendered; all further lines are about that sky. */
static void report_sky(struct orl_progress_line *progress, const json_t *job,
                       struct reported *reported)
{
    const json_t *skies = json_object_get(job, "skies");
    const char *sky = orl_get_text(skies, "running");
    if (!*sky || strcmp(reported->sky, sky) == 0)
        return;
    *reported = (struct reported){.technique = true, .runner = true};
    snprintf(reported->sky, sizeof reported->sky, "%s", sky);
    orl_progress_note(progress, "sky %s (%.0f of %.0f done)", sky, orl_get_number(skies, "done", 0),
                      orl_get_number(skies, "count", 0));
}

/* Reports once where the job runs, and why. */
static void report_runner(struct orl_progress_line *progress, const json_t *job, bool *reported)
{
    const json_t *runner = json_object_get(job, "runner");
    const bool slurm = strcmp(orl_get_text(runner, "name"), "slurm") == 0;
    if (runner && !*reported)
        orl_progress_note(progress, "%s: %s",
                          slurm ? "runs in parts with Slurm" : "runs in the daemon",
                          orl_get_text(runner, "why"));
    *reported = *reported || runner;
}

/* Reports once which technique the plan chose. */
static void report_technique(struct orl_progress_line *progress, const json_t *job, bool *reported)
{
    const char *technique = orl_get_text(job, "technique");
    if (*technique && !*reported)
        orl_progress_note(progress, "plan: %s", technique);
    *reported = *reported || *technique;
}

/* Reports once for each map of the job whether it was built or found. */
static void report_maps(struct orl_progress_line *progress, const json_t *job, size_t *reported)
{
    const json_t *maps = json_object_get(job, "maps");
    for (; *reported < json_array_size(maps); ++*reported) {
        char text[256];
        orl_format_map(json_array_get(maps, *reported), text, sizeof text);
        orl_progress_note(progress, "%s", text);
    }
}

/* Reports once the result of each point of a study. */
static void report_points(struct orl_progress_line *progress, const json_t *job, size_t *reported)
{
    const json_t *points = json_object_get(json_object_get(job, "study"), "points");
    for (; *reported < json_array_size(points); ++*reported) {
        char text[160];
        orl_format_study_point(json_array_get(points, *reported), text, sizeof text);
        orl_progress_note(progress, "%s", text);
    }
}

/* Reports once the result of each round of a job with a goal, except rounds between two polls. */
static void report_round(struct orl_progress_line *progress, const json_t *job, double *reported)
{
    const json_t *accuracy = json_object_get(job, "accuracy");
    const double rounds = orl_get_number(accuracy, "rounds", 0);
    const double error = orl_get_number(accuracy, "achieved", -1);
    if (!(rounds > *reported))
        return;
    *reported = rounds;
    if (error < 0)
        orl_progress_note(progress, "round %.0f: error not known yet", rounds);
    else if (json_object_get(json_object_get(accuracy, "asked"), "dgp_error"))
        orl_progress_note(progress, "round %.0f: DGP error %.2g", rounds, error);
    else
        orl_progress_note(progress, "round %.0f: error %.3g %%", rounds, 100 * error);
}

/* Reports likewise the rounds of a year with a verdict to settle. */
static void report_verdict(struct orl_progress_line *progress, const json_t *job, double *reported)
{
    const json_t *accuracy = json_object_get(json_object_get(job, "annual"), "accuracy");
    const json_t *interval = json_object_get(accuracy, "interval_95");
    const double rounds = orl_get_number(accuracy, "rounds", 0);
    if (!(rounds > *reported))
        return;
    *reported = rounds;
    orl_progress_note(
        progress, "round %.0f: %s: %.4g [%.4g, %.4g], %s; %.0f sensors refined", rounds,
        orl_get_text(accuracy, "target"), orl_get_number(accuracy, "value", NAN),
        json_number_value(json_array_get(interval, 0)),
        json_number_value(json_array_get(interval, 1)), orl_get_text(accuracy, "verdict"),
        orl_get_number(accuracy, "refined_sensors", 0));
}

static void report_timings(json_t *job)
{
    json_t *timings = json_object_get(job, "timings_s"), *value;
    const char *name;
    if (json_object_size(timings) == 0)
        return;
    fprintf(stderr, "seconds:");
    json_object_foreach(timings, name, value)
    {
        fprintf(stderr, " %s %.2f", name, json_number_value(value));
    }
    fputc('\n', stderr);
}

/* Reports how the job ended; returns the exit code. */
static int report_end(json_t *job, const char *id)
{
    const char *state = orl_get_text(job, "state");
    const json_t *accuracy = json_object_get(job, "accuracy");
    orl_report_job_error(job);
    if (accuracy)
        fprintf(stderr, "accuracy: %s: %s\n",
                json_is_true(json_object_get(accuracy, "met")) ? "met" : "not met",
                orl_get_text(accuracy, "why"));
    report_timings(job);
    orl_print_verdicts(stderr, json_object_get(json_object_get(job, "annual"), "verdicts"));
    if (json_object_get(job, "bsdf"))
        fprintf(stderr, "BSDF %s, which scenes can use by name\n",
                orl_get_text(json_object_get(job, "bsdf"), "id"));
    fprintf(stderr, "job %s: %s%s%s\n", id, orl_style_begin(stderr, orl_style_of_word(state)),
            state, orl_style_end(stderr));
    return strcmp(state, "succeeded") == 0 ? ORL_EXIT_OK : ORL_EXIT_FAILED;
}

static void pause_s(double seconds)
{
    const struct timespec span = {(time_t)seconds,
                                  (long)((seconds - (double)(time_t)seconds) * 1e9)};
    nanosleep(&span, NULL);
}

static void show_job(struct orl_progress_line *progress, const json_t *job)
{
    const char *state = orl_get_text(job, "state"), *stage = orl_get_text(job, "stage");
    if (!*stage)
        stage = orl_get_text(json_object_get(job, "study"), "running");
    if (strcmp(state, "queued") == 0)
        stage = "queued";
    orl_progress_show(progress, *stage ? stage : state, orl_get_number(job, "percent", 0) / 100,
                      orl_get_number(job, "eta_s", NAN));
}

bool orl_job_has_ended(const json_t *job)
{
    const char *state = orl_get_text(job, "state");
    return strcmp(state, "succeeded") == 0 || strcmp(state, "failed") == 0 ||
           strcmp(state, "cancelled") == 0;
}

int orl_await_job(struct orl_http *http, const char *id, json_t **ret_job, struct orl_error *err)
{
    char path[1024];
    json_t *job = NULL;
    int rc = orl_job_path(id, "", path, sizeof path, err);
    while (rc == 0) {
        rc = orl_http_call(http, "GET", path, &job, err);
        if (rc == 0 && orl_job_has_ended(job)) {
            *ret_job = job;
            return 0;
        }
        json_decref(job);
        job = NULL;
        if (rc == 0)
            pause_s(0.1);
    }
    return rc;
}

int orl_follow_job(struct orl_http *http, const char *id)
{
    struct orl_progress_line progress;
    struct orl_error err = {0};
    char path[1024];
    struct reported reported = {0};
    json_t *reported_warnings = NULL;
    double silent_since_s = -1, wait_s = 0.1;
    int rc = orl_job_path(id, "", path, sizeof path, &err);
    orl_progress_start(&progress);
    while (rc == 0) {
        json_t *job = NULL;
        int code = -1;
        rc = orl_http_call(http, "GET", path, &job, &err);
        if (rc == 0) {
            silent_since_s = -1;
            report_sky(&progress, job, &reported);
            report_runner(&progress, job, &reported.runner);
            report_technique(&progress, job, &reported.technique);
            report_maps(&progress, job, &reported.maps);
            report_points(&progress, job, &reported.points);
            report_round(&progress, job, &reported.rounds);
            report_verdict(&progress, job, &reported.rounds);
            report_warnings(&progress, job, &reported_warnings);
            if (orl_job_has_ended(job)) {
                orl_progress_end(&progress);
                code = report_end(job, id);
            } else {
                show_job(&progress, job);
            }
            json_decref(job);
            if (code >= 0) {
                json_decref(reported_warnings);
                return code;
            }
        } else if (rc == ORL_ERR_IO && http->status == 0) {
            if (silent_since_s < 0) {
                silent_since_s = orl_clock_s(NULL);
                orl_progress_note(&progress, "the daemon does not answer; trying again");
            }
            if (orl_clock_s(NULL) - silent_since_s < RECONNECT_LIMIT_S)
                rc = 0;
        }
        pause_s(wait_s);
        wait_s = wait_s < 0.5
                     ? wait_s * 1.25
                     : wait_s; /* short jobs are noticed quickly, long ones polled rarely */
    }
    orl_progress_end(&progress);
    json_decref(reported_warnings);
    return orl_report_error(&err);
}

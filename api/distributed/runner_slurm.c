/*
 * Runs Slurm's commands (22.05 and later), each with an argument vector: sbatch, squeue and
 * scancel. User input reaches them only as option words; the script contains none.
 *
 * A round's tasks are identified by their name alone. If an sbatch was cut off, its tasks are
 * looked up by name before anything is submitted again, so that none is submitted twice.
 */
#include "distributed/runner.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <oriel/base/files.h>

#include "distributed/atomic_files.h"

/* Interval of queries to Slurm about a round, in seconds. It grows with the round's age
 * (query_share of it), which bounds the total number of queries. */
static const double query_least_s = 1, query_most_s = 30, query_share = 0.02;
/* Seconds that cancelled tasks may take to end. */
static const double cancel_s = 60;
/* Seconds in which an interrupted sbatch may still submit its tasks. */
static const double doubt_s = 5;

static const char script[] = "#!/bin/sh\n"
                             "# One part of a job: the program, the shared folder, the wave.\n"
                             "exec \"$1\" part \"$2/$3-$SLURM_ARRAY_TASK_ID.json\"\n";

struct slurm_part {
    struct orl_part_status status; /* state at the last query */
    struct orl_part_limits limits; /* requested limits */
    bool unsent;                   /* true until it is submitted */
};

struct slurm {
    struct orl_runner_spec spec;
    char script[4200];
    char round[ORL_TASK_ROUND_NAME];
    double began_s, queried_s, answered_s;
    struct orl_slurm_bounds bounds;
    struct slurm_part *parts; /* parts of the round */
    size_t n;
    bool known;    /* true if Slurm was queried since the last submission */
    bool in_doubt; /* true if sbatch may have submitted unsent parts */
};

static double now_s(const struct slurm *slurm)
{
    return slurm->spec.now_s(NULL);
}

/* Makes the name of a round's tasks. */
static void name_tasks(const char *job, const char *round, char ret_name[128])
{
    snprintf(ret_name, 128, "oriel-%.12s-%.*s", job, ORL_TASK_ROUND_NAME, round);
}

/* Allocates state for a round, unless it is the current one. */
static int begin_round(struct slurm *slurm, const char *round, size_t n, struct orl_error *err)
{
    if (slurm->parts && strcmp(slurm->round, round) == 0)
        return 0;
    free(slurm->parts);
    slurm->parts = calloc(n + 1, sizeof *slurm->parts);
    slurm->n = n;
    slurm->in_doubt = slurm->known = false;
    slurm->began_s = slurm->answered_s = now_s(slurm);
    slurm->queried_s = -query_most_s;
    snprintf(slurm->round, sizeof slurm->round, "%s", round);
    return slurm->parts ? 0 : orl_error_no_memory(err);
}

/* Cuts the text after its first line and returns it, for messages. */
static const char *first_line(char *text)
{
    text += strspn(text, " \t\r\n");
    char *end = strchr(text, '\n');
    if (end)
        *end = '\0';
    return text;
}

/* ---- Submission ------------------------------------------------------------------------------ */

static bool is_same(struct orl_part_limits a, struct orl_part_limits b)
{
    return a.minutes == b.minutes && a.mib == b.mib;
}

/* Returns true if part i is unsent and is requested with these limits. */
static bool is_next(const struct slurm *slurm, size_t i, struct orl_part_limits limits)
{
    return i < slurm->n && slurm->parts[i].unsent && is_same(slurm->parts[i].limits, limits);
}

/* Returns "--array=0-7,9%64", owned by the caller. */
static char *list_unsent(const struct slurm *slurm, struct orl_part_limits limits)
{
    const size_t room = 12 * (slurm->n + 3);
    char *text = malloc(room);
    size_t at = text ? (size_t)snprintf(text, room, "--array=") : 0, listed = 0;
    for (size_t i = 0; text && i < slurm->n; i++) {
        size_t last = i;
        if (!is_next(slurm, i, limits))
            continue;
        while (is_next(slurm, last + 1, limits))
            last++;
        at += (size_t)snprintf(text + at, room - at, listed++ > 0 ? ",%zu" : "%zu", i);
        if (last > i)
            at += (size_t)snprintf(text + at, room - at, "-%zu", last);
        i = last;
    }
    if (text)
        snprintf(text + at, room - at, "%%%u", slurm->spec.most);
    return text;
}

/* Runs sbatch. limits: within Slurm's bounds. */
static int run_sbatch(const struct slurm *slurm, char *array, struct orl_part_limits limits,
                      char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err)
{
    char time[32], memory[32];
    char cpus[48], chdir_to[4200], tasks[128], name[160], program[4096], folder[4096], round[64];
    char *argv[ORL_SBATCH_OPTIONS_MAX + 18];
    size_t n = 0;
    name_tasks(slurm->spec.job, slurm->round, tasks);
    snprintf(name, sizeof name, "--job-name=%s", tasks);
    snprintf(cpus, sizeof cpus, "--cpus-per-task=%u", slurm->spec.threads);
    snprintf(chdir_to, sizeof chdir_to, "--chdir=%s", slurm->spec.folder);
    snprintf(program, sizeof program, "%s", slurm->spec.program);
    snprintf(folder, sizeof folder, "%s", slurm->spec.folder);
    snprintf(round, sizeof round, "%s", slurm->round);
    snprintf(time, sizeof time, "--time=%u", limits.minutes);
    snprintf(memory, sizeof memory, "--mem=%uM", limits.mib);
    argv[n++] = (char *)"sbatch";
    argv[n++] = (char *)"--parsable";
    argv[n++] = name;
    argv[n++] = (char *)"--ntasks=1";
    argv[n++] = (char *)"--requeue";
    argv[n++] = (char *)"--output=slurm-%A_%a.log";
    argv[n++] = cpus;
    argv[n++] = chdir_to;
    argv[n++] = array;
    if (limits.minutes > 0)
        argv[n++] = time;
    if (limits.mib > 0)
        argv[n++] = memory;
    for (size_t i = 0; i < slurm->spec.n_words; i++)
        argv[n++] = (char *)(uintptr_t)slurm->spec.words[i];
    argv[n++] = (char *)(uintptr_t)slurm->script;
    argv[n++] = program;
    argv[n++] = folder;
    argv[n++] = round;
    argv[n] = NULL;
    /* Not cancellable: an interrupted sbatch might submit the tasks later. */
    return orl_command_run(argv, slurm->spec.command_s, NULL, ret_output, err);
}

/* Records Slurm's job number in WAVE.slurm, for users who read the cluster's log. */
static uint32_t record_job_number(const struct slurm *slurm, char *output)
{
    char path[4300];
    output[strspn(output, "0123456789")] = '\0'; /* "ID;CLUSTER" */
    snprintf(path, sizeof path, "%s/%s.slurm", slurm->spec.folder, slurm->round);
    FILE *file = orl_fopen_regular(path, 'a');
    if (file) {
        fprintf(file, "%s\n", output);
        fclose(file);
    }
    return (uint32_t)strtoul(output, NULL, 10);
}

/* Marks the parts as submitted under that task number. */
static void mark_sent(struct slurm *slurm, struct orl_part_limits requested,
                      struct orl_part_limits granted, uint32_t task)
{
    for (size_t i = 0; i < slurm->n; i++)
        if (is_next(slurm, i, requested)) {
            slurm->parts[i].unsent = false;
            slurm->parts[i].status = (struct orl_part_status){ORL_PART_UNKNOWN, task, granted};
        }
}

/* Submits the unsent parts with these limits. */
static int submit_group(struct slurm *slurm, struct orl_part_limits limits, struct orl_error *err)
{
    const struct orl_part_limits granted = orl_slurm_bounded(&slurm->bounds, limits);
    char *array = list_unsent(slurm, limits), output[ORL_COMMAND_OUTPUT] = "";
    int rc = array ? run_sbatch(slurm, array, granted, output, err) : orl_error_no_memory(err);
    free(array);
    if (rc == 0 && isdigit((unsigned char)output[0])) {
        mark_sent(slurm, limits, granted, record_job_number(slurm, output));
    } else if (rc == ORL_ERR_IO || (rc >= 0 && orl_slurm_is_temporary_failure(output))) {
        slurm->in_doubt = true;
        rc = 0;
    } else if (rc >= 0) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "sbatch: %.300s", first_line(output));
    } else if (rc == ORL_ERR_NOT_FOUND) {
        orl_error_hint(err, "run this where sbatch, squeue and scancel are on PATH");
    }
    return rc;
}

/* Submits all unsent parts, one array for each set of limits. If Slurm is unavailable they stay
 * unsent. */
static int submit_unsent(struct slurm *slurm, struct orl_error *err)
{
    int rc = 0;
    if (!slurm->bounds.known)
        orl_slurm_bounds_query(&slurm->spec, &slurm->bounds);
    for (size_t i = 0; i < slurm->n && rc == 0 && !slurm->in_doubt; i++)
        if (slurm->parts[i].unsent)
            rc = submit_group(slurm, slurm->parts[i].limits, err);
    return rc;
}

static int slurm_start(void *ctx, const char *round, const struct orl_part_request *requests,
                       size_t n, size_t n_all, struct orl_error *err)
{
    struct slurm *slurm = ctx;
    int rc = begin_round(slurm, round, n_all, err);
    if (rc)
        return rc;
    for (size_t i = 0; i < n; i++) {
        slurm->parts[requests[i].number].unsent = true;
        slurm->parts[requests[i].number].limits = requests[i].limits;
    }
    if (!slurm->in_doubt)
        rc = submit_unsent(slurm, err);
    slurm->queried_s = now_s(slurm); /* submitted tasks take a moment to appear */
    slurm->known = false;
    return rc;
}

/* ---- Queries --------------------------------------------------------------------------------- */

static enum orl_part_state state_of(const char *code)
{
    static const char *const waiting[] = {"PD", "CF", "RQ", "RH", "RF", "SE", "RS", "S", "ST"};
    for (size_t i = 0; i < sizeof waiting / sizeof *waiting; i++)
        if (strcmp(code, waiting[i]) == 0)
            return ORL_PART_WAITING;
    return strcmp(code, "R") == 0 || strcmp(code, "CG") == 0 || strcmp(code, "SO") == 0
               ? ORL_PART_RUNNING
               : ORL_PART_GONE;
}

/* Reads lines "NUMBER|STATE|TASK". A part that is listed was submitted. */
static void read_states(struct slurm *slurm, char *text)
{
    char *rest = text, *line;
    while ((line = strsep(&rest, "\n")) != NULL) {
        char *bar = strchr(line, '|'), *end;
        unsigned long number = strtoul(line, &end, 10);
        if (!bar || end == line || end != bar || number >= slurm->n)
            continue;
        struct slurm_part *part = &slurm->parts[number];
        const char *task = strchr(bar + 1, '|');
        const unsigned long its_task = task ? strtoul(task + 1, NULL, 10) : 0;
        bar[1 + strcspn(bar + 1, " |")] = '\0';
        const enum orl_part_state state = state_of(bar + 1);
        if (state == ORL_PART_GONE)
            continue;
        part->status.state = state;
        part->unsent = false;
        if (its_task > 0)
            part->status.task = (uint32_t)its_task;
    }
}

/* Lists active tasks of that name. Returns squeue's exit status, or a negative orl_err. */
static int run_squeue(const char *tasks, double limit_s, const atomic_bool *cancel,
                      char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err)
{
    char name[160];
    char *argv[] = {(char *)"squeue",
                    (char *)"--noheader",
                    (char *)"--array",
                    (char *)"--me",
                    (char *)"--format=%K|%t|%F",
                    name,
                    NULL};
    snprintf(name, sizeof name, "--name=%s", tasks);
    return orl_command_run(argv, limit_s, cancel, ret_output, err);
}

/* Marks all states unknown because Slurm does not answer; fails after outage_limit_s. */
static int check_outage(struct slurm *slurm, const char *says, struct orl_error *err)
{
    const double outage_limit_s = slurm->spec.outage_limit_s;
    for (size_t i = 0; i < slurm->n; i++)
        slurm->parts[i].status.state = ORL_PART_UNKNOWN;
    if (now_s(slurm) - slurm->answered_s < outage_limit_s)
        return 0;
    orl_error_set(err, ORL_ERR_IO, "Slurm has not answered for %.0f s: %.200s", outage_limit_s,
                  says);
    orl_error_hint(err, "see `scontrol ping`; once slurmctld answers, run the same job again: it "
                        "reuses the finished parts");
    return ORL_ERR_IO;
}

static int query_slurm(struct slurm *slurm, struct orl_error *err)
{
    struct orl_error why = {0};
    char tasks[128], output[ORL_COMMAND_OUTPUT];
    name_tasks(slurm->spec.job, slurm->round, tasks);
    int rc = run_squeue(tasks, slurm->spec.command_s, slurm->spec.cancel, output, &why);
    if (rc != 0) {
        const char *says = rc > 0 ? first_line(output) : why.message;
        if (rc == ORL_ERR_CANCELLED || rc == ORL_ERR_NOT_FOUND || rc == ORL_ERR_NOMEM)
            rc = orl_error_set(err, rc, "%s", why.message);
        else
            rc = check_outage(slurm, says, err);
        return rc;
    }
    for (size_t i = 0; i < slurm->n; i++)
        slurm->parts[i].status.state = ORL_PART_GONE;
    read_states(slurm, output);
    slurm->answered_s = now_s(slurm);
    slurm->in_doubt = false;
    slurm->known = true;
    return 0;
}

static bool any_unsent(const struct slurm *slurm)
{
    bool any = false;
    for (size_t i = 0; i < slurm->n; i++)
        any = any || slurm->parts[i].unsent;
    return any;
}

static int refresh_states(struct slurm *slurm, struct orl_error *err)
{
    int rc = query_slurm(slurm, err);
    if (rc == 0 && !slurm->in_doubt && any_unsent(slurm))
        rc = submit_unsent(slurm, err);
    slurm->queried_s = now_s(slurm);
    return rc;
}

static int slurm_poll(void *ctx, const char *round, struct orl_part_status *ret_status, size_t n,
                      struct orl_error *err)
{
    struct slurm *slurm = ctx;
    int rc = begin_round(slurm, round, n, err);
    if (rc)
        return rc;
    const double now = now_s(slurm), share = query_share * (now - slurm->began_s);
    const double every = share < query_least_s  ? query_least_s
                         : share > query_most_s ? query_most_s
                                                : share;
    if (now - slurm->queried_s >= every)
        rc = refresh_states(slurm, err);
    for (size_t i = 0; i < n; i++) {
        const struct slurm_part *part = &slurm->parts[i];
        ret_status[i] = part->status;
        if (part->unsent)
            ret_status[i].state = ORL_PART_WAITING;
        else if (!slurm->known)
            ret_status[i].state = ORL_PART_UNKNOWN;
    }
    return rc;
}

static enum orl_part_end slurm_end(void *ctx, const char *round, uint32_t number)
{
    const struct slurm *slurm = ctx;
    char tasks[128];
    name_tasks(slurm->spec.job, round, tasks);
    return number < slurm->n
               ? orl_slurm_end_reason(&slurm->spec, tasks, slurm->parts[number].status.task, number)
               : ORL_PART_ENDED;
}

/* ---- Cancelling ------------------------------------------------------------------------------ */

static void sleep_briefly(void)
{
    const struct timespec moment = {.tv_nsec = 200000000};
    nanosleep(&moment, NULL);
}

/* Cancels until no task is left, and for at least least_s seconds, so that tasks submitted late
 * are cancelled too. */
static int cancel_tasks(const struct orl_runner_spec *spec, const char *round, double least_s,
                        struct orl_error *err)
{
    const double began = spec->now_s(NULL);
    const double limit_s = spec->command_s > 0 ? spec->command_s : ORL_SLURM_COMMAND_S;
    char name[160], tasks[128], output[ORL_COMMAND_OUTPUT];
    char *argv[] = {(char *)"scancel", (char *)"--me", name, NULL};
    bool gone = false;
    name_tasks(spec->job, round, tasks);
    snprintf(name, sizeof name, "--name=%s", tasks);
    while (!gone && spec->now_s(NULL) - began < cancel_s) {
        orl_command_run(argv, limit_s, NULL, output, NULL);
        gone = run_squeue(tasks, limit_s, NULL, output, NULL) == 0 && output[0] == '\0';
        gone = gone && spec->now_s(NULL) - began >= least_s;
        if (!gone)
            sleep_briefly();
    }
    if (gone)
        return 0;
    orl_error_set(err, ORL_ERR_IO, "Slurm tasks named %s may still be running", tasks);
    orl_error_hint(err, "cancel them with scancel --name=%s", tasks);
    return ORL_ERR_IO;
}

int orl_slurm_cancel(const struct orl_runner_spec *spec, const char *round, struct orl_error *err)
{
    return cancel_tasks(spec, round, 0, err);
}

static int slurm_cancel(void *ctx, const char *round, struct orl_error *err)
{
    const struct slurm *slurm = ctx;
    return cancel_tasks(&slurm->spec, round, slurm->in_doubt ? doubt_s : 0, err);
}

static void slurm_done(void *ctx)
{
    struct slurm *slurm = ctx;
    free(slurm->parts);
    free(slurm);
}

/* ---- The runner ------------------------------------------------------------------------------ */

int orl_runner_slurm(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err)
{
    struct slurm *slurm = calloc(1, sizeof *slurm);
    if (!slurm)
        return orl_error_no_memory(err);
    slurm->spec = *spec;
    if (spec->outage_limit_s <= 0)
        slurm->spec.outage_limit_s = ORL_SLURM_OUTAGE_LIMIT_S;
    if (spec->command_s <= 0)
        slurm->spec.command_s = ORL_SLURM_COMMAND_S;
    snprintf(slurm->script, sizeof slurm->script, "%s/part.sh", spec->folder);
    int rc = spec->n_words <= ORL_SBATCH_OPTIONS_MAX
                 ? orl_write_text(slurm->script, script, sizeof script - 1, err)
                 : orl_error_set(err, ORL_ERR_LIMIT, "more than %d options for sbatch",
                                 ORL_SBATCH_OPTIONS_MAX);
    if (rc) {
        slurm_done(slurm);
        return rc;
    }
    *ret_runner = (struct orl_runner){.ctx = slurm,
                                      .files_delay_s = 5,
                                      .start = slurm_start,
                                      .poll = slurm_poll,
                                      .end = slurm_end,
                                      .cancel = slurm_cancel,
                                      .done = slurm_done};
    return 0;
}

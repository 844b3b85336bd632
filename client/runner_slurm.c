/*
 * Slurm by its own commands (22.05 and later), each started with an argument vector: sbatch, squeue
 * and scancel. What they are given of a user's is words of --sbatch; the script has none of it.
 */
#include "runner.h"

#include <ctype.h>
#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "files.h"
#include "progress.h"

extern char **environ;

enum { MOST_WORDS = 64, MOST_WAVES = 256, MOST_OUTPUT = 1 << 20 };

/* Slurm is asked at most once in so many seconds. */
static const double asked_every_s = 1;

static const char script[] = "#!/bin/sh\n"
                             "# One part of a job: the program, the shared folder, the wave.\n"
                             "exec \"$1\" part \"$2/$3-$SLURM_ARRAY_TASK_ID.json\"\n";

struct slurm {
    const char *folder;
    uint32_t threads, most;
    char program[4096], script[4200];
    char *options;           /* owned; cut into words */
    char *words[MOST_WORDS]; /* in options */
    size_t n_words;
    char jobs[MOST_WAVES][32]; /* of the wave under way: one, and one for each time it was tried */
    size_t n_jobs;
    char wave[64];
    double asked_s;
    enum orl_part_state *states; /* as they were told last */
    size_t n_states;
};

/* ---- Commands -------------------------------------------------------------------------------- */

/* Runs one to its end; *ret_output: what it printed, errors included; owned. Returns its status, or
 * a negative orl_err. */
static int run(char *const argv[], char **ret_output, struct orl_error *err)
{
    posix_spawn_file_actions_t actions;
    int ends[2], status = 0, rc;
    char *output = malloc(MOST_OUTPUT + 1);
    size_t size = 0;
    ssize_t got;
    pid_t pid;

    if (!output || pipe(ends) != 0) {
        free(output);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory or descriptors");
    }
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    rc = posix_spawnp(&pid, argv[0], &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    while (rc == 0 && (got = read(ends[0], output + size, MOST_OUTPUT - size)) != 0) {
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 || (size += (size_t)got) == MOST_OUTPUT)
            break;
    }
    close(ends[0]);
    output[size] = '\0';
    if (rc == 0)
        while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
            ;
    *ret_output = output;
    if (rc == 0)
        return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
    orl_error_set(err, ORL_ERR_NOT_FOUND, "Slurm's command '%s' cannot be started: %s", argv[0],
                  strerror(rc));
    orl_error_hint(err, "run this where sbatch, squeue and scancel are on PATH");
    return ORL_ERR_NOT_FOUND;
}

/* Its first line, for messages. */
static void cut_line(char *text)
{
    text[strcspn(text, "\n")] = '\0';
}

/* ---- Start ----------------------------------------------------------------------------------- */

/* "0-7,9%64": owned. */
static char *list_numbers(const uint32_t *numbers, size_t n, uint32_t most)
{
    const size_t room = 12 * (n + 2);
    char *text = malloc(room);
    size_t at = 0;

    for (size_t i = 0; text && i < n; i++) {
        size_t last = i;

        while (last + 1 < n && numbers[last + 1] == numbers[last] + 1)
            last++;
        at += (size_t)snprintf(text + at, room - at, i == 0 ? "%u" : ",%u", numbers[i]);
        if (last > i)
            at += (size_t)snprintf(text + at, room - at, "-%u", numbers[last]);
        i = last;
    }
    if (text)
        snprintf(text + at, room - at, "%%%u", most);
    return text;
}

static int submit(struct slurm *slurm, const char *array, struct orl_error *err)
{
    char cpus[48], chdir_to[4200];
    char *argv[MOST_WORDS + 16];
    char *output = NULL, *array_word = NULL;
    size_t n = 0;
    int rc;

    if (asprintf(&array_word, "--array=%s", array) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    snprintf(cpus, sizeof cpus, "--cpus-per-task=%u", slurm->threads);
    snprintf(chdir_to, sizeof chdir_to, "--chdir=%s", slurm->folder);
    argv[n++] = (char *)"sbatch";
    argv[n++] = (char *)"--parsable";
    argv[n++] = (char *)"--job-name=oriel";
    argv[n++] = (char *)"--ntasks=1";
    argv[n++] = (char *)"--requeue";
    argv[n++] = (char *)"--output=slurm-%A_%a.log";
    argv[n++] = cpus;
    argv[n++] = chdir_to;
    argv[n++] = array_word;
    for (size_t i = 0; i < slurm->n_words; i++)
        argv[n++] = slurm->words[i];
    argv[n++] = slurm->script;
    argv[n++] = slurm->program;
    argv[n++] = (char *)(uintptr_t)slurm->folder;
    argv[n++] = slurm->wave;
    argv[n] = NULL;
    rc = run(argv, &output, err);
    if (rc == 0 && isdigit((unsigned char)output[0])) {
        output[strspn(output, "0123456789")] = '\0'; /* "ID;CLUSTER" */
        snprintf(slurm->jobs[slurm->n_jobs++], sizeof slurm->jobs[0], "%.31s", output);
    } else if (rc >= 0) {
        cut_line(output);
        rc = orl_error_set(err, ORL_ERR_IO, "sbatch: %.300s", output);
    }
    free(output);
    free(array_word);
    return rc;
}

static int slurm_start(void *ctx, const char *wave, const uint32_t *numbers, size_t n,
                       struct orl_error *err)
{
    struct slurm *slurm = ctx;
    char *array;
    int rc;

    if (strcmp(slurm->wave, wave) != 0)
        slurm->n_jobs = 0;
    if (slurm->n_jobs == MOST_WAVES)
        return orl_error_set(err, ORL_ERR_LIMIT, "parts were handed to Slurm %d times", MOST_WAVES);
    snprintf(slurm->wave, sizeof slurm->wave, "%s", wave);
    array = list_numbers(numbers, n, slurm->most);
    rc = array ? submit(slurm, array, err) : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    free(array);
    slurm->asked_s = orl_clock_s(NULL); /* it takes a moment until Slurm tells of them */
    free(slurm->states);
    slurm->states = NULL;
    return rc;
}

/* ---- Look ------------------------------------------------------------------------------------ */

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

/* Lines "NUMBER|STATE". */
static void read_states(char *text, enum orl_part_state *states, size_t n)
{
    char *rest = text, *line;

    while ((line = strsep(&rest, "\n")) != NULL) {
        char *bar = strchr(line, '|'), *end;
        unsigned long number = strtoul(line, &end, 10);

        if (!bar || end != bar || number >= n)
            continue;
        bar[1 + strcspn(bar + 1, " ")] = '\0';
        const enum orl_part_state state = state_of(bar + 1);
        if (state != ORL_PART_GONE)
            states[number] = state;
    }
}

/* Jobs that Slurm has forgotten are gone; where it does not answer nothing is known. */
static int ask(struct slurm *slurm, enum orl_part_state *states, size_t n, struct orl_error *err)
{
    char jobs[MOST_WAVES * 33 + 16];
    size_t at = (size_t)snprintf(jobs, sizeof jobs, "--jobs=");
    char *argv[] = {(char *)"squeue",
                    (char *)"--noheader",
                    (char *)"--array",
                    (char *)"--format=%K|%t",
                    jobs,
                    NULL};
    char *output = NULL;
    int rc;

    for (size_t i = 0; i < slurm->n_jobs; i++)
        at += (size_t)snprintf(jobs + at, sizeof jobs - at, i > 0 ? ",%s" : "%s", slurm->jobs[i]);
    rc = run(argv, &output, err);
    if (rc < 0) {
        free(output);
        return rc;
    }
    const bool forgotten = strstr(output, "Invalid job id") != NULL;
    for (size_t i = 0; i < n; i++)
        states[i] = rc == 0 || forgotten ? ORL_PART_GONE : ORL_PART_UNKNOWN;
    if (rc == 0)
        read_states(output, states, n);
    free(output);
    return 0;
}

static int slurm_look(void *ctx, enum orl_part_state *ret_states, size_t n, struct orl_error *err)
{
    struct slurm *slurm = ctx;
    const double now = orl_clock_s(NULL);
    int rc = 0;

    if (now - slurm->asked_s >= asked_every_s) {
        enum orl_part_state *states = calloc(n + 1, sizeof *states);

        if (!states)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        rc = ask(slurm, states, n, err);
        slurm->asked_s = now;
        free(slurm->states);
        slurm->states = states;
        slurm->n_states = n;
    }
    for (size_t i = 0; i < n; i++)
        ret_states[i] = slurm->states && i < slurm->n_states ? slurm->states[i] : ORL_PART_UNKNOWN;
    return rc;
}

static void slurm_cancel(void *ctx)
{
    struct slurm *slurm = ctx;
    char *argv[MOST_WAVES + 2] = {(char *)"scancel"};
    char *output = NULL;

    if (slurm->n_jobs == 0)
        return;
    for (size_t i = 0; i < slurm->n_jobs; i++)
        argv[1 + i] = slurm->jobs[i];
    run(argv, &output, NULL);
    free(output);
    slurm->n_jobs = 0;
}

static void slurm_done(void *ctx)
{
    struct slurm *slurm = ctx;

    free(slurm->states);
    free(slurm->options);
    free(slurm);
}

/* ---- The runner ------------------------------------------------------------------------------ */

static int cut_words(struct slurm *slurm, const char *options, struct orl_error *err)
{
    char *rest, *word;

    slurm->options = rest = strdup(options ? options : "");
    if (!slurm->options)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    while ((word = strsep(&rest, " ")) != NULL) {
        if (!*word)
            continue;
        if (word[0] != '-' || slurm->n_words == MOST_WORDS)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "--sbatch takes up to %d options of sbatch, as --partition=long, "
                                 "with spaces between them; '%.100s' is none",
                                 MOST_WORDS, word);
        slurm->words[slurm->n_words++] = word;
    }
    return 0;
}

static int write_script(const struct slurm *slurm, struct orl_error *err)
{
    struct orl_new_file file;
    const int rc = orl_new_file_open(&file, slurm->script, err);

    if (rc)
        return rc;
    fputs(script, file.stream);
    return orl_new_file_commit(&file, err);
}

int orl_runner_slurm(const char *folder, uint32_t threads, uint32_t most, const char *options,
                     struct orl_runner *ret_runner, struct orl_error *err)
{
    struct slurm *slurm = calloc(1, sizeof *slurm);
    int rc;

    if (!slurm)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    slurm->folder = folder;
    slurm->threads = threads;
    slurm->most = most;
    rc = readlink("/proc/self/exe", slurm->program, sizeof slurm->program - 1) > 0
             ? cut_words(slurm, options, err)
             : orl_error_set(err, orl_err_of_errno(errno), "this program's own file is not known");
    snprintf(slurm->script, sizeof slurm->script, "%s/part.sh", folder);
    if (rc == 0)
        rc = write_script(slurm, err);
    if (rc) {
        slurm_done(slurm);
        return rc;
    }
    *ret_runner = (struct orl_runner){slurm, slurm_start, slurm_look, slurm_cancel, slurm_done};
    return 0;
}

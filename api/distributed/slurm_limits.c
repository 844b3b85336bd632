#include "distributed/runner.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <sys/resource.h>

/* Factors for time and memory. Time estimates may be wrong by several times, and a cluster's
 * slowest node takes twice as long as the others. */
static const double time_margin = 8, memory_margin = 1.5;
/* Overhead of any part: until its files are read, and until its output is visible. */
static const double start_s = 120;
/* Factor for the load time on a busy node. */
static const double load_margin = 4;
enum { MIB_STEP = 64, MOST_MINUTES = 60 * 24 * 365 };

static uint64_t resident_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

static uint32_t estimated_minutes(const struct orl_part_needs *needs,
                                  const struct orl_part_limits_input *input)
{
    const double work_s = fmax(input->time_ratio, 1) * needs->core_s / fmax(input->threads, 1);
    const double all_s = start_s + load_margin * input->load_s + time_margin * work_s;
    if (!(needs->core_s > 0))
        return 0;
    return (uint32_t)fmin(fmax(ceil(all_s / 60), ORL_PART_LEAST_MINUTES), MOST_MINUTES);
}

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_part_limits_input *input)
{
    const uint64_t bytes =
        input->memory_bytes > 0 ? input->memory_bytes : resident_bytes() + needs->bytes;
    const double steps = ceil(memory_margin * (double)bytes / (MIB_STEP * 1048576.0));
    return (struct orl_part_limits){
        .minutes = estimated_minutes(needs, input),
        .mib = (uint32_t)fmin(fmax(MIB_STEP * steps, ORL_PART_LEAST_MIB), UINT32_MAX / 2)};
}

struct orl_part_limits orl_part_limits_raised(struct orl_part_limits limits, enum orl_part_end end)
{
    if (end == ORL_PART_OUT_OF_TIME && limits.minutes <= MOST_MINUTES)
        limits.minutes *= 2;
    if (end == ORL_PART_OUT_OF_MEMORY && limits.mib < UINT32_MAX / 2)
        limits.mib *= 2;
    return limits;
}

/* ---- Bounds ---------------------------------------------------------------------------------- */

/* Parses "minutes", "minutes:seconds", "hours:minutes:seconds" or "days-hours..."; 0: no bound. */
static uint32_t parse_slurm_minutes(const char *text)
{
    unsigned long fields[3] = {0}, days = 0;
    int n = 0;
    char *end;
    const char *dash = strchr(text, '-');
    if (!isdigit((unsigned char)text[0]))
        return 0; /* "infinite" */
    if (dash) {
        days = strtoul(text, NULL, 10);
        text = dash + 1;
    }
    do {
        fields[n++] = strtoul(text, &end, 10);
        text = end + 1;
    } while (*end == ':' && n < 3);
    const unsigned long hours = n == 3 || dash ? fields[0] : 0;
    const unsigned long minutes = n == 3 || dash ? fields[1] : fields[0];
    const unsigned long all = (24 * days + hours) * 60 + minutes;
    return all < UINT32_MAX ? (uint32_t)all : 0;
}

/* Returns true if an option sets it: "--mem=4G", "--mem-per-cpu=1G", "-t60". */
static bool has_option(const struct orl_runner_spec *spec, const char *name, const char *letter)
{
    for (size_t i = 0; i < spec->n_words; i++)
        if (strncmp(spec->words[i], name, strlen(name)) == 0 ||
            (letter && strncmp(spec->words[i], letter, strlen(letter)) == 0))
            return true;
    return false;
}

static const char *partition_of(const struct orl_runner_spec *spec)
{
    static const char name[] = "--partition=", letter[] = "-p";
    const char *partition = NULL;
    for (size_t i = 0; i < spec->n_words; i++) {
        if (strncmp(spec->words[i], name, strlen(name)) == 0)
            partition = spec->words[i] + strlen(name);
        else if (strncmp(spec->words[i], letter, strlen(letter)) == 0)
            partition = spec->words[i] + strlen(letter);
    }
    return partition;
}

/* Reads lines "PARTITION|TIME|MIB"; the largest values count. */
static void read_bounds(char *text, bool default_only, struct orl_part_limits *ret_most)
{
    char *rest = text, *line;
    bool endless = false, any = false;
    *ret_most = (struct orl_part_limits){0, 0};
    while ((line = strsep(&rest, "\n")) != NULL) {
        char *time = strchr(line, '|'), *memory = time ? strchr(time + 1, '|') : NULL;
        if (!memory || (default_only && !(time > line && time[-1] == '*')))
            continue;
        const uint32_t minutes = parse_slurm_minutes(time + 1);
        const unsigned long mib = strtoul(memory + 1, NULL, 10);
        endless = endless || minutes == 0;
        any = true;
        ret_most->minutes = minutes > ret_most->minutes ? minutes : ret_most->minutes;
        ret_most->mib = mib > ret_most->mib && mib < UINT32_MAX ? (uint32_t)mib : ret_most->mib;
    }
    if (endless || !any)
        ret_most->minutes = UINT32_MAX;
    if (ret_most->mib == 1) /* Slurm's value if slurm.conf sets none */
        ret_most->mib = 0;
}

void orl_slurm_bounds_query(const struct orl_runner_spec *spec, struct orl_slurm_bounds *bounds)
{
    char output[ORL_COMMAND_OUTPUT], word[300];
    const char *partition = partition_of(spec);
    char *argv[] = {(char *)"sinfo", (char *)"--noheader", (char *)"--format=%P|%l|%m",
                    partition ? word : NULL, NULL};
    snprintf(word, sizeof word, "--partition=%.250s", partition ? partition : "");
    if (orl_command_run(argv, spec->command_s, spec->cancel, output, NULL) != 0)
        return;
    bounds->known = true;
    read_bounds(output, !partition, &bounds->most);
    if (has_option(spec, "--time", "-t"))
        bounds->most.minutes = 0;
    if (has_option(spec, "--mem", NULL))
        bounds->most.mib = 0;
}

struct orl_part_limits orl_slurm_bounded(const struct orl_slurm_bounds *bounds,
                                         struct orl_part_limits limits)
{
    const struct orl_part_limits most = bounds->most;
    if (!bounds->known)
        return (struct orl_part_limits){0, 0};
    return (struct orl_part_limits){limits.minutes < most.minutes ? limits.minutes : most.minutes,
                                    limits.mib < most.mib ? limits.mib : most.mib};
}

/* ---- Temporary failures ---------------------------------------------------------------------- */

/* Recognises sbatch's messages about temporary failures; its exit status is always the same. */
bool orl_slurm_is_temporary_failure(const char *output)
{
    static const char *const temporary_failures[] = {"Unable to contact",
                                                     "timed out",
                                                     "Connection refused",
                                                     "Connection reset",
                                                     "connect failure",
                                                     "standby mode",
                                                     "Zero Bytes were transmitted",
                                                     "temporarily unavailable",
                                                     "temporarily unable",
                                                     "AssocMaxSubmitJobLimit",
                                                     "QOSMaxSubmitJobPerUserLimit"};
    if (output[strspn(output, " \t\r\n")] == '\0')
        return true;
    for (size_t i = 0; i < sizeof temporary_failures / sizeof *temporary_failures; i++)
        if (strcasestr(output, temporary_failures[i]))
            return true;
    return false;
}

/* ---- Reason of an end ------------------------------------------------------------------------ */

/* Finds the part in lines "NUMBER|STATE|TASK". */
static enum orl_part_end find_end(char *text, uint32_t task, uint32_t number)
{
    char *rest = text, *line;
    while ((line = strsep(&rest, "\n")) != NULL) {
        char *state = strchr(line, '|'), *its_task = state ? strchr(state + 1, '|') : NULL;
        if (!its_task || strtoul(line, NULL, 10) != number ||
            strtoul(its_task + 1, NULL, 10) != task)
            continue;
        if (strncmp(state, "|TO", strlen("|TO")) == 0)
            return ORL_PART_OUT_OF_TIME;
        if (strncmp(state, "|OOM", strlen("|OOM")) == 0)
            return ORL_PART_OUT_OF_MEMORY;
    }
    return ORL_PART_ENDED;
}

/* Looks for slurmstepd's messages in the task's log. */
static enum orl_part_end end_in_log(const struct orl_runner_spec *spec, uint32_t task,
                                    uint32_t number)
{
    char path[4300], line[1000];
    enum orl_part_end end = ORL_PART_ENDED;
    FILE *log;
    snprintf(path, sizeof path, "%s/slurm-%u_%u.log", spec->folder, task, number);
    log = orl_fopen_regular(path, 'r');
    while (log && fgets(line, sizeof line, log)) {
        if (strncmp(line, "slurmstepd", strlen("slurmstepd")) != 0)
            continue;
        if (strstr(line, "DUE TO TIME LIMIT"))
            end = ORL_PART_OUT_OF_TIME;
        else if (strstr(line, "oom-kill") || strstr(line, "oom_kill") ||
                 strstr(line, "xceeded job memory limit"))
            end = ORL_PART_OUT_OF_MEMORY;
    }
    if (log)
        fclose(log);
    return end;
}

enum orl_part_end orl_slurm_end_reason(const struct orl_runner_spec *spec, const char *tasks,
                                       uint32_t task, uint32_t number)
{
    char name[160], output[ORL_COMMAND_OUTPUT];
    char *argv[] = {(char *)"squeue",
                    (char *)"--noheader",
                    (char *)"--array",
                    (char *)"--me",
                    (char *)"--states=TIMEOUT,OUT_OF_MEMORY",
                    (char *)"--format=%K|%t|%F",
                    name,
                    NULL};
    enum orl_part_end end;
    snprintf(name, sizeof name, "--name=%s", tasks);
    if (task == 0)
        return ORL_PART_ENDED;
    end =
        end_in_log(spec, task,
                   number); /* the log first: many parts may fail at once, and this saves queries */
    if (end == ORL_PART_ENDED &&
        orl_command_run(argv, spec->command_s, spec->cancel, output, NULL) == 0)
        end = find_end(output, task, number);
    return end;
}

#include "support/cluster.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/patience.h"

static char cluster[64];

/* Runs our own script on our own folder; it reads none of the user's files. */
static int control(const char *what, unsigned port)
{
    char command[256];
    snprintf(command, sizeof command, "tests/support/slurm %s %s %u", what, cluster, port);
    return system(command); /* NOLINT(cert-env33-c) */
}

int cluster_start(void **state)
{
    char conf[96];
    (void)state;
    cli_make_folder(cluster);
    snprintf(conf, sizeof conf, "%s/slurm.conf", cluster);
    setenv("SLURM_CONF", conf, 1);
    return control("start", 20000 + 3 * ((unsigned)getpid() % 4000));
}

int cluster_stop(void **state)
{
    (void)state;
    control("stop", 0);
    cli_remove_folder(cluster);
    return 0;
}

bool cluster_long_form(void)
{
    return getenv("ORIEL_SLURM_LONG") != NULL;
}

const char *cluster_folder(void)
{
    return cluster;
}

/* Counts the lines that begin with that text. */
static int count_lines(const char *command, const char *begin)
{
    char line[64] = "";
    FILE *squeue = popen(command, "r"); /* NOLINT(cert-env33-c) */
    int count = 0;
    assert_non_null(squeue);
    while (fgets(line, sizeof line, squeue))
        count += strncmp(line, begin, strlen(begin)) == 0;
    pclose(squeue);
    return count;
}

int cluster_tasks(bool running)
{
    return count_lines("squeue --noheader --array --format=%t", running ? "R" : "");
}

int cluster_tasks_ever(void)
{
    return count_lines("squeue --noheader --array --states=all --format=%t", "");
}

void cluster_rest(double seconds)
{
    const struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - (double)(long)seconds))};
    nanosleep(&time, NULL);
}

/* Keeps the counted number: a second query could return another one. */
void cluster_wait_for_tasks(void)
{
    int running;
    for (double until = patience_until();
         (running = cluster_tasks(true)) == 0 && patience_nap(until);)
        cluster_rest(0.1);
    assert_true(running > 0);
}

void cluster_wait_for_none(void)
{
    int left;
    for (double until = patience_until(); (left = cluster_tasks(false)) > 0 && patience_nap(until);)
        cluster_rest(0.1);
    assert_int_equal(left, 0);
}

pid_t cluster_pid(const char *name)
{
    char *text = cli_read_file(cluster, name);
    assert_non_null(text);
    const pid_t pid = (pid_t)strtol(text, NULL, 10);
    free(text);
    assert_true(pid > 1);
    return pid;
}

void cluster_command(const char *command)
{
    assert_int_equal(system(command), 0); /* NOLINT(cert-env33-c) */
}

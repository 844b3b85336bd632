/*
 * A real Slurm on loopback, of two nodes (tests/support/slurm), for a test program of its own: what
 * that starts finds it by $SLURM_CONF. Everything here fails the running test where it cannot do
 * its part.
 */
#ifndef ORL_TESTS_SUPPORT_CLUSTER_H
#define ORL_TESTS_SUPPORT_CLUSTER_H

#include <stdbool.h>
#include <sys/types.h>

/* For cmocka's set-up and tear-down of the group. */
int cluster_start(void **state);
int cluster_stop(void **state);

/* Whether $ORIEL_SLURM_LONG is set (make slurm): tests then take their time. */
bool cluster_long_form(void);

/* A folder that goes with it. */
const char *cluster_folder(void);

/* Lines of squeue, of all tasks; running: of those that run. */
int cluster_tasks(bool running);
/* And of those that ended in the last half minute. */
int cluster_tasks_ever(void);
/* Wait until some tasks run, and until there is none; fail the test after two minutes. */
void cluster_wait_for_tasks(void);
void cluster_wait_for_none(void);

/* The process of a daemon of it: "slurmctld.pid", "n1.pid". */
pid_t cluster_pid(const char *name);

void cluster_command(const char *command);
void cluster_rest(double seconds);

#endif

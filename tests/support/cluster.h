/*
 * A real Slurm on loopback with two nodes (tests/support/slurm) for one test program; its children
 * find it by $SLURM_CONF. Everything here fails the running test on error.
 */
#ifndef ORL_TESTS_SUPPORT_CLUSTER_H
#define ORL_TESTS_SUPPORT_CLUSTER_H

#include <stdbool.h>
#include <sys/types.h>

/* cmocka's set-up and tear-down of the group. */
int cluster_start(void **state);
int cluster_stop(void **state);

/* Returns true if $ORIEL_SLURM_LONG is set (make slurm): tests then use longer jobs. */
bool cluster_long_form(void);

/* Returns a folder that lives as long as the cluster. */
const char *cluster_folder(void);

/* Returns the number of squeue's lines, one for each task; running: only tasks that run. */
int cluster_tasks(bool running);
/* Returns the number of tasks including those that ended in the last half minute. */
int cluster_tasks_ever(void);
/* Wait until some tasks run, and until no task is left; fail the test after two minutes. */
void cluster_wait_for_tasks(void);
void cluster_wait_for_none(void);

/* Returns the process id of one of its daemons: "slurmctld.pid", "n1.pid". */
pid_t cluster_pid(const char *name);

void cluster_command(const char *command);
void cluster_rest(double seconds);

#endif

/*
 * A daemon with --runner slurm, on the Slurm of the test (cluster.h), with a desk of documents
 * (parted.h) that all go in parts. Everything here fails the running test where it cannot do its
 * part.
 */
#ifndef ORL_TESTS_SUPPORT_PARTED_DAEMON_H
#define ORL_TESTS_SUPPORT_PARTED_DAEMON_H

#include "support/daemon.h"
#include "support/parted.h"

struct parted_daemon {
    struct cli_desk *desk;
    struct daemon daemon;
    char shared[96];
    const char *options[16]; /* --runner slurm --shared DIR --least 0 ... */
};

/* For cmocka. */
int parted_daemon_set_up(void **state);
int parted_daemon_tear_down(void **state);
/* After daemon_end: with the options as they are now. */
void parted_restart(struct parted_daemon *f);

/* By oriel: a document of the desk; what came of it, into a folder of the desk. */
void parted_submit(struct parted_daemon *f, const char *document, char ret_path[80]);
void parted_fetch(struct parted_daemon *f, const char *path, const char *output);

/* Until it has succeeded, in parts. */
void parted_wait(struct parted_daemon *f, const char *path);
/* Waits in the same way after a restart of the daemon, which starts no part if all have ended. */
void parted_wait_resumed(struct parted_daemon *f, const char *path);
/* Nothing is left in the shared folder. */
void parted_assert_cleared(const struct parted_daemon *f);
/* What was fetched into "slurm" is what a daemon finds that has no Slurm. */
void parted_compare_fetched(struct parted_daemon *f, const char *document);
/* Asserts the same of a job that has succeeded. */
void parted_compare_daemons(struct parted_daemon *f, const char *document, const char *path);

#endif

/*
 * A daemon with --runner slurm on the Slurm of the test (cluster.h), and a desk of documents
 * (parted.h), all of which run in parts. Everything here fails the running test on error.
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

/* cmocka's set-up and tear-down. */
int parted_daemon_set_up(void **state);
int parted_daemon_tear_down(void **state);
/* Starts the daemon after daemon_end, with the current options. */
void parted_restart(struct parted_daemon *f);

/* Submit a document of the desk by oriel; fetch the result into a subfolder of the desk. */
void parted_submit(struct parted_daemon *f, const char *document, char ret_path[80]);
void parted_fetch(struct parted_daemon *f, const char *path, const char *output);

/* Waits until it has succeeded, in parts. */
void parted_wait(struct parted_daemon *f, const char *path);
/* Waits in the same way after a restart of the daemon; if all parts have ended it starts none. */
void parted_wait_resumed(struct parted_daemon *f, const char *path);
/* Asserts that the shared folder is empty. */
void parted_assert_cleared(const struct parted_daemon *f);
/* Asserts that the result fetched into "slurm" equals that of a daemon without Slurm. */
void parted_compare_fetched(struct parted_daemon *f, const char *document);
/* Fetches a job that has succeeded, and asserts the same. */
void parted_compare_daemons(struct parted_daemon *f, const char *document, const char *path);

#endif

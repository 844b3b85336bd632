/*
 * The fork server is a fork server: a process of the daemon's own program that only forks children.
 * Each child runs one check of untrusted data (child_checks.h); there is one child at a time. The
 * fork server is small, has one thread, and has its libraries loaded, so a child costs a
 * millisecond or two. It reads nothing of the data that its children receive.
 *
 * The daemon starts fork servers and talks to them through check_pool.h. A fork server ends with
 * the daemon, and its children end with the fork server.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_FORK_SERVER_H
#define ORL_SERVER_CHECKS_CHILD_FORK_SERVER_H

/* The first argument of a fork server process; the second is the daemon's process id. */
#define ORL_FORK_SERVER_MODE "--keeper"
enum { ORL_FORK_SERVER_FD = 3 }; /* the fork server's end of the socket */

/* Exit status of a child that ran out of memory where no error could be returned. */
enum { ORL_CHILD_NO_MEMORY = 71 };

/* Serves until the daemon is gone. Returns the process's exit status. */
int orl_fork_server_main(const char *daemon_pid);

#endif

/*
 * The keeper: a process of the daemon's own program that does nothing but fork children, one at a
 * time, each for one check of what a stranger has sent (child_checks.h). It is small, has one
 * thread and its libraries in place, so that a child costs a millisecond or two; and it reads
 * nothing of what its children are sent.
 *
 * The daemon starts keepers and talks to them through lanes.h; a keeper ends with the daemon, its
 * children with it.
 */
#ifndef ORL_SERVER_CHECKS_KEEPER_H
#define ORL_SERVER_CHECKS_KEEPER_H

/* The first argument of such a process; the second is the daemon's process number. */
#define ORL_KEEPER_MODE "--keeper"
enum { ORL_KEEPER_FD = 3 }; /* of its end of the socket */

/* How a child ends that has met its bound of memory where no error could tell. */
enum { ORL_CHILD_NO_MEMORY = 71 };

/* Serves until the daemon is gone; returns the process's status. */
int orl_keeper_main(const char *daemon_pid);

#endif
